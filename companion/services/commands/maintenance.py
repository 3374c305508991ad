"""Maintenance commands: calibration, motor test, stored settings, restart."""

import math
from dataclasses import dataclass, field

from companion import __version__
from companion.calibration.motor_test import MotorTest, TestedMotor
from companion.core.readings import HeadingReading
from companion.core.status_text import Severity
from companion.core.units import wrap_pi
from companion.mavlink.dialect import dialect
from companion.sensors.fuel_gauge import FuelGauge
from companion.services.commands.command import Command, CommandTable, Result
from companion.services.commands.compass import CompassCommands
from companion.services.outbox import Origin
from companion.services.parameters import ParameterService
from companion.services.statustext import StatusTextService
from companion.vehicle.vehicle import Vehicle

_RESTART_AFTER_S = 0.3  # time to send the ACK
_RESTART_LATEST_S = 5.0  # a program that still runs then does not restart, such as that of an emulated fleet
_PERCENT, _PWM = 0, 1  # MOTOR_TEST_THROTTLE_TYPE
_FIRST_PACK = 1
_RADIO_S = 600.0  # time-out of the RC calibration
_SELF_CALIBRATING = "Compass: calibrates itself while turning; Fast Calibration aligns it with the bow"
_NOTHING_TO_CALIBRATE = (  # param2 to param6 of PREFLIGHT_CALIBRATION
    _SELF_CALIBRATING,
    "Pressure: this boat has no barometer",
    "RC: this boat has no receiver",
    "Accelerometer: the heading sensor calibrates itself",
    "Compass: interference of the motors is not measured",
)
_TRIM, _BIAS = "HDG_TRIM", "INS_GYROFFS_Z"

_GYRO_S = 3.0  # of a calibration
_LEAST_READINGS = 20
_STILL_RAD_S = 0.1  # largest deviation from the mean at rest
_MOST_BIAS_RAD_S = 0.2


@dataclass(eq=False)
class _GyroCalibration:
    """Averages the yaw gyro's readings, as measured, while the boat is at rest."""

    _began_s: float
    _rates_rad_s: dict[float, float] = field(default_factory=dict)  # by the time of their reading

    def progress_percent(self, now_s: float) -> int:
        return min(int(100.0 * (now_s - self._began_s) / _GYRO_S), 99)

    def update(self, reading: HeadingReading | None, now_s: float) -> bool:
        """Add the latest reading. Whether there are enough."""
        if reading is not None and reading.yaw_rate_rad_s is not None and reading.time_s > self._began_s:
            self._rates_rad_s[reading.time_s] = reading.yaw_rate_rad_s
        return now_s - self._began_s >= _GYRO_S

    def bias_rad_s(self) -> float | str:
        """The mean rate, or why it is no bias."""
        rates = self._rates_rad_s.values()
        if len(rates) < _LEAST_READINGS:
            return "Gyro: the compass measures no yaw rate"
        mean = sum(rates) / len(rates)
        if max(abs(rate - mean) for rate in rates) > _STILL_RAD_S or abs(mean) > _MOST_BIAS_RAD_S:
            return "Gyro: the boat moved, not calibrated"
        return mean


@dataclass(eq=False)
class MaintenanceCommands:
    """All of them require a disarmed boat."""

    _vehicle: Vehicle
    _motor_test: MotorTest
    _parameters: ParameterService
    _texts: StatusTextService
    _compass: CompassCommands
    _gauge: FuelGauge
    restart_due_s: float = field(default=math.inf, init=False)
    _gyro: _GyroCalibration | None = field(default=None, init=False)  # in progress
    _heading: HeadingReading | None = field(default=None, init=False)
    _tester: Origin | None = field(default=None, init=False)  # the station that requested the motor test
    _tester_seen_s: float = field(default=-math.inf, init=False)
    _test_told: str = field(default="", init=False)

    def __post_init__(self) -> None:
        self.table: CommandTable = {
            dialect.MAV_CMD_BATTERY_RESET: self._reset_battery,
            dialect.MAV_CMD_DO_CANCEL_MAG_CAL: self._calibrate_compass,  # by which QGroundControl's page asks
            dialect.MAV_CMD_DO_START_MAG_CAL: self._calibrate_compass,
            dialect.MAV_CMD_DO_MOTOR_TEST: self._test_motor,
            dialect.MAV_CMD_DO_SEND_BANNER: self._send_banner,
            dialect.MAV_CMD_FIXED_MAG_CAL_YAW: self._trim_compass,
            dialect.MAV_CMD_PREFLIGHT_CALIBRATION: self._calibrate,
            dialect.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN: self._restart,
            dialect.MAV_CMD_PREFLIGHT_STORAGE: self._store,
        }

    def tick(self, heading: HeadingReading | None, now_s: float) -> Result | None:
        """Continue calibration and motor test. The result of a calibration that has just ended, or None."""
        self._heading = heading
        if self._motor_test.is_running:
            self._watch_tester(now_s)
        if now_s > self.restart_due_s + _RESTART_LATEST_S:
            self.restart_due_s, self._vehicle.is_restarting = math.inf, False
            self._report(Result.FAILED, "Reboot: this program does not restart")
        job = self._gyro
        if job is None:
            return None
        if self._vehicle.armed:
            return self._cancel()
        if not job.update(heading, now_s):
            return None
        self._gyro, bias = None, job.bias_rad_s()
        if isinstance(bias, str):
            return self._report(Result.FAILED, bias, Severity.WARNING)
        if reason := self._parameters.set(_BIAS, bias):
            return self._report(Result.FAILED, reason)
        return self._report(Result.ACCEPTED, "Gyro calibrated", Severity.NOTICE)

    def progress_percent(self, now_s: float) -> int | None:
        """Progress of a gyro calibration, None without one."""
        return None if self._gyro is None else self._gyro.progress_percent(now_s)

    def _cancel(self) -> Result:
        self._gyro = None
        return Result.CANCELLED

    def on_message(self, origin: Origin, now_s: float) -> None:
        """Any message from a station."""
        if self._tester == origin:
            self._tester_seen_s = now_s

    def forget(self, channel: int) -> None:
        """A channel has closed; a motor test requested on it ends."""
        if self._motor_test.is_running and self._tester is not None and self._tester.channel == channel:
            self._end_test("its link has closed")

    def _watch_tester(self, now_s: float) -> None:
        """The station of a motor test must be present, with the operator's time-out."""
        if now_s - self._tester_seen_s > self._vehicle.config.failsafe.gcs_timeout_s:
            self._end_test("its station is silent")

    def _end_test(self, why: str) -> None:
        self._motor_test.stop()
        self._texts.notify(Severity.WARNING, f"Motor test: ended, {why}")

    def _report(self, result: Result, text: str, severity: int = Severity.ERROR) -> Result:
        self._texts.notify(severity, text)
        return result

    def _test_motor(self, command: Command) -> Result:
        motor, kind = command.whole(0), command.whole(1)
        value, duration_s = command.p[2], command.p[3]
        if motor not in tuple(TestedMotor) or kind not in (_PERCENT, _PWM):
            return Result.DENIED
        share = value / 100.0 if kind == _PERCENT else (value - 1500.0) / 500.0
        if not (abs(share) <= 1.0 and 0.0 <= duration_s < math.inf):
            return Result.DENIED
        if share == 0.0 or duration_s == 0.0:
            self._motor_test.stop()
            return Result.ACCEPTED
        vehicle, was_running = self._vehicle, self._motor_test.is_running
        if vehicle.output_fault:
            return self._report(Result.FAILED, f"Motor test: {vehicle.output_fault}")
        if reason := self._motor_test.start(
            TestedMotor(motor), share, duration_s, vehicle.status, command.now_s, vehicle.config.drive
        ):
            return self._report(Result.FAILED, f"Motor test: {reason}")
        self._tester, self._tester_seen_s = command.origin, command.now_s
        name = TestedMotor(motor).name.lower()
        told, before = f"Motor test: {name} {100.0 * share:.0f} %", self._test_told
        self._test_told = told
        if was_running and told == before:
            return Result.ACCEPTED  # a station prolongs it, several times a second
        return self._report(Result.ACCEPTED, told, Severity.NOTICE)

    def _calibrate(self, command: Command) -> Result:
        """Calibrate the gyro, or allow a station's RC calibration. All zero cancels."""
        radio = self._vehicle.manual_input.rc
        wanted = [one if math.isfinite(one) else 0.0 for one in (*command.p, command.fifth, command.sixth)]
        if not any(wanted):
            radio.calibrated_until_s = -math.inf
            if (cancelled := self._compass.cancel_motors()) is not None:
                return cancelled
            return Result.ACCEPTED if self._gyro is None else self._cancel()
        if wanted[3] and radio.is_fitted and not any(wanted[:3] + wanted[4:]):
            return self._calibrate_radio(command.now_s)
        if wanted[5] == 1.0 and self._compass.is_fitted and not any(wanted[:5]):
            return self._compass.measure_motors(command)
        for reason, is_wanted in zip(_NOTHING_TO_CALIBRATE, wanted[1:], strict=True):
            if is_wanted:
                return self._report(Result.UNSUPPORTED, reason)
        if command.p[0] != 1.0:
            return Result.UNSUPPORTED
        if self._vehicle.armed:
            return self._report(Result.REJECTED_FOR_NOW, "Calibration: disarm first")
        if self._gyro is None:
            self._gyro = _GyroCalibration(command.now_s)
        return Result.IN_PROGRESS

    def _calibrate_radio(self, now_s: float) -> Result:
        if self._vehicle.armed:
            return self._report(Result.REJECTED_FOR_NOW, "Calibration: disarm first")
        self._vehicle.manual_input.rc.calibrated_until_s = now_s + _RADIO_S
        return Result.ACCEPTED

    def _calibrate_compass(self, command: Command) -> Result:  # noqa: ARG002
        """The heading sensor calibrates itself. There is no report: it has neither failed nor succeeded."""
        return self._report(Result.UNSUPPORTED, _SELF_CALIBRATING)

    def _trim_compass(self, command: Command) -> Result:
        """Trim the compass to the true heading param1 in degrees."""
        if self._vehicle.armed:
            return self._report(Result.REJECTED_FOR_NOW, "Compass: disarm first")
        if not math.isfinite(command.p[0]):
            return Result.DENIED
        if self._heading is None or math.isnan(self._heading.heading_rad):
            return self._report(Result.FAILED, "Compass: no heading")
        trim_deg = math.degrees(wrap_pi(math.radians(command.p[0]) - self._heading.heading_rad))
        if reason := self._parameters.set(_TRIM, trim_deg):
            return self._report(Result.FAILED, reason)
        return self._report(Result.ACCEPTED, f"Compass trimmed by {trim_deg:.0f} degrees", Severity.NOTICE)

    def _reset_battery(self, command: Command) -> Result:
        """The pack was changed or charged: set the fuel gauge and end the battery failsafes.

        param1: bit mask of packs, of which the boat has the first; param2: charge in percent.
        """
        packs, percent = command.whole(0), command.p[1]
        if packs is None or packs < 0 or not 0.0 <= percent <= 100.0:
            return Result.DENIED
        if not packs & _FIRST_PACK or not self._vehicle.has_battery_monitor:
            return self._report(Result.FAILED, "Battery: no such monitor")
        if self._vehicle.armed:
            return self._report(Result.REJECTED_FOR_NOW, "Battery: disarm first")
        self._gauge.reset(percent / 100.0)
        self._vehicle.failsafes.renew_pack(percent / 100.0)
        return self._report(Result.ACCEPTED, f"Battery set to {percent:.0f} %", Severity.NOTICE)

    def _store(self, command: Command) -> Result:
        """Every change is stored immediately; only the reset has an effect."""
        match command.whole(0):
            case 0 | 1:
                return Result.ACCEPTED
            case 2 if self._vehicle.armed:
                return self._report(Result.REJECTED_FOR_NOW, "Parameters: disarm first")
            case 2:
                self._parameters.reset()
                return self._report(Result.ACCEPTED, "Parameters reset to the boat's file", Severity.NOTICE)
            case _:
                return Result.DENIED

    def _restart(self, command: Command) -> Result:
        """Only a restart: after a shutdown the boat could not be reached."""
        match command.whole(0):
            case 0:
                return Result.ACCEPTED
            case 1 if self._vehicle.armed:
                return self._report(Result.FAILED, "Reboot: disarm first")
            case 1:
                self._vehicle.is_restarting = True
                self.restart_due_s = min(self.restart_due_s, command.now_s + _RESTART_AFTER_S)
                return self._report(Result.ACCEPTED, "Rebooting", Severity.NOTICE)
            case _:
                return Result.UNSUPPORTED

    def _send_banner(self, command: Command) -> Result:  # noqa: ARG002
        return self._report(Result.ACCEPTED, f"mavboat {__version__}, a boat with two motors", Severity.INFO)
