"""Why a boat does not arm, and which failsafes act: its own texts, with why and what to do next.

The boat tells its PreArm reasons when they appear and then rarely; a failsafe when it fires and when it is
over. `reasons.toml` tells, by the beginning of the boat's text, which words for people say it.
"""

import tomllib
from functools import cache
from importlib.resources import files
from typing import Final, NamedTuple

from mission_tools.station.messages import Reason
from mission_tools.station.texts import Text
from mission_tools.station.view import View
from mission_tools.station.words import texts

_PRE_ARM: Final = "PreArm: "
_FAILSAFE: Final = "Failsafe: "
_OVER: Final = "Failsafe over: "
_BURST_S: Final = 1.0  # texts of one report come together
_MOST: Final = 20
_WARNING: Final = 4
ASK_S: Final = 5.0  # after a change of the verdict or the mode: how soon the boat is asked again
STANDS_S: Final = 40.0  # since the boat last repeated it
AGAIN_S: Final = 30.0  # else: each answer shows on every station, too


class Words(NamedTuple):
    """For people. key: the texts are `reason.KEY.why` and `reason.KEY.next`.

    over: how the boat says that this failsafe has ended. stands: the boat repeats it while it holds.
    """

    key: str
    over: str = ""
    stands: bool = False

    @property
    def why(self) -> str:
        """What the reason means, for people."""
        return texts()[f"reason.{self.key}.why"]

    @property
    def next(self) -> str:
        """What a person can do about it."""
        return texts()[f"reason.{self.key}.next"]


@cache
def words() -> dict[str, Words]:
    """By the beginning of the boat's text."""
    table = tomllib.loads(files(__package__).joinpath("reasons.toml").read_text("utf-8"))
    return {begin: Words(entry.pop("words"), **entry) for begin, entry in table.items()}


def words_for(text: str) -> Words | None:
    """The entry with the longest beginning of this text."""
    begins = [begin for begin in words() if text.startswith(begin)]
    return words()[max(begins, key=len)] if begins else None


class Reasons:
    """The reasons of one boat."""

    def __init__(self) -> None:
        self._pre_arm: dict[str, Reason] = {}
        self._failsafes: dict[str, tuple[Reason, str]] = {}
        self._standing: dict[str, tuple[Reason, float]] = {}
        self._seen: list[Reason] = []  # by the boat's own verdicts: it may have told them before it was heard
        self._told_s = float("-inf")
        self._asked_s = float("-inf")
        self._asked_in: str | None = None  # the mode: what a boat lacks depends on it

    def now(self) -> list[Reason]:
        """The reasons that stand, failsafes first."""
        told = [reason for reason, _ in (*self._failsafes.values(), *self._standing.values())]
        known = {reason.text.split()[0] for reason in told if reason.text}
        seen = [one for one in self._seen if one.text.split()[0] not in known]
        return [*told, *seen, *self._pre_arm.values()]

    def on_text(self, text: Text, now_s: float) -> None:
        """A text of the boat."""
        if text.text.startswith(_PRE_ARM):
            if now_s - self._told_s > _BURST_S:
                self._pre_arm.clear()
            self._told_s = now_s
            said = text.text.removeprefix(_PRE_ARM)
            if len(self._pre_arm) < _MOST:
                self._pre_arm[said] = _reason(text.severity, said)
        elif text.text.startswith(_OVER):
            over = text.text.removeprefix(_OVER)
            self._failsafes = {key: one for key, one in self._failsafes.items() if one[1] != over}
        elif text.text.startswith(_FAILSAFE):
            said = text.text.removeprefix(_FAILSAFE).removesuffix(" (persists)")
            found = words_for(said)
            key = found.key if found is not None else said
            if key in self._failsafes or len(self._failsafes) < _MOST:
                self._failsafes[key] = _reason(text.severity, said), found.over if found is not None else ""
        elif (found := words_for(text.text)) is not None and found.stands:
            self._standing[found.key] = _reason(text.severity, text.text), now_s

    def poll(self, view: View, now_s: float) -> bool:
        """Forget what no longer holds. True: run the boat's pre-arm checks now, for their texts."""
        if view.battery_is_well:
            for key in [key for key, (one, _) in self._failsafes.items() if one.text.startswith("Battery")]:
                del self._failsafes[key]
        for key in [key for key, (_, told_s) in self._standing.items() if now_s - told_s > STANDS_S]:
            del self._standing[key]
        self._seen = [_reason(_WARNING, text) for text in _verdicts(view)]
        if view.may_arm is not False or view.armed is not False:
            self._pre_arm.clear()
            self._asked_in = None
            return False
        is_new = view.mode != self._asked_in or not self._pre_arm
        if now_s - max(self._asked_s, self._told_s) < (ASK_S if is_new else AGAIN_S):
            return False
        self._asked_s, self._asked_in = now_s, view.mode
        return True


def _verdicts(view: View) -> list[str]:
    """What the boat's status says, in the words of its failsafes. A disarmed boat's are arming faults."""
    if not view.armed:
        return []
    verdicts = []
    if view.is_outside:
        verdicts.append("Outside the fence")
    is_measured = view.battery is not None and view.battery.voltage_v is not None
    if is_measured and view.battery_is_well is False:
        verdicts.append("Battery low")
    return verdicts


def _reason(severity: int, said: str) -> Reason:
    if (found := words_for(said)) is None:
        return Reason(severity=severity, text=said)
    return Reason(severity=severity, text=said, key=found.key, why=found.why, next=found.next)
