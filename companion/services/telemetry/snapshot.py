"""The state of the boat at one tick, for telemetry and logs."""

from msgspec import Struct

from companion.config.boat_config import BoatConfig
from companion.core.geo import LocalFrame
from companion.core.state import Demand, MotorCommand, NavState, PidOutput
from companion.guidance.pipeline import GuidancePipeline
from companion.obstacles.perception.perception import ObstaclePerception
from companion.obstacles.perception.sonar_scan import SonarScan
from companion.obstacles.planning.avoidance import Avoidance
from companion.sensors.readings import BatteryReading, GnssFix, HeadingReading, SonarReading
from companion.sensors.suite import SensorSuite
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


def take_snapshot(
    now_s: float,
    unix_s: float,
    config: BoatConfig,
    vehicle: Vehicle,
    sensors: SensorSuite,
    guidance: GuidancePipeline,
    command: MotorCommand,
    *,
    load: float,
    free_memory_bytes: int,
) -> Snapshot:
    """Gather one tick's state from the parts of the boat."""
    return Snapshot(
        now_s=now_s,
        unix_s=unix_s,
        config=config,
        vehicle=vehicle,
        nav=vehicle.nav,
        frame=vehicle.frame,
        fix=sensors.fix,
        battery=sensors.battery,
        sonar=sensors.sonar,
        demand=guidance.demand,
        heading_pid=guidance.helm.heading_pid,
        command=command,
        consumed_mah=sensors.consumed_mah,
        battery_percent=sensors.gauge.percent,
        load=load,
        speed_pid=guidance.helm.speed_pid,
        heading=sensors.compass,
        sweep=sensors.sweep,
        perception=guidance.perception,
        avoidance=guidance.avoidance,
        free_memory_bytes=free_memory_bytes,
    )
