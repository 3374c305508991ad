"""The boat at one instant, as telemetry reports it."""

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
    """One tick's knowledge. unix_s is 0 while the date is not known; load is the share of the tick used."""

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
    battery_percent: int  # charge left, −1 without a monitor
    load: float
    speed_pid: PidOutput | None = None
    heading: HeadingReading | None = None  # as the part gave it
    sweep: SonarScan | None = None  # what the rangers have seen around
    perception: ObstaclePerception | None = None  # what lies and moves around
    avoidance: Avoidance | None = None  # what is being done about it
    free_memory_bytes: int = 0  # of the boat's computer, 0 while not known

    @property
    def boot_ms(self) -> int:
        """Milliseconds since boot, as most messages stamp themselves."""
        return round(self.now_s * 1e3) & 0xFFFFFFFF

    @property
    def boot_us(self) -> int:
        """Microseconds since boot."""
        return round(self.now_s * 1e6)
