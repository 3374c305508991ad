"""The state of the boat at one tick, for telemetry and logs."""

from msgspec import Struct

from companion.config.boat_config import BoatConfig
from companion.core.geo import LocalFrame
from companion.core.state import Demand, MotorCommand, NavState, PidOutput
from companion.obstacles.perception.perception import ObstaclePerception
from companion.obstacles.perception.sonar_scan import SonarScan
from companion.obstacles.planning.avoidance import Avoidance
from companion.sensors.readings import BatteryReading, GnssFix, HeadingReading, SonarReading
from companion.vehicle.vehicle import Vehicle


class Snapshot(Struct, frozen=True):
    """unix_s is 0 if the date is unknown; load is the share of the tick used."""

    now_s: float
    unix_s: float
    config: BoatConfig
    vehicle: Vehicle
    nav: NavState | None
    frame: LocalFrame | None
    fix: GnssFix | None
    battery: BatteryReading | None
    sonar: SonarReading | None
    demand: Demand | None
    heading_pid: PidOutput | None
    command: MotorCommand
    consumed_mah: float
    battery_percent: int  # remaining charge, −1 without a monitor
    load: float
    speed_pid: PidOutput | None = None
    heading: HeadingReading | None = None  # as measured
    sweep: SonarScan | None = None  # latest ranges
    perception: ObstaclePerception | None = None  # obstacles
    avoidance: Avoidance | None = None  # present avoidance
    free_memory_bytes: int = 0  # of the computer, 0 if unknown

    @property
    def boot_ms(self) -> int:
        """Milliseconds since boot, modulo 2³²."""
        return round(self.now_s * 1e3) & 0xFFFFFFFF

    @property
    def boot_us(self) -> int:
        """Microseconds since boot."""
        return round(self.now_s * 1e6)
