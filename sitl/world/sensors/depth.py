"""The depth sounder."""

import msgspec

from companion.core.geo import Point
from companion.core.readings import DepthReading
from mission_tools.maps.chart import Chart
from sitl.world.environment.settings import Environment
from sitl.world.sampling import generator, normal
from sitl.world.sensors.fault import SensorFault
from sitl.world.sensors.sensor import Sensor
from sitl.world.sensors.settings import DepthSettings


class Bathymetry:
    """Depth of a chart's water. Its bottom slopes down from every shore to an even depth."""

    def __init__(self, chart: Chart, environment: Environment) -> None:
        self._chart = chart
        self._deepest_m = environment.depth_m
        self._slope = environment.shore_slope

    def depth_m(self, north_m: float, east_m: float) -> float:
        """Depth at a place, 0 ashore."""
        if self._chart.is_open:
            return self._deepest_m
        return min(self._deepest_m, self._slope * self._chart.clearance_m(Point(north_m, east_m)))


class SimDepthSounder(Sensor[DepthReading]):
    """It looks straight down from its transducer. Nearer than its least range it finds no bottom."""

    def __init__(self, settings: DepthSettings, bottom: Bathymetry, seed: int) -> None:
        super().__init__()
        self._settings = settings
        self._bottom = bottom
        self._random = generator(seed, "depth")

    def sample(self, now_s: float, north_m: float, east_m: float) -> None:
        """Sample when due."""
        settings = self._settings
        if not self._is_due(now_s, settings.rate_hz):
            return
        true_m = self._bottom.depth_m(north_m, east_m) - settings.transducer_m
        # A fixed number of draws a sounding
        echo_m = settings.sound_gain * true_m + settings.noise_m * normal(self._random)
        is_lost = self._random.random() < settings.lost_share
        if self._random.random() < settings.double_share:
            echo_m = 2.0 * echo_m + settings.transducer_m
        is_found = not is_lost and true_m >= settings.min_range_m and echo_m <= settings.max_range_m
        self._output(
            DepthReading(
                now_s + self.clock_offset_s,
                echo_m if is_found else None,
                settings.temperature_c,
                settings.transducer_m,
                settings.min_range_m,
                settings.max_range_m,
            ),
            now_s,
        )

    def _with_fault(
        self, reading: DepthReading, fault: SensorFault[DepthReading], now_s: float
    ) -> DepthReading | None:
        replace = msgspec.structs.replace
        match fault.kind:
            case "deaf":
                return replace(reading, depth_m=None)
            case "garbage":
                low_m, high_m = self._settings.min_range_m, self._settings.max_range_m
                return replace(reading, depth_m=fault.random.uniform(low_m, high_m))
            case "corrupt":
                return fault.corrupt(reading, depth_m=2.0 * self._settings.max_range_m)
            case "wrong":
                if reading.depth_m is None:
                    return reading
                return replace(reading, depth_m=max(reading.depth_m + fault.size, 0.01))
            case _:
                return super()._with_fault(reading, fault, now_s)
