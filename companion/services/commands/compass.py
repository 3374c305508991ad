"""The commands that calibrate a bare magnetometer: DO_START_MAG_CAL, DO_ACCEPT_MAG_CAL, DO_CANCEL_MAG_CAL,
FIXED_MAG_CAL_YAW, and the motors' field by PREFLIGHT_CALIBRATION.

Progress and report go to the station that started it, as ArduPilot sends them. The result becomes parameters,
which are stored at once.
"""

import math
from dataclasses import dataclass, field
from typing import Final

from companion.autopilot.sensor_suite import SensorSuite
from companion.calibration.compass import CompassCalibration, CompassVerdict, FieldFit
from companion.calibration.motor_field import MotorFieldCalibration
from companion.config.compass_rows import MOST_OFFSET_MG
from companion.core.status_text import Severity
from companion.core.vectors import UNIT
from companion.mavlink.dialect import Message, build_message, dialect
from companion.sensors.compass.magnetic_field import (
    BY_CURRENT,
    MagneticCorrection,
    MotorLoad,
    parameter_values,
)
from companion.services.commands.command import Command, CommandTable, Result
from companion.services.outbox import Outbox
from companion.services.parameters import ParameterService
from companion.services.statustext import StatusTextService
from companion.vehicle.vehicle import Vehicle

_PROGRESS_S: Final = 0.25
_REPORT_S: Final = 1.0  # between repetitions: a station waits for the report for ever
_REPORTS: Final = 5
_STARTED: Final = "Compass: turn the boat slowly through a full circle, or in the hands about all axes"
_MOTORS_STARTED: Final = "Compass: boat moored, raise the throttle slowly to 70 %, then back to zero"


@dataclass(eq=False)
class CompassCommands:
    """Runs one calibration at a time. `is_fitted`: there is a magnetometer to calibrate."""

    _vehicle: Vehicle
    _sensors: SensorSuite
    _parameters: ParameterService
    _texts: StatusTextService
    _outbox: Outbox
    _channel: int = field(default=0, init=False)  # of the station that started it
    _calibration: CompassCalibration | None = field(default=None, init=False)
    _saves: bool = field(default=True, init=False)
    _unsaved: FieldFit | None = field(default=None, init=False)  # until it is accepted
    _motors: MotorFieldCalibration | None = field(default=None, init=False)
    _iron_loads: tuple[MotorLoad, ...] = field(default=(), init=False)  # while the iron was calibrated
    _reports_left: int = field(default=0, init=False)
    _due_s: float = field(default=0.0, init=False)

    def __post_init__(self) -> None:
        self._report = FieldFit(CompassVerdict.FAILED, "", MagneticCorrection())
        self.table: CommandTable = {}
        if self.is_fitted:
            self.table = {
                dialect.MAV_CMD_DO_START_MAG_CAL: self._start,
                dialect.MAV_CMD_DO_ACCEPT_MAG_CAL: self._accept,
                dialect.MAV_CMD_DO_CANCEL_MAG_CAL: self._cancel,
                dialect.MAV_CMD_FIXED_MAG_CAL_YAW: self._set_by_heading,
            }

    @property
    def is_fitted(self) -> bool:
        """Whether the compass is a bare magnetometer."""
        return self._sensors.field is not None

    @property
    def is_busy(self) -> bool:
        return self._calibration is not None or self._motors is not None

    def forget(self, channel: int) -> None:
        """A channel has closed; a calibration that was started on it goes on without reports."""
        if channel == self._channel:
            self._reports_left = 0

    # The boat's iron

    def _start(self, command: Command) -> Result:
        """param1: mask of compasses, 0 all; param3: 1 saves the result, 0 waits for DO_ACCEPT_MAG_CAL."""
        mask = command.whole(0)
        field = self._sensors.field
        if mask is None or field is None or (mask and not mask & 1):
            return Result.DENIED
        if not self._may_calibrate():
            self._texts.notify(Severity.ERROR, "Compass: disarm, or choose MANUAL, to calibrate")
            return Result.REJECTED_FOR_NOW
        self._motors = None
        self._calibration = CompassCalibration(field.correction, self._sensors.earth.field, command.now_s)
        self._saves, self._unsaved = command.whole(2) == 1, None
        self._channel, self._reports_left, self._due_s = command.origin.channel, 0, command.now_s
        self._texts.notify(Severity.NOTICE, _STARTED)
        return Result.ACCEPTED

    def _may_calibrate(self) -> bool:
        return not self._vehicle.armed or not self._vehicle.mode.rules.needs_position

    def _accept(self, command: Command) -> Result:  # noqa: ARG002
        """Save a result that has waited for it."""
        if self._unsaved is None:
            return Result.FAILED
        self._save(self._unsaved.correction)
        self._unsaved = None
        return Result.ACCEPTED

    def _cancel(self, command: Command) -> Result:  # noqa: ARG002
        """Also how QGroundControl asks whether there is a calibration: accepted with nothing to cancel."""
        if self._calibration is not None:
            self._texts.notify(Severity.NOTICE, "Compass calibration cancelled")
        self._calibration = self._unsaved = None
        self._reports_left = 0
        return Result.ACCEPTED

    def tick(self, now_s: float) -> Result | None:
        """Continue. Returns the result of a measurement of the motors' field that has just ended."""
        if self._calibration is not None:
            self._calibrate(self._calibration, now_s)
        elif self._reports_left and now_s >= self._due_s:
            self._due_s = now_s + _REPORT_S
            self._reports_left -= 1
            self._outbox.send(self._channel, self._report_message())
        return None if self._motors is None else self._measure_motors(self._motors, now_s)

    def _calibrate(self, calibration: CompassCalibration, now_s: float) -> None:
        if self._sensors.field is not None:
            calibration.update(self._sensors.compass, now_s, self._sensors.field.load)
        if not self._may_calibrate():
            self._end(calibration, calibration.failed(f"mode {self._vehicle.mode.name}"), now_s)
        elif calibration.is_complete:
            self._end(calibration, calibration.solve(self._parameters.value("COMPASS_CAL_FIT")), now_s)
        elif calibration.is_late(now_s):
            seen = f"only {calibration.progress_percent} % of the directions were seen"
            self._end(calibration, calibration.failed(seen), now_s)
        elif now_s >= self._due_s:
            self._due_s = now_s + _PROGRESS_S
            progress = build_message(
                "MAG_CAL_PROGRESS",
                cal_mask=1,
                cal_status=int(CompassVerdict.RUNNING),
                attempt=1,
                completion_pct=calibration.progress_percent,
            )
            self._outbox.send(self._channel, progress)

    def _end(self, calibration: CompassCalibration, fit: FieldFit, now_s: float) -> None:
        self._calibration = None
        self._iron_loads = tuple(calibration.loads)
        self._report, self._reports_left, self._due_s = fit, _REPORTS, now_s
        if fit.verdict is not CompassVerdict.SUCCESS:
            self._texts.notify(Severity.ERROR, f"Compass not calibrated: {fit.reason}")
            return
        degrees = math.degrees(fit.fitness_mg / fit.radius_mg) if calibration.dimensions == 2 else 0.0
        error = f"error {fit.fitness_mg:.1f} mG" + (f", {degrees:.1f} degrees" if degrees else "")
        if self._saves:
            self._save(fit.correction)
            self._texts.notify(Severity.NOTICE, f"Compass calibrated: {error}")
        else:
            self._unsaved = fit
            self._texts.notify(Severity.NOTICE, f"Compass calibration to be accepted: {error}")

    def _save(self, correction: MagneticCorrection) -> None:
        for name, value in parameter_values(correction):
            if reason := self._parameters.set(name, value):
                self._texts.notify(Severity.WARNING, reason)

    def _report_message(self) -> Message:
        fit = self._report
        (a, d, e), (_, b, f), (_, _, c) = fit.correction.matrix
        return dialect.MAVLink_mag_cal_report_message(
            0, 1, int(fit.verdict), int(self._saves), fit.fitness_mg, *fit.correction.offset, a, b, c, d, e, f
        )

    # One heading that is known

    def _set_by_heading(self, command: Command) -> Result:
        """For a boat that cannot be turned: the offset from the true heading param1 in degrees and the
        earth's field. Soft iron is left out.
        """
        field, reading = self._sensors.field, self._sensors.compass
        if self._vehicle.armed:
            return self._refuse(Result.REJECTED_FOR_NOW, "disarm first")
        if not math.isfinite(command.p[0]) or field is None:
            return Result.DENIED
        if reading is None or reading.field_mg is None:
            return self._refuse(Result.FAILED, "no reading")
        if (earth := self._sensors.earth.field) is None:
            return self._refuse(Result.FAILED, "the earth's field needs a position and a date")
        config = self._vehicle.config
        part = config.parts.compass
        other_rad = self._sensors.declination_rad(part) + part.correction_rad + config.trim.heading_rad
        magnetic_rad = math.radians(command.p[0]) - other_rad
        expected = to_body(
            (earth.horizontal_mg * math.cos(magnetic_rad), -earth.horizontal_mg * math.sin(magnetic_rad)),
            earth.down_mg,
            reading.roll_rad or 0.0,
            reading.pitch_rad or 0.0,
        )
        x, y, z = (a - b for a, b in zip(expected, reading.field_mg, strict=True))
        if max(abs(x), abs(y), abs(z)) > MOST_OFFSET_MG:
            return self._refuse(Result.FAILED, "iron or a magnet is too near: move the compass")
        before = field.correction
        self._save(MagneticCorrection((x, y, z), UNIT, before.motor, before.motor_source))
        self._texts.notify(Severity.NOTICE, f"Compass calibrated: offsets {x:.0f}, {y:.0f}, {z:.0f} mG")
        return Result.ACCEPTED

    def _refuse(self, result: Result, reason: str) -> Result:
        self._texts.notify(Severity.ERROR, f"Compass: {reason}")
        return result

    # The motors' field

    def measure_motors(self, command: Command) -> Result:
        """PREFLIGHT_CALIBRATION, param6 = 1. The operator runs motors, armed in MANUAL or by motor tests."""
        field = self._sensors.field
        if field is None or not field.correction.is_calibrated:
            return self._refuse(Result.FAILED, "calibrate it before the motors' field is measured")
        if not self._may_calibrate():
            return self._refuse(Result.REJECTED_FOR_NOW, "choose MANUAL to measure the motors' field")
        if self._motors is None:
            self._motors = MotorFieldCalibration(field.correction, command.now_s, self._iron_loads)
            self._texts.notify(Severity.NOTICE, _MOTORS_STARTED)
        return Result.IN_PROGRESS

    def progress_percent(self, now_s: float) -> int | None:
        """Progress of the motors' measurement, None without one."""
        return None if self._motors is None else self._motors.progress_percent(now_s)

    def cancel_motors(self) -> Result | None:
        """End the measurement without a result; None if there is none."""
        motors, self._motors = self._motors, None
        return None if motors is None else Result.CANCELLED

    def _measure_motors(self, job: MotorFieldCalibration, now_s: float) -> Result | None:
        if not self._may_calibrate():
            return self.cancel_motors()
        field = self._sensors.field
        if field is not None:
            job.update(self._sensors.compass, field.load, now_s)
        if not job.is_complete:
            return None
        self._motors = None
        fit = job.solve()
        if fit.reason:
            return self._refuse(Result.FAILED, f"motors' field not measured: {fit.reason}")
        self._save(fit.correction)
        source = "current" if fit.correction.motor_source == BY_CURRENT else "throttle"
        degrees = math.degrees(math.atan(fit.share))
        text = f"Compass: motors' field by {source}, up to {100.0 * fit.share:.0f} % or {degrees:.0f} degrees"
        self._texts.notify(Severity.NOTICE, text)
        return Result.ACCEPTED


def to_body(
    level: tuple[float, float], down_mg: float, roll_rad: float, pitch_rad: float
) -> tuple[float, float, float]:
    """A vector in level axes (ahead, starboard; down) in those of a boat that rolls and pitches."""
    ahead, aside = level
    cos, sin = math.cos(pitch_rad), math.sin(pitch_rad)
    x, z = ahead * cos - down_mg * sin, ahead * sin + down_mg * cos
    cos, sin = math.cos(roll_rad), math.sin(roll_rad)
    return x, aside * cos + z * sin, -aside * sin + z * cos
