"""Calibrations of one boat: started, followed, kept or cancelled. One at a time.

Theory of operation
-------------------
The start is sent every second until the boat acknowledges it. From then on its progress is followed: the
compass's by MAG_CAL_PROGRESS and MAG_CAL_REPORT, the others' by COMMAND_ACK with IN_PROGRESS. The end is told
by a report or a COMMAND_ACK, and by a text: whichever is heard first. While nothing is heard for SILENT_S the
calibration is `silent`: the boat goes on with it, or has ended it by its own rules. What it takes at most is
known; after that its end is `unknown`.

The compass's result waits on the boat until it is kept. A second DO_ACCEPT_MAG_CAL fails once the first was
carried out, so a failure of a repetition means that the result was kept.
"""

import math
import re
from collections.abc import Callable
from typing import Final, NamedTuple

import msgspec

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from mission_tools.station.messages import Calibration
from mission_tools.station.outcome import Accepted, Answered, Cancelled, Outcome, Refused, Silent
from mission_tools.station.texts import Text
from mission_tools.station.wire import command_long
from mission_tools.station.words import say

REPEAT_S: Final = 1.0
TRIES: Final = 6
ANSWER_S: Final = 8.0
SETTLE_S: Final = 0.5  # texts may come after the answer
SILENT_S: Final = 5.0
_MOST_LINES: Final = 20
_TOLD: Final = 5  # severities up to NOTICE
_CHANGE: Final = re.compile(r"[A-Z][A-Z0-9_]{1,15} \S+ -> \S+")
_CANCELLED: Final = 6  # MAV_RESULT_CANCELLED, newer than the dialect
_SUCCESS: Final = 4  # MAG_CAL_STATUS

STARTED: Final = say("answer.calibration_started")
KEPT: Final = say("answer.calibration_kept")
CANCELLED: Final = say("answer.calibration_cancelled")
NO_ANSWER: Final = say("answer.calibration_silent")
UNDER_WAY: Final = say("answer.calibration_under_way")
NOTHING_TO_CANCEL: Final = say("answer.calibration_none")
NOTHING_TO_KEEP: Final = say("answer.calibration_no_result")
_REFUSED: Final = say("answer.refused")
_NO_END: Final = say("answer.calibration_no_end")


class Kind(NamedTuple):
    """How a calibration is asked for. most_s: after that it has ended. good, bad: its texts' beginnings."""

    start: int
    params: tuple[float, ...]
    cancel: int
    most_s: float
    good: tuple[str, ...]
    bad: tuple[str, ...]
    while_armed: bool = False


_PREFLIGHT: Final = dialect.MAV_CMD_PREFLIGHT_CALIBRATION
KINDS: Final[dict[str, Kind]] = {
    "compass": Kind(
        dialect.MAV_CMD_DO_START_MAG_CAL, (), dialect.MAV_CMD_DO_CANCEL_MAG_CAL, 600.0,
        ("Compass calibrated", "Compass calibration to be accepted"),
        ("Compass not calibrated",),
    ),
    "gyro": Kind(_PREFLIGHT, (1.0,), _PREFLIGHT, 5.0, ("Gyro calibrated",), ("Gyro: ",)),
    "motor_field": Kind(
        _PREFLIGHT, (0.0, 0.0, 0.0, 0.0, 0.0, 1.0), _PREFLIGHT, 125.0,
        ("Compass: motors' field by",),
        ("Compass: motors' field not",),
    ),
    "thrusters": Kind(
        dialect.MAV_CMD_USER_1, (1.0,), dialect.MAV_CMD_USER_1, 1800.0,
        ("Thruster calibration done",),
        ("Thruster calibration aborted",),
        while_armed=True,
    ),
    "stop": Kind(
        dialect.MAV_CMD_USER_2, (1.0,), dialect.MAV_CMD_USER_2, 1800.0,
        ("Stop calibration done",),
        ("Stop calibration aborted",),
        while_armed=True,
    ),
    "heading": Kind(
        dialect.MAV_CMD_DO_AUTOTUNE_ENABLE, (1.0,), dialect.MAV_CMD_DO_AUTOTUNE_ENABLE, 1800.0,
        ("Heading autotune done",),
        ("Heading autotune aborted",),
        while_armed=True,
    ),
}  # fmt: skip
_RUNS: Final = ("asked", "running", "silent")


class _Sending(NamedTuple):
    """A command under way. step: start, keep or cancel."""

    step: str
    command: int
    params: tuple[float, ...]
    answered: Answered
    until_s: float
    next_s: float
    sent: int = 1


class Calibrations:
    """The calibrations of one boat. send: to this boat."""

    def __init__(self, boat: Address, own: Address, send: Callable[[Message], None]) -> None:
        self.now = Calibration(kind="", state="")
        self._boat, self._own, self._send = boat, own, send
        self._sending: _Sending | None = None
        self._began_s = self._heard_s = 0.0
        self._texts: list[Text] = []
        self._end: tuple[str, float] | None = None  # the state that it settles in, and when

    @property
    def latest(self) -> Calibration | None:
        """The latest calibration; None before the first."""
        return self.now if self.now.kind else None

    def start(self, kind: str, answered: Answered, now_s: float) -> None:
        """Start one of KINDS. Answered when the boat has begun."""
        if self.now.state in _RUNS or self._sending is not None:
            answered(Refused(UNDER_WAY))
            return
        self.now = Calibration(kind=kind, state="asked")
        self._began_s = self._heard_s = now_s
        self._texts, self._end = [], None
        self._ask("start", KINDS[kind].start, KINDS[kind].params, answered, now_s)

    def keep(self, answered: Answered, now_s: float) -> None:
        """Keep the compass's result."""
        if self.now.kind != "compass" or self.now.state not in ("waiting", "silent", "unknown"):
            answered(Refused(NOTHING_TO_KEEP))
        elif self._sending is not None:
            answered(Refused(UNDER_WAY))
        else:
            self._ask("keep", dialect.MAV_CMD_DO_ACCEPT_MAG_CAL, (), answered, now_s)

    def cancel(self, answered: Answered, now_s: float) -> None:
        """Cancel it, or drop its result."""
        if not self.now.kind or self.now.state in ("done", "failed", "cancelled"):
            answered(Refused(NOTHING_TO_CANCEL))
            return
        if self._sending is not None:
            self._sending.answered(Cancelled(CANCELLED))
        self._end = None
        self._ask("cancel", KINDS[self.now.kind].cancel, (), answered, now_s)

    def on_ack(self, message: Message, now_s: float) -> None:
        """COMMAND_ACK of the boat."""
        if message.target_system not in (0, self._own.system):
            return
        sending, result = self._sending, message.result
        if sending is not None and message.command == sending.command:
            self._on_answer(sending, message, now_s)
        elif self.now.state in ("running", "silent") and message.command == KINDS[self.now.kind].start:
            self._heard_s = now_s
            if result == dialect.MAV_RESULT_IN_PROGRESS:
                self._progress(message.progress)
            elif self.now.kind != "compass":
                self._settle(_ended(result), now_s)

    def _on_answer(self, sending: _Sending, message: Message, now_s: float) -> None:
        result = message.result
        is_done = result == dialect.MAV_RESULT_ACCEPTED
        if sending.step == "start":
            if result == dialect.MAV_RESULT_IN_PROGRESS or (is_done and self.now.kind == "compass"):
                self._progress(message.progress if result == dialect.MAV_RESULT_IN_PROGRESS else 0)
                self._answer(Accepted(STARTED))
            else:
                self._settle(_ended(result), now_s)
            self._heard_s = now_s
        elif sending.step == "cancel" and (is_done or result == _CANCELLED):
            self._change(state="cancelled", percent=None)
            self._answer(Accepted(CANCELLED))
        elif sending.step == "keep" and result != dialect.MAV_RESULT_IN_PROGRESS:
            if is_done or (sending.sent > 1 and self.now.state == "waiting"):
                self._change(state="done")
                self._answer(Accepted(KEPT))
            else:
                self._answer(Refused(NOTHING_TO_KEEP))

    def on_progress(self, message: Message, now_s: float) -> None:
        """How much of the circle the compass has seen."""
        if self.now.kind == "compass" and self.now.state in _RUNS and message.compass_id == 0:
            self._heard_s = now_s
            self._progress(message.completion_pct)
            if self._sending is not None and self._sending.step == "start":
                self._answer(Accepted(STARTED))

    def on_report(self, message: Message, now_s: float) -> None:
        """The result of the compass calibration."""
        if self.now.kind != "compass" or self.now.state not in ("running", "silent", "waiting"):
            return
        if message.cal_status != _SUCCESS:
            if self.now.state != "waiting":
                self._settle("failed", now_s)
            return
        offset = [_rounded(one) for one in (message.ofs_x, message.ofs_y, message.ofs_z)]
        self._change(error_mg=_rounded(message.fitness), offset_mg=offset, percent=100)
        if self.now.state != "waiting":
            self._settle("done" if message.autosaved else "waiting", now_s)

    def on_text(self, text: Text, now_s: float) -> None:
        """A STATUSTEXT of the boat: it may tell the end, and what was changed."""
        if self.now.state not in _RUNS:
            return
        if _CHANGE.fullmatch(text.text) and len(self.now.lines) < _MOST_LINES:
            self._change(lines=[*self.now.lines, text.text])
        if text.severity > _TOLD or text.text.startswith(("PreArm: ", "Failsafe")):
            return
        self._texts = [*self._texts[-9:], text]
        kind = KINDS[self.now.kind]
        if self.now.state == "asked" or self._is_settling:
            return
        if text.text.startswith(kind.bad):
            self._settle("failed", now_s)
        elif text.text.startswith(kind.good):
            self._settle(
                "waiting" if self.now.kind == "compass" and "accepted" in text.text else "done", now_s
            )

    def poll(self, now_s: float) -> None:
        """Repeat, settle, and tell what is not known."""
        self._repeat(now_s)
        if self._end is not None and now_s >= self._end[1]:
            self._finish(self._end[0])
        elif self.now.state in ("running", "silent") and self._end is None:
            if now_s - self._began_s > KINDS[self.now.kind].most_s + SILENT_S:
                self._change(state="unknown", percent=None, text=_NO_END)
            else:
                is_silent = now_s - self._heard_s > SILENT_S
                self._change(state="silent" if is_silent else "running")

    @property
    def _is_settling(self) -> bool:
        return self._end is not None

    def _ask(
        self, step: str, command: int, params: tuple[float, ...], answered: Answered, now_s: float
    ) -> None:
        self._sending = _Sending(step, command, params, answered, now_s + ANSWER_S, now_s + REPEAT_S)
        self._send(command_long(self._boat, command, *params))

    def _repeat(self, now_s: float) -> None:
        sending = self._sending
        if sending is None or (self._is_settling and sending.step == "start"):
            return
        if now_s >= sending.until_s:
            if sending.step == "start":
                self._change(state="unknown", text=NO_ANSWER)
            self._answer(Silent(NO_ANSWER))
        elif now_s >= sending.next_s and sending.sent < TRIES:
            self._sending = sending._replace(sent=sending.sent + 1, next_s=now_s + REPEAT_S)
            self._send(command_long(self._boat, sending.command, *sending.params, repeat=sending.sent))

    def _answer(self, outcome: Outcome) -> None:
        if (sending := self._sending) is not None:
            self._sending = None
            sending.answered(outcome)

    def _progress(self, percent: int) -> None:
        if self._end is None:
            self._change(state="running", percent=max(0, min(percent, 100)))

    def _settle(self, state: str, now_s: float) -> None:
        if self._end is None:
            self._end = state, now_s + SETTLE_S

    def _finish(self, state: str) -> None:
        self._end = None
        kind = KINDS[self.now.kind]
        begins = (*kind.good, *kind.bad)
        telling = [one.text for one in self._texts if one.text.startswith(begins)]
        others = [one.text for one in self._texts if one.severity < _TOLD]
        text = (telling or others or [_REFUSED if state == "failed" else ""])[-1]
        self._change(state=state, text=text, percent=100 if state in ("done", "waiting") else None)
        is_good = state in ("done", "waiting")
        self._answer(Accepted(text or STARTED) if is_good else Refused(text or STARTED))

    def _change(self, **values: object) -> None:
        if any(getattr(self.now, name) != value for name, value in values.items()):
            told = {"key": "", "values": {}} if "text" in values else {}
            self.now = msgspec.structs.replace(self.now, **(told | values))


def _rounded(value: float) -> float:
    return round(value, 1) if math.isfinite(value) else 0.0


def _ended(result: int) -> str:
    if result == dialect.MAV_RESULT_ACCEPTED:
        return "done"
    return "cancelled" if result == _CANCELLED else "failed"
