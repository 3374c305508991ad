"""Commands under way to one boat: repeated until acknowledged, answered once in plain words.

Theory of operation
-------------------
A command is sent at once, and again every REPEAT_S while no COMMAND_ACK comes, TRIES times in all; its
answer may come until TIMEOUT_S. A command that is not idempotent is repeated only within the two seconds in
which the boat recognises a repetition. A boat says why it refuses in a STATUSTEXT that may come after the
COMMAND_ACK, so a refusal waits SETTLE_S for it. A newer request replaces an older one that is still under way
if both have the same command, or both steer: a repetition of `go` must not undo a `hold`. The older one is
answered at once.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final

from companion.mavlink.address import Address, concerns
from companion.mavlink.dialect import Message, dialect
from mission_tools.station.outcome import Accepted, Answered, Cancelled, Outcome, Refused, Silent
from mission_tools.station.requests import BoatCommand
from mission_tools.station.texts import Text
from mission_tools.station.wire import command_long
from mission_tools.station.words import say

REPEAT_S: Final = 1.0
TRIES: Final = 5
REPEAT_ONCE_S: Final = 0.6  # three times within the boat's two seconds
TRIES_ONCE: Final = 3
TIMEOUT_S: Final = 8.0
SETTLE_S: Final = 0.3
_WORST_TOLD: Final = 4  # severities up to WARNING tell reasons

_REFUSALS: Final = {
    dialect.MAV_RESULT_TEMPORARILY_REJECTED: say("answer.not_now"),
    dialect.MAV_RESULT_DENIED: say("answer.refused"),
    dialect.MAV_RESULT_UNSUPPORTED: say("answer.unable"),
    dialect.MAV_RESULT_FAILED: say("answer.failed"),
    6: say("answer.given_up"),  # MAV_RESULT_CANCELLED, newer than the dialect
}


@dataclass(slots=True)
class _UnderWay:
    command: BoatCommand
    answered: Answered
    ends_s: float
    repeat_s: float
    sent: int = 1
    result: int | None = None
    settled_s: float = 0.0
    texts: list[str] = field(default_factory=list)


class Commands:
    """The commands under way to one boat. send: to this boat."""

    def __init__(self, boat: Address, own: Address, send: Callable[[Message], None]) -> None:
        self._boat = boat
        self._own = own
        self._send = send
        self._under_way: dict[int, _UnderWay] = {}

    def ask(
        self, command: BoatCommand, answered: Answered, now_s: float, timeout_s: float = TIMEOUT_S
    ) -> None:
        """Send a command. answered is called once, within timeout_s plus a poll."""
        for older in list(self._under_way.values()):
            if older.command.number == command.number or (older.command.steers and command.steers):
                self._end(older, Cancelled())
        every_s = REPEAT_ONCE_S if command.once else REPEAT_S
        self._under_way[command.number] = _UnderWay(command, answered, now_s + timeout_s, now_s + every_s)
        self._send(_message(self._boat, command, 0))

    def replace_steering(self) -> None:
        """A newer request steers the boat."""
        for older in list(self._under_way.values()):
            if older.command.steers:
                self._end(older, Cancelled())

    def on_ack(self, message: Message, now_s: float) -> None:
        """COMMAND_ACK of the boat."""
        one = self._under_way.get(message.command)
        is_own = concerns(self._own, message.target_system, message.target_component)
        if one is None or not is_own or one.result is not None:
            return
        if message.result == dialect.MAV_RESULT_ACCEPTED:
            self._end(one, Accepted(one.command.done))
        elif message.result != dialect.MAV_RESULT_IN_PROGRESS:
            one.result, one.settled_s = message.result, now_s + SETTLE_S

    def on_text(self, text: Text) -> None:
        """A STATUSTEXT of the boat: it may be the reason."""
        if text.severity <= _WORST_TOLD and not text.text.startswith(("PreArm: ", "Failsafe: ")):
            for one in self._under_way.values():
                if text.text not in one.texts and len(one.texts) < 5:
                    one.texts.append(text.text)

    def poll(self, now_s: float) -> None:
        """Repeat, settle, give up."""
        for one in list(self._under_way.values()):
            if one.result is not None:
                if now_s >= one.settled_s:
                    plain = _REFUSALS.get(one.result, say("answer.result", n=one.result))
                    self._end(one, Refused(". ".join(one.texts) or plain))
            elif now_s >= one.ends_s:
                self._end(one, Silent())
            elif now_s >= one.repeat_s and one.sent < (TRIES_ONCE if one.command.once else TRIES):
                self._send(_message(self._boat, one.command, one.sent))
                one.sent += 1
                one.repeat_s = now_s + (REPEAT_ONCE_S if one.command.once else REPEAT_S)

    def _end(self, one: _UnderWay, outcome: Outcome) -> None:
        del self._under_way[one.command.number]
        one.answered(outcome)


def _message(boat: Address, command: BoatCommand, repeat: int) -> Message:
    if command.place is None:
        return command_long(boat, command.number, *command.params, repeat=repeat)
    message: Message = dialect.MAVLink_command_int_message(
        *boat, dialect.MAV_FRAME_GLOBAL, command.number, 0, 0, *command.params, *command.place, 0.0
    )
    return message
