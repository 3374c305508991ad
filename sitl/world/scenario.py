"""What a `World` and its boat are made from, everything looked up."""

from dataclasses import dataclass
from pathlib import Path

from companion.config.boat_config import BoatConfig
from companion.core.geo import LocalFrame, Point
from mission_tools.maps.chart import Chart
from mission_tools.maps.source import RouteDefaults
from sitl.radio.channel import LinkSettings
from sitl.world.drive.settings import ThrusterSettings
from sitl.world.environment.settings import Environment
from sitl.world.faults.catalogue import FaultSetting
from sitl.world.hull_settings import HullSettings
from sitl.world.movers import MoverSettings
from sitl.world.pack import BatterySettings
from sitl.world.sensors.settings import Sensors


@dataclass(frozen=True, slots=True)
class Scenario:
    """A scenario with everything looked up, ready for `World`.

    start and the route's points are in the chart's frame; heading_rad is clockwise from north; vehicle is
    what the boat's own program is configured with. boat_file: the boat's TOML as it is.
    """

    title: str
    seed: int
    chart: Chart
    route: RouteDefaults
    start: Point
    heading_rad: float
    hull: HullSettings
    thrusters: ThrusterSettings
    battery: BatterySettings
    sensors: Sensors
    environment: Environment
    vehicle: BoatConfig
    link: LinkSettings
    movers: tuple[MoverSettings, ...]
    faults: tuple[FaultSetting, ...]
    boat_file: Path

    @property
    def frame(self) -> LocalFrame:
        """The local frame of every position here."""
        return self.chart.frame
