"""All sensors and their external substitutes: read once a tick, slow parts ten times a second.

The one place that knows how old a reading is: a part that is silent for longer than the `timeout_s` of its
configuration has no reading, and all that use one need only handle None.
"""

import math
from collections.abc import Callable

from companion.autopilot.esc_monitor import EscMonitor
from companion.config.boat_config import BoatConfig, Trim
from companion.config.sensors import CompassPart
from companion.core import readings
from companion.core.readings import BatteryReading, DepthReading, GnssFix, HeadingReading, SonarReading
from companion.core.state import STOPPED, MotorCommand
from companion.core.status_text import Severity, StatusText
from companion.estimation.estimator import Estimator
from companion.hal.interfaces import Hardware, PausingPart
from companion.obstacles.perception.sonar_scan import SECTOR_RAD, SonarScan
from companion.obstacles.perception.sonar_schedule import ALL_ROUND, Sector
from companion.sensors.compass.attitude import down_axis, level_field
from companion.sensors.compass.earth_field import EarthFieldModel
from companion.sensors.compass.magnetic_field import MotorLoad
from companion.sensors.external import ExternalSensors
from companion.sensors.fuel_gauge import FuelGauge, cells_fault
from companion.sensors.nmea.ais import nearest
from companion.sensors.plausibility import BATTERY, DEPTH, FIX, HEADING, ReadingGate
from companion.sensors.silence import SilenceMonitor, fresh

_FIX_2D = 2
_FIELD_RATIO = (0.6, 1.5)  # of the horizontal field to the earth's; beyond, iron is near
READ_S = 0.1  # between readings of the slow parts: the highest rate of the probes
SONAR_START_S = 5.0  # in which a ranger pings for the first time; later the failsafe SONAR_LOST tells


class SensorSuite:
    """The present readings, each None while its part is silent. compass: as measured; heading: the one to
    use. bottom: the latest sounding that found it.

    has_battery_monitor, is_sonar_fitted, is_ais_fitted: one is fitted. has_gyro, has_sonar, has_lidar: they
    have measured since boot.
    """

    def __init__(self, hardware: Hardware, external: ExternalSensors) -> None:
        self.external = external
        self.sweep = SonarScan()
        self.gauge = FuelGauge()
        self.fix: GnssFix | None = None
        self.is_fix_own = True  # from the boat's own receiver, not MAVLink
        self.compass: HeadingReading | None = None
        self.heading: HeadingReading | None = None
        self.battery: BatteryReading | None = None
        self.has_battery_monitor = hardware.battery is not None
        self.is_ais_fitted = hardware.ais is not None
        self.is_sonar_fitted = hardware.sonar is not None or hardware.lidar is not None
        self.has_gyro = self.has_sonar = self.has_lidar = False
        self.sonar: SonarReading | None = None  # the latest ping
        self.lidar: SonarReading | None = None  # the latest sector
        self.depth: DepthReading | None = None
        self.bottom: DepthReading | None = None
        self.ais: readings.AisReading | None = None
        self.probes: list[readings.ProbeReading] = []  # of those that are not silent
        self.escs = EscMonitor(hardware.escs)
        self.hull: readings.HullReading | None = None
        self.rc: readings.RcReading | None = None  # the latest RC frame
        self.pings: list[tuple[SonarReading, float | None]] = []  # of this tick, with beam widths in rad
        self.notices: list[StatusText] = []  # of this tick, for the operator
        self.earth = EarthFieldModel()
        self._slow_due_s = 0.0
        self._silences: dict[str, SilenceMonitor] = {}  # by the part's name
        self._measured: BatteryReading | None = None  # the monitor's latest, fresh or not
        self.field = hardware.field  # the correction of a bare magnetometer, None for other parts
        self._pausing = hardware.compass if isinstance(hardware.compass, PausingPart) else None
        self._hardware = hardware
        self._fix_gate = ReadingGate[GnssFix](FIX)
        self._compass_gate = ReadingGate[HeadingReading](HEADING)
        self._battery_gate = ReadingGate[BatteryReading](BATTERY)
        self._depth_gate = ReadingGate[DepthReading](DEPTH)
        self._sector: Sector = ALL_ROUND

    @property
    def consumed_mah(self) -> float:
        """Charge consumed since boot, or since the pack was changed."""
        return self.gauge.consumed_mah

    def declination_rad(self, part: CompassPart) -> float:
        """From true to magnetic north, east positive; 0 until the model has a position and a date."""
        if not part.auto_declination:
            return part.declination_rad
        return 0.0 if self.earth.field is None else self.earth.field.declination_rad

    def uses_earth_field(self, part: CompassPart) -> bool:
        """Whether the world magnetic model is needed: for the declination, or for a calibration."""
        return part.auto_declination or self.field is not None

    def locate(self, part: CompassPart, unix_s: float) -> None:
        """Find the earth's magnetic field at the fix, where it is used. unix_s: 0 if unknown."""
        reading, fix = self.compass, self.fix
        is_used = reading is not None and reading.is_magnetic and self.uses_earth_field(part)
        if is_used and fix is not None and fix.fix_type >= _FIX_2D:
            self.notices += self.earth.update(fix.position, unix_s)

    def compass_fault(self) -> str:
        """Why the headings of a bare magnetometer cannot be trusted, empty if they can."""
        field, reading, earth = self.field, self.compass, self.earth.field
        if field is None or (reading is not None and not reading.is_magnetic):
            return ""  # none, or in reserve
        if not field.correction.is_calibrated:
            return "not calibrated: start its calibration and turn the boat"
        if reading is None or reading.field_mg is None or earth is None:
            return ""
        down = down_axis(reading.roll_rad or 0.0, reading.pitch_rad or 0.0)
        level = level_field(field.correct(reading.field_mg), down)
        strength_mg = 0.0 if level is None else math.hypot(level[0], level[1])
        if _FIELD_RATIO[0] < strength_mg / earth.horizontal_mg < _FIELD_RATIO[1]:
            return ""
        return f"field of {strength_mg:.0f} mG, not {earth.horizontal_mg:.0f}: iron near, or calibrate again"

    def point_sonar(self, sector: Sector) -> None:
        """Set the sector of the boat's own ranger."""
        if sector != self._sector and self._hardware.sonar is not None:
            self._sector = sector
            self._hardware.sonar.set_sector(sector.port_rad, sector.starboard_rad)

    def read(self, config: BoatConfig, now_s: float, command: MotorCommand = STOPPED) -> None:
        """Read all sensors. command: the present motor command."""
        hardware, external, parts = self._hardware, self.external, config.parts
        if self.notices:
            self.notices.clear()
        own_fix = self._fix_gate.judge(hardware.gnss.read())
        fix = external.choose_fix(own_fix, config.external, now_s)
        self.is_fix_own = fix is own_fix
        self.fix = fresh(fix, parts.gnss.timeout_s, now_s) if self.is_fix_own else fix
        if self._pausing is not None:
            self._pausing.may_pause = not (command.left or command.right)
        compass = self._compass_gate.judge(hardware.compass.read())
        self.compass = fresh(compass, parts.compass.silence_s, now_s)
        self.has_gyro |= self.compass is not None and self.compass.yaw_rate_rad_s is not None
        own_heading = trimmed(compass, config.trim, self.declination_rad(parts.compass))
        heading = external.choose_heading(own_heading, config.external, now_s)
        self.heading = None if heading is own_heading and self.compass is None else heading
        if now_s >= self._slow_due_s:
            self._slow_due_s = now_s + READ_S - 1e-6
            self._read_slow_parts(config, now_s, command)
        if hardware.field is not None:
            battery = self.battery
            throttle = 0.5 * (abs(command.left) + abs(command.right))
            hardware.field.load = MotorLoad(throttle, None if battery is None else battery.current_a)
        if hardware.rc is not None:
            self.rc = hardware.rc.read()
        if self.pings:
            self.pings.clear()
        if hardware.sonar is not None:
            if pings := hardware.sonar.read():
                self.sonar, self.has_sonar = pings[-1], True
                for ping in pings:
                    self.sweep.add(ping)
                    self.pings.append((ping, None))
            self.sonar = fresh(self.sonar, config.failsafe.sonar_timeout_s, now_s)
        if hardware.lidar is not None:
            if sectors := hardware.lidar.read():
                self.lidar, self.has_lidar = sectors[-1], True
                external.pings.extend((ping, SECTOR_RAD) for ping in sectors)
            self.lidar = fresh(self.lidar, config.failsafe.sonar_timeout_s, now_s)
        while external.pings:
            ping, beam_rad = external.pings.popleft()
            self.sweep.add(ping, beam_rad)
            self.pings.append((ping, beam_rad))

    def _read_slow_parts(self, config: BoatConfig, now_s: float, command: MotorCommand) -> None:
        hardware, parts = self._hardware, config.parts
        if hardware.battery is not None:
            self._read_battery(self._battery_gate.judge(hardware.battery.read()), config, now_s, command)
        if hardware.hull is not None:
            self.hull = fresh(hardware.hull.read(), parts.hull.timeout_s, now_s)
            self._tell("Hull sensor", hardware.hull, self.hull, parts.hull.timeout_s, now_s)
        if hardware.depth is not None:
            self.depth = fresh(self._depth_gate.judge(hardware.depth.read()), parts.depth.timeout_s, now_s)
            found = self.bottom if self.depth is None or self.depth.depth_m is None else self.depth
            self.bottom = fresh(found, parts.depth.timeout_s, now_s)
            self._tell("Depth sounder", hardware.depth, self.depth, parts.depth.timeout_s, now_s)
        if hardware.ais is not None:
            self.ais = fresh(hardware.ais.read(), parts.ais.timeout_s, now_s)
            if self.ais is not None and self.fix is not None:
                self.ais = nearest(self.ais, self.fix.position)
            self._tell("AIS receiver", hardware.ais, self.ais, parts.ais.timeout_s, now_s)
        if hardware.probes:
            self._read_probes(config, now_s)
        if hardware.escs:
            self.notices += self.escs.update(parts.motors, command, now_s, 1 + config.drive.has_pair)
        if hardware.sonar is not None:
            self._tell("Sonar", hardware.sonar, self.has_sonar or None, SONAR_START_S, now_s)
        if hardware.lidar is not None:
            self._tell("Lidar", hardware.lidar, self.has_lidar or None, SONAR_START_S, now_s)

    def _read_battery(
        self, battery: BatteryReading | None, config: BoatConfig, now_s: float, command: MotorCommand
    ) -> None:
        timeout_s = config.parts.battery.timeout_s
        if battery is not None and battery is not self._measured:
            fault = cells_fault(battery.voltage_v, config.battery.cells) if self._measured is None else ""
            if fault:
                self.notices.append(StatusText(Severity.WARNING, fault))
            self._measured = battery
            self.gauge.update(battery, config.battery, command)
        self.battery = fresh(battery, timeout_s, now_s)
        self._tell("Battery monitor", self._hardware.battery, self.battery, timeout_s, now_s)

    def _read_probes(self, config: BoatConfig, now_s: float) -> None:
        self.probes.clear()
        for part, probe in zip(config.probe, self._hardware.probes, strict=True):
            reading = fresh(probe.read(), part.timeout_s, now_s)
            self._tell(f"Probe {part.name}", probe, reading, part.timeout_s, now_s)
            if reading is not None:
                self.probes.append(reading)

    def _tell(self, name: str, part: object, reading: object, timeout_s: float, now_s: float) -> None:
        if (silence := self._silences.get(name)) is None:
            silence = self._silences[name] = SilenceMonitor(name, part)
        if (notice := silence.update(timeout_s, now_s, is_heard=reading is not None)) is not None:
            self.notices.append(notice)


def trimmed(
    reading: HeadingReading | None, trim: Trim, declination_rad: float = 0.0
) -> HeadingReading | None:
    """The reading from true north, with heading trim and gyro bias applied."""
    if reading is None:
        return None
    turn_rad = trim.heading_rad + declination_rad * reading.is_magnetic
    if turn_rad == 0.0 and trim.gyro_bias_rad_s == 0.0:
        return reading
    rate = reading.yaw_rate_rad_s
    return HeadingReading(
        reading.time_s, reading.heading_rad + turn_rad, None if rate is None else rate - trim.gyro_bias_rad_s
    )


class OriginMonitor:
    """Moves the origin of a disarmed boat that was carried beyond the frame; warns while it is armed."""

    def __init__(self, estimator: Estimator, external: ExternalSensors) -> None:
        self._estimator = estimator
        self._external = external
        self._far_m = 0.0  # how far beyond the frame every fix lies, 0 within

    def share_frame(self) -> None:
        """Whichever of both has a frame gives it to the other. Before the estimator's update."""
        if self._estimator.frame is None:
            self._estimator.preset_frame = self._external.frame
        elif self._external.frame is None:
            self._external.frame = self._estimator.frame

    def check(self, armed: bool, notify: Callable[[int, str], None]) -> float:
        """How far the origin has been moved, 0 if it has not. After the estimator's update."""
        far_m, was_far = self._estimator.far_m, self._far_m > 0.0
        self._far_m = far_m if armed else 0.0
        if far_m == 0.0 or armed:
            if far_m > 0.0 and not was_far:
                text = f"GPS: {far_m / 1e3:.0f} km from where the boat was, not used until disarmed"
                notify(Severity.WARNING, text)
            return 0.0
        if self._external.frame is self._estimator.frame:
            self._external.frame = None
        self._estimator.reset_origin()
        return far_m
