"""The depth sounder."""

import math
from typing import Final

import msgspec
import numpy as np

from companion.core.geo import from_body_axes
from companion.core.readings import DepthReading
from sitl.world.environment.bottom import Bathymetry
from sitl.world.environment.waves import Waves
from sitl.world.sampling import TIME_SLACK_S, generator, normal
from sitl.world.sensors.fault import SensorFault
from sitl.world.sensors.sensor import Sensor
from sitl.world.sensors.settings import DepthSettings

# Where the beam is looked at, in half widths: its middle, a ring inside it, and its edge
_RINGS: Final = np.array(
    [(0.0, 0.0), *[(0.5, turn / 6) for turn in range(6)], *[(1.0, turn / 12) for turn in range(12)]]
)
_BEAM: Final = _RINGS[:, 0] * np.array([np.cos(math.tau * _RINGS[:, 1]), np.sin(math.tau * _RINGS[:, 1])])


class SimDepthSounder(Sensor[DepthReading]):
    """It hears the first return in its beam, which leans with the hull, and its reading arrives late."""

    def __init__(
        self, settings: DepthSettings, bottom: Bathymetry, seed: int, least_quality: float = 0.5
    ) -> None:
        """least_quality: below it, the boat's driver takes the bottom as not found."""
        super().__init__()
        self._settings = settings
        self._bottom = bottom
        self._least_quality = least_quality
        self._random = generator(seed, "depth")
        self._echo: DepthReading | None = None  # under way to the computer

    def sample(self, now_s: float, north_m: float, east_m: float, heading_rad: float, waves: Waves) -> None:
        """Ping, or hand over the echo, when due. The position is the boat's."""
        settings = self._settings
        if self._echo is None and self._is_due(now_s, settings.rate_hz):
            arm = from_body_axes(settings.forward_m, settings.starboard_m, heading_rad)
            self._echo = self._ping(north_m + arm.north_m, east_m + arm.east_m, heading_rad, waves)
            self.due_s = now_s + settings.latency_s - TIME_SLACK_S
        if self._echo is not None and now_s >= self.due_s:
            arrived = msgspec.structs.replace(self._echo, time_s=now_s + self.clock_offset_s)
            self._echo, self.due_s = None, self._count / settings.rate_hz - TIME_SLACK_S
            self._output(arrived, now_s)

    def _ping(self, north_m: float, east_m: float, heading_rad: float, waves: Waves) -> DepthReading:
        """A sounding. Its time is set when it arrives. Each takes the same number of draws."""
        settings, numbers = self._settings, self._random
        noise, doubt, weed = normal(numbers), abs(normal(numbers)), numbers.random()
        lost, double = numbers.random(), numbers.random()
        true_m, quality = self._first_return_m(north_m, east_m, heading_rad, waves), 1.0 - 0.03 * doubt
        canopy_m = self._bottom.canopy_m(north_m, east_m)
        if canopy_m > 0.0 and weed < settings.weed_echo_share:  # from the top of the plants or among them
            true_m, quality = true_m - canopy_m * (1.0 - 0.5 * weed), 0.7 - 0.15 * doubt
        deviation_m = math.hypot(settings.noise_m, settings.noise_share * true_m)
        echo_m = settings.sound_gain * true_m + deviation_m * noise
        if double < settings.double_share:
            echo_m = 2.0 * echo_m + settings.transducer_m
        quality = max(quality, 0.0)
        is_heard = lost >= settings.lost_share + settings.bubble_share_per_m * waves.height_m
        is_heard &= true_m >= settings.min_range_m and echo_m <= settings.max_range_m
        return DepthReading(
            0.0,
            echo_m if is_heard and quality >= self._least_quality else None,
            settings.temperature_c,
            settings.transducer_m,
            settings.min_range_m,
            settings.max_range_m,
            quality if is_heard else 0.0,
        )

    def _first_return_m(self, north_m: float, east_m: float, heading_rad: float, waves: Waves) -> float:
        """The shortest range in the beam, which leans to port when the hull rolls to starboard."""
        bottom, above_m = self._bottom, waves.heave_m - self._settings.transducer_m
        below_m = bottom.depth_m(north_m, east_m) + above_m
        half = math.tan(0.5 * math.radians(self._settings.beam_deg))
        lean = from_body_axes(math.tan(waves.pitch_rad), -math.tan(waves.roll_rad), heading_rad)
        if below_m <= 0.0:
            return below_m
        off_n, off_e = below_m * (np.array(lean)[:, None] + half * _BEAM)
        down_m = (bottom.depths_m(north_m + off_n, east_m + off_e) + above_m).clip(0.0)
        nearest_m = float(np.sqrt(off_n**2 + off_e**2 + down_m**2).min())
        return min(nearest_m, below_m) if math.hypot(*lean) <= half else nearest_m

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
