"""The bottom of the water: it slopes down from every shore to an even depth."""

from companion.core.geo import Point
from mission_tools.maps.chart import Chart
from sitl.world.environment.settings import Environment


class Bathymetry:
    """Depth of a chart's water."""

    def __init__(self, chart: Chart, environment: Environment) -> None:
        self._chart = chart
        self._deepest_m = environment.depth_m
        self._slope = environment.shore_slope

    def depth_m(self, north_m: float, east_m: float) -> float:
        """Depth at a place, 0 ashore."""
        if self._chart.is_open:
            return self._deepest_m
        return min(self._deepest_m, self._slope * self._chart.clearance_m(Point(north_m, east_m)))
