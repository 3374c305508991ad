"""Commands that start calibration runs: DO_AUTOTUNE_ENABLE (heading), USER_1 (thrusters), USER_2 (stop).

They answer IN_PROGRESS until the run ends. Its results become parameters.
"""

from dataclasses import dataclass
from functools import partial

from companion.calibration.runner import HEADING, STOP, THRUSTERS, Calibration, CalibrationRunner
from companion.core.status_text import Severity
from companion.mavlink.dialect import dialect
from companion.services.commands.command import Command, CommandTable, Result
from companion.services.parameters import ParameterService
from companion.services.statustext import StatusTextService
from companion.vehicle.vehicle import Vehicle

_AXES = (0, 4)  # AUTOTUNE_AXIS: default, yaw


@dataclass(eq=False)
class CalibrationCommands:
    """Starts runs and stores their results."""

    _vehicle: Vehicle
    _runner: CalibrationRunner
    _parameters: ParameterService
    _texts: StatusTextService

    def __post_init__(self) -> None:
        self.table: CommandTable = {
            dialect.MAV_CMD_DO_AUTOTUNE_ENABLE: self._tune_heading,
            dialect.MAV_CMD_USER_1: partial(self._calibrate, THRUSTERS),
            dialect.MAV_CMD_USER_2: partial(self._calibrate, STOP),
        }

    def tick(self) -> Result | None:
        """The result of a run that has just ended, else None."""
        result = self._runner.take_result()
        if result is None:
            return None
        if result.reason:
            self._texts.notify(Severity.WARNING, f"{result.kind.name} aborted: {result.reason}")
            return Result.FAILED
        for name, value in result.findings:
            short = float(f"{value:.4g}")
            was = self._parameters.value(name)
            if reason := self._parameters.set(name, short):
                self._texts.notify(Severity.WARNING, reason)
            else:
                self._texts.notify(Severity.INFO, f"{name} {was:.4g} -> {short:g}")
        self._texts.notify(Severity.NOTICE, f"{result.kind.name} done: {len(result.findings)} parameters set")
        return Result.ACCEPTED

    def progress_percent(self, now_s: float) -> int | None:
        """Progress of a run, None without one."""
        return self._runner.progress_percent(now_s) if self._runner.is_running else None

    def _tune_heading(self, command: Command) -> Result:
        """param1: 1 starts, 0 aborts; param2: axes, 0 or 4 (yaw)."""
        return Result.DENIED if command.whole(1) not in _AXES else self._start(HEADING, command, 0.0)

    def _calibrate(self, kind: Calibration, command: Command) -> Result:
        """param1: 1 starts, 0 aborts; param2: radius in m, 0 for the default."""
        radius_m = command.p[1]
        return self._start(kind, command, radius_m) if 0.0 <= radius_m <= 10000.0 else Result.DENIED

    def _start(self, kind: Calibration, command: Command, radius_m: float) -> Result:
        runner, vehicle, wanted = self._runner, self._vehicle, command.whole(0)
        if wanted == 0:
            if not runner.is_running or runner.kind is not kind:
                return Result.ACCEPTED
            runner.stop("by command")
            runner.take_result()
            self._texts.notify(Severity.NOTICE, f"{kind.name} aborted by command")
            return Result.CANCELLED
        if wanted != 1:
            return Result.DENIED
        if runner.is_running and runner.kind is kind:
            return Result.IN_PROGRESS
        if reason := runner.start(
            kind, radius_m, vehicle.status, vehicle.nav, vehicle.fence, vehicle.config, command.now_s
        ):
            self._texts.notify(Severity.WARNING, f"{kind.name}: {reason}")
            return Result.REJECTED_FOR_NOW
        self._texts.notify(Severity.NOTICE, f"{kind.name} started, within {runner.radius_m:.1f} m")
        return Result.IN_PROGRESS
