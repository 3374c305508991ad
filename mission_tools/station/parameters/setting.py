"""One parameter set on a boat: one request, one answer, which is what the boat then has.

Theory of operation
-------------------
PARAM_SET is sent, and again every REPEAT_S without an answer; setting the same value twice does no harm. The
answer is the PARAM_VALUE of that name. The value asked: done. Another one may have been under way in a list
before the boat heard the request, so it counts once the boat has said why (STATUSTEXT with the name, or
PARAM_ERROR), or has said it again after a repetition. SETTLE_S are left for a reason that comes after it.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from mission_tools.station.outcome import Accepted, Cancelled, Outcome, Refused, Silent
from mission_tools.station.parameters.metadata import Description
from mission_tools.station.parameters.values import (
    Value,
    encode,
    flaw_of,
    float_or_int,
    is_same,
    name_of,
    write,
)
from mission_tools.station.words import say

REPEAT_S: Final = 1.0
TRIES: Final = 6
TIMEOUT_S: Final = 8.0  # the page hears within ten
SETTLE_S: Final = 0.4
MOST: Final = 64  # under way at once
_ENOUGH: Final = 2  # other values after as many requests
_ERRORS: Final = {
    1: say("answer.param_error.unknown"),
    2: say("answer.param_error.value"),
    3: say("answer.param_error.permission"),
    5: say("answer.param_error.read_only"),
    6: say("answer.param_error.no_type"),
    7: say("answer.param_error.type"),
}  # MAV_PARAM_ERROR, which begins at 1

Answered = Callable[[Outcome, Value | None], None]


@dataclass(slots=True)
class _Request:
    name: str
    value: float
    kind: int
    is_bytewise: bool
    answered: Answered
    ends_s: float
    repeat_s: float
    sent: int = 1
    others: int = 0  # other values after different requests
    other_at: int = 0  # requests sent when the latest of them came
    kept: Value | None = None
    reason: str = ""
    settled_s: float | None = None


class Settings:
    """The parameters being set on one boat. send: to this boat."""

    def __init__(self, boat: Address, own: Address, send: Callable[[Message], None]) -> None:
        self._boat = boat
        self._own = own
        self._send = send
        self._under_way: dict[str, _Request] = {}

    def ask(
        self, name: str, value: float, kind: int, is_bytewise: bool, answered: Answered, now_s: float
    ) -> None:
        """Set a parameter. answered(outcome, value on board) is called once, within TIMEOUT_S."""
        if (older := self._under_way.pop(name, None)) is not None:
            older.answered(Cancelled(), older.kept)
        if len(self._under_way) >= MOST:
            answered(Refused(say("answer.param_busy")), None)
            return
        one = _Request(name, value, kind, is_bytewise, answered, now_s + TIMEOUT_S, now_s + REPEAT_S)
        self._under_way[name] = one
        self._post(one)

    def on_value(self, name: str, value: Value, now_s: float) -> None:
        """PARAM_VALUE of the boat."""
        if (one := self._under_way.get(name)) is None:
            return
        one.kept = value
        if value.value is not None and is_same(value.value, one.value):
            done = write(float_or_int(one.value, value.is_whole))
            self._end(one, Accepted(say("answer.param_set", name=name, value=done)))
            return
        if one.other_at < one.sent:
            one.other_at = one.sent
            one.others += 1
        if one.reason or one.others >= _ENOUGH:
            one.settled_s = one.settled_s or now_s + SETTLE_S

    def on_error(self, message: Message, now_s: float) -> None:
        """PARAM_ERROR of the boat."""
        one = self._under_way.get(name_of(message) or "")
        to_other = message.target_system not in (0, self._own.system)
        if one is None or to_other or not message.error:
            return
        one.reason = one.reason or say(
            "answer.param_error",
            name=one.name,
            why=_ERRORS.get(message.error) or say("answer.param_error.other", n=message.error),
        )
        one.settled_s = one.settled_s or now_s + SETTLE_S

    def on_text(self, text: str, now_s: float) -> None:
        """A STATUSTEXT of the boat: a reason if it begins with the name."""
        for one in self._under_way.values():
            if text.startswith(one.name) and not text[len(one.name) :][:1].isalnum():
                one.reason = text
                one.settled_s = one.settled_s or now_s + SETTLE_S

    def poll(self, now_s: float) -> None:
        """Repeat, settle, give up."""
        for one in list(self._under_way.values()):
            if one.settled_s is not None and now_s >= one.settled_s:
                self._end(one, Refused(_refusal(one)))
            elif now_s >= one.ends_s:
                silent = Silent(say("answer.param_silent", name=one.name))
                self._end(one, silent if one.kept is None else Refused(_refusal(one)))
            elif one.settled_s is None and now_s >= one.repeat_s and one.sent < TRIES:
                one.sent += 1
                one.repeat_s = now_s + REPEAT_S
                self._post(one)

    def _post(self, one: _Request) -> None:
        raw = encode(one.value, one.kind, one.is_bytewise)
        self._send(dialect.MAVLink_param_set_message(*self._boat, one.name.encode("ascii"), raw, one.kind))

    def _end(self, one: _Request, outcome: Outcome) -> None:
        del self._under_way[one.name]
        one.answered(outcome, one.kept)


def _refusal(one: _Request) -> str:
    """What the boat has, and why."""
    if one.kept is None:
        return one.reason
    if one.reason:
        return say("answer.param_kept_as", why=one.reason, name=one.name, value=one.kept.text())
    return say("answer.param_kept", name=one.name, value=one.kept.text())


def refusal_of(name: str, value: float, kind: int, is_bytewise: bool, described: Description) -> str:
    """Why a value is refused, in a sentence; empty if it fits.

    A listed value fits whatever the range. A description without a range allows the listed values only.
    """
    if described.read_only:
        return say("answer.param_fixed", name=name)
    try:
        number = float(value)
    except OverflowError:  # a whole number beyond every float
        number = math.inf
    if flaw := flaw_of(number, kind, is_bytewise):
        return say("answer.param_flaw", name=name, value=_written(number), flaw=flaw)
    if any(is_same(number, listed.value) for listed in described.values):
        return ""
    low, high = described.low, described.high
    unit = f" {described.unit}" if described.unit else ""
    below = low is not None and number < low and not is_same(number, low)
    above = high is not None and number > high and not is_same(number, high)
    if below or above:
        least = "−∞" if low is None else _written(low)
        most = "∞" if high is None else _written(high)
        return say(
            "answer.param_outside", name=name, value=_written(number) + unit, least=least, most=most + unit
        )
    if described.values and not described.bits and low is None and high is None:
        listed = ", ".join(_written(one.value) for one in described.values[:20])
        return say("answer.param_not_listed", name=name, value=_written(number), listed=listed)
    return ""


def _written(value: float) -> str:
    if not math.isfinite(value):
        return str(value)
    return write(float_or_int(value, float(value).is_integer() and abs(value) < 1e15))
