"""Commands that start trials afloat: DO_AUTOTUNE_ENABLE the heading's, USER_1 the thrusters'.

Both answer IN_PROGRESS until the trial has ended. What it has found becomes parameters, each told in words.
"""

from collections.abc import Callable

from companion.calibration.trials import HEADING, THRUSTERS, Kind, Trials
from companion.core.status_text import Severity, StatusText
from companion.mavlink.dialect import dialect
from companion.services.commands.command import (
    ACCEPTED,
    CANCELLED,
    DENIED,
    FAILED,
    IN_PROGRESS,
    REJECTED_FOR_NOW,
    Command,
)
from companion.services.commands.vehicle import Tell
from companion.services.parameters import ParameterService

_AXES = (0, 4)  # AUTOTUNE_AXIS: the usual one, yaw


class CalibrationCommands:
    """Starts trials, and writes down what they find."""

    def __init__(self, trials: Trials, parameters: ParameterService, tell: Tell) -> None:
        self._trials = trials
        self._parameters = parameters
        self._tell = tell
        self.table: dict[int, Callable[[Command], int]] = {
            dialect.MAV_CMD_DO_AUTOTUNE_ENABLE: self._tune_heading,
            dialect.MAV_CMD_USER_1: self._calibrate_thrusters,
        }

    def tick(self) -> int | None:
        """The result of a trial that has just ended, else None."""
        ending = self._trials.take_ending()
        if ending is None:
            return None
        if ending.reason:
            self._report(Severity.WARNING, f"{ending.kind.name} aborted: {ending.reason}")
            return FAILED
        for name, value in ending.findings:
            short = float(f"{value:.4g}")
            was = self._parameters.value(name)
            if reason := self._parameters.set(name, short):
                self._report(Severity.WARNING, reason)
            else:
                self._report(Severity.INFO, f"{name} {was:.4g} -> {short:g}")
        self._report(Severity.NOTICE, f"{ending.kind.name} done: {len(ending.findings)} parameters set")
        return ACCEPTED

    def progress_percent(self, now_s: float) -> int | None:
        """How far a trial is, None while there is none."""
        return self._trials.progress_percent(now_s) if self._trials.is_running else None

    def _tune_heading(self, command: Command) -> int:
        """param1 starts (1) or breaks off (0); param2: axes, 0 or 4 (yaw)."""
        return DENIED if command.whole(1) not in _AXES else self._start(HEADING, command, 0.0)

    def _calibrate_thrusters(self, command: Command) -> int:
        """param1 starts (1) or breaks off (0); param2: radius in m, 0 the usual one."""
        radius_m = command.p[1]
        return self._start(THRUSTERS, command, radius_m) if 0.0 <= radius_m <= 10000.0 else DENIED

    def _start(self, kind: Kind, command: Command, radius_m: float) -> int:
        trials, wanted = self._trials, command.whole(0)
        if wanted == 0:
            if not trials.is_running or trials.kind is not kind:
                return ACCEPTED
            trials.stop("by command")
            trials.take_ending()
            self._report(Severity.NOTICE, f"{kind.name} aborted by command")
            return CANCELLED
        if wanted != 1:
            return DENIED
        if trials.is_running and trials.kind is kind:
            return IN_PROGRESS
        if reason := trials.begin(kind, radius_m, command.now_s):
            self._report(Severity.WARNING, f"{kind.name}: {reason}")
            return REJECTED_FOR_NOW
        self._report(Severity.NOTICE, f"{kind.name} started, within {trials.radius_m:.1f} m")
        return IN_PROGRESS

    def _report(self, severity: int, text: str) -> None:
        self._tell([StatusText(severity, text)])
