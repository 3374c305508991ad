"""All sensors and their external substitutes, read once a tick."""

from companion.config.boat_config import BoatConfig, Trim
from companion.core.state import STOPPED, MotorCommand
from companion.hal.interfaces import Hardware
from companion.obstacles.perception.sonar_scan import SonarScan
from companion.obstacles.perception.sonar_schedule import ALL_ROUND, Sector
from companion.sensors.external import ExternalSensors
from companion.sensors.fuel_gauge import FuelGauge
from companion.sensors.readings import (
    BatteryReading,
    GnssFix,
    HeadingReading,
    HullReading,
    RcReading,
    SonarReading,
)


class SensorSuite:
    """The present readings. compass: as measured; heading: the one to use."""

    def __init__(self, hardware: Hardware, external: ExternalSensors) -> None:
        self.external = external
        self.sweep = SonarScan()
        self.gauge = FuelGauge()
        self.fix: GnssFix | None = None
        self.is_fix_own = True  # from the boat's own receiver, not MAVLink
        self.compass: HeadingReading | None = None
        self.heading: HeadingReading | None = None
        self.battery: BatteryReading | None = None
        self.sonar: SonarReading | None = None  # the latest ping
        self.hull: HullReading | None = None
        self.rc: RcReading | None = None  # the latest RC frame
        self.pings: list[tuple[SonarReading, float | None]] = []  # of this tick, with beam widths in rad
        self._hardware = hardware
        self._sector: Sector = ALL_ROUND

    @property
    def consumed_mah(self) -> float:
        """Charge consumed since boot, or since the pack was changed."""
        return self.gauge.consumed_mah

    def point_sonar(self, sector: Sector) -> None:
        """Set the sector of the boat's own ranger."""
        if sector != self._sector and self._hardware.sonar is not None:
            self._sector = sector
            self._hardware.sonar.set_sector(sector.port_rad, sector.starboard_rad)

    def read(self, config: BoatConfig, now_s: float, command: MotorCommand = STOPPED) -> None:
        """Read all sensors. command: the present motor command."""
        hardware, external = self._hardware, self.external
        own_fix = hardware.gnss.read()
        self.fix = external.choose_fix(own_fix, config.external, now_s)
        self.is_fix_own = self.fix is own_fix
        self.compass = hardware.compass.read()
        self.heading = external.choose_heading(trimmed(self.compass, config.trim), config.external, now_s)
        if hardware.battery is not None:
            battery = hardware.battery.read()
            if battery is not None and battery is not self.battery:
                self.battery = battery
                self.gauge.update(battery, config.battery, command)
        if hardware.hull is not None:
            self.hull = hardware.hull.read()
        if hardware.rc is not None:
            self.rc = hardware.rc.read()
        if self.pings:
            self.pings.clear()
        if hardware.sonar is not None and (pings := hardware.sonar.read()):
            self.sonar = pings[-1]
            for ping in pings:
                self.sweep.add(ping)
                self.pings.append((ping, None))
        while external.pings:
            ping, beam_rad = external.pings.popleft()
            self.sweep.add(ping, beam_rad)
            self.pings.append((ping, beam_rad))


def trimmed(reading: HeadingReading | None, trim: Trim) -> HeadingReading | None:
    """The reading with heading trim and gyro bias applied."""
    if reading is None or (trim.heading_rad == 0.0 and trim.gyro_bias_rad_s == 0.0):
        return reading
    rate = reading.yaw_rate_rad_s
    return HeadingReading(
        reading.time_s,
        reading.heading_rad + trim.heading_rad,
        None if rate is None else rate - trim.gyro_bias_rad_s,
    )
