"""The emulated depth sounder: what it hears of the bottom, its errors and its faults."""

import math
import statistics

import msgspec
import numpy as np
import pytest
from numpy.typing import NDArray

from companion.core.readings import DepthReading
from sitl.world.environment.settings import Environment
from sitl.world.environment.waves import Waves
from sitl.world.sampling import generator
from sitl.world.sensors.depth import SimDepthSounder
from sitl.world.sensors.fault import SensorFault
from sitl.world.sensors.settings import DepthSettings

EXACT = DepthSettings(
    noise_m=0.0,
    noise_share=0.0,
    sound_gain=1.0,
    lost_share=0.0,
    double_share=0.0,
    latency_s=0.0,
    beam_deg=1.0,
)


class Plane:
    """Water that is 10 m deep at the origin, and deeper to north and east by these slopes."""

    def __init__(self, north: float = 0.0, east: float = 0.0, canopy_m: float = 0.0) -> None:
        self.north, self.east, self.weed_m = north, east, canopy_m

    def depth_m(self, north_m: float, east_m: float) -> float:
        return 10.0 + self.north * north_m + self.east * east_m

    def depths_m(self, north_m: NDArray[np.float64], east_m: NDArray[np.float64]) -> NDArray[np.float64]:
        return 10.0 + self.north * north_m + self.east * east_m

    def canopy_m(self, north_m: float, east_m: float) -> float:
        return self.weed_m


LEVEL = Plane(1.0)  # as deep as it lies north of −10 m


def sounder(settings: DepthSettings = EXACT, bottom: Plane = LEVEL, seed: int = 3) -> SimDepthSounder:
    return SimDepthSounder(settings, bottom, seed)  # type: ignore[arg-type]


def sea(height_m: float = 0.0, roll_deg: float = 0.0, pitch_deg: float = 0.0, heave_m: float = 0.0) -> Waves:
    waves = Waves(Environment(wave_height_m=height_m, wave_period_s=2.5), 1.0, 1)
    waves.roll_rad, waves.pitch_rad, waves.heave_m = math.radians(roll_deg), math.radians(pitch_deg), heave_m
    return waves


def soundings(
    part: SimDepthSounder, depth_m: float, count: int, waves: Waves | None = None
) -> list[DepthReading]:
    """At a place of LEVEL that is so deep."""
    out = []
    for number in range(count):
        part.sample(0.2 * number, depth_m - 10.0, 0.0, 0.0, waves or sea())
        reading = part.read()
        assert reading is not None
        out.append(reading)
    return out


def test_the_depth_is_below_the_transducer() -> None:
    (reading,) = soundings(sounder(bottom=Plane()), 10.0, 1)
    assert reading.depth_m == pytest.approx(9.9)
    assert reading.water_m == pytest.approx(10.0)
    assert reading.temperature_c == 15.0
    assert reading.quality is not None
    assert 0.8 < reading.quality <= 1.0


def test_nearer_than_its_least_range_and_farther_than_its_greatest_there_is_no_bottom() -> None:
    flat = msgspec.structs.replace(EXACT, beam_deg=0.0)
    for depth_m, is_found in ((0.39, False), (0.41, True), (50.0, True), (50.2, False)):
        (reading,) = soundings(sounder(flat), depth_m, 1)
        assert (reading.depth_m is not None) is is_found
        assert (reading.quality == 0.0) is not is_found


def first_return_m(bottom: Plane, waves: Waves, beam_deg: float = 30.0, heading_deg: float = 0.0) -> float:
    settings = msgspec.structs.replace(EXACT, beam_deg=beam_deg, transducer_m=0.0)
    part = sounder(settings, bottom)
    part.sample(0.0, 0.0, 0.0, math.radians(heading_deg), waves)
    reading = part.read()
    assert reading is not None
    assert reading.depth_m is not None
    return reading.depth_m


def test_on_a_slope_the_first_return_is_square_to_it_or_at_the_edge_of_the_beam() -> None:
    assert first_return_m(Plane(0.2), sea()) == pytest.approx(10.0 * math.cos(math.atan(0.2)), rel=2e-3)
    at_edge = 10.0 / (math.cos(math.radians(15.0)) + 0.5 * math.sin(math.radians(15.0)))
    assert first_return_m(Plane(0.0, 0.5), sea()) == pytest.approx(at_edge, rel=0.01)
    assert first_return_m(Plane(0.2), sea(), beam_deg=0.0) == pytest.approx(10.0)


@pytest.mark.parametrize(
    ("waves", "heading_deg", "slope"),
    [  # a narrow beam on a level bottom is 10 / cos(20°) long; it points to where the bottom falls away
        (sea(roll_deg=20.0), 0.0, Plane(0.0, -0.1)),  # starboard down: the beam goes to port, west
        (sea(roll_deg=20.0), 90.0, Plane(0.1, 0.0)),  # heading east, port is north
        (sea(pitch_deg=20.0), 0.0, Plane(0.1, 0.0)),  # bow up: it goes ahead
    ],
)
def test_the_beam_leans_with_the_hull(waves: Waves, heading_deg: float, slope: Plane) -> None:
    level_m = first_return_m(Plane(), waves, 2.0)
    assert level_m == pytest.approx(10.0 / math.cos(math.radians(19.0)), rel=5e-3)  # at the beam's near edge
    assert first_return_m(slope, waves, 2.0, heading_deg) > level_m + 0.2
    assert first_return_m(Plane(), waves, 50.0) == pytest.approx(10.0)  # straight down is in a wide beam
    assert first_return_m(Plane(), sea(heave_m=0.25)) == pytest.approx(10.25)


def test_a_sounding_arrives_late_with_the_depth_of_where_the_transducer_pinged() -> None:
    part = sounder(msgspec.structs.replace(EXACT, latency_s=0.1, forward_m=-2.0, starboard_m=0.5))
    for number in range(12):
        part.sample(0.02 * number, -5.0 + 0.1 * number, 0.0, math.radians(90.0), sea())
        reading = part.read()
        assert (reading is not None) is (number >= 5)
    assert reading is not None
    assert reading.time_s == pytest.approx(0.1)
    assert reading.depth_m == pytest.approx(5.0 - 0.5 - 0.1, abs=0.05)  # heading east, starboard is south
    with pytest.raises(ValueError, match=r"latency_s = 0\.2: expected less than 1 / rate_hz"):
        DepthSettings(latency_s=0.2)


def test_its_errors_are_those_of_its_settings() -> None:
    settings = msgspec.structs.replace(
        EXACT,
        noise_m=0.03,
        noise_share=0.008,
        sound_gain=1.02,
        lost_share=0.1,
        double_share=0.2,
        beam_deg=0.0,
    )
    all_m = [reading.depth_m for reading in soundings(sounder(settings), 5.1, 2000)]
    assert all_m.count(None) == pytest.approx(200, abs=40)
    single = [depth_m for depth_m in all_m if depth_m is not None and depth_m < 7.0]
    double = [depth_m for depth_m in all_m if depth_m is not None and depth_m >= 7.0]
    assert statistics.mean(single) == pytest.approx(5.1, abs=0.01)
    assert statistics.stdev(single) == pytest.approx(math.hypot(0.03, 0.04), rel=0.1)
    assert len(double) == pytest.approx(0.2 * 1800, abs=50)
    assert statistics.mean(double) == pytest.approx(10.3, abs=0.02)


def test_bubbles_under_the_hull_hide_the_bottom_in_waves() -> None:
    settings = msgspec.structs.replace(EXACT, lost_share=0.02, bubble_share_per_m=0.5)
    lost = [
        sum(one.depth_m is None for one in soundings(sounder(settings), 5.0, 2000, sea(m))) for m in (0, 0.4)
    ]
    assert lost == [pytest.approx(40, abs=25), pytest.approx(440, abs=60)]


def test_over_weed_the_echo_is_from_the_plants_and_its_quality_low() -> None:
    settings = msgspec.structs.replace(EXACT, weed_echo_share=0.7, beam_deg=0.0)
    all_of = soundings(sounder(settings, Plane(canopy_m=2.0)), 10.0, 2000)
    bottom = [one for one in all_of if one.depth_m is not None and one.depth_m > 9.85]
    plants = [one.depth_m for one in all_of if one.depth_m is not None and one.depth_m <= 9.85]
    unsure = [one for one in all_of if one.depth_m is None]
    assert len(bottom) == pytest.approx(600, abs=60)
    assert all(7.9 <= depth_m <= 8.6 for depth_m in plants)
    assert max(one.quality or 0.0 for one in all_of if one not in bottom) <= 0.7
    assert len(unsure) == pytest.approx(0.18 * 1400, abs=60)  # beyond 1⅓ deviations
    assert all(0.0 <= (one.quality or 0.0) < 0.5 for one in unsure)


@pytest.mark.parametrize(
    ("kind", "size", "expected"),
    [("deaf", 0.0, None), ("wrong", -1.0, 8.9), ("wrong", -19.0, 0.01), ("stuck", 0.0, 9.9)],
)
def test_a_fault_changes_what_it_says(kind: str, size: float, expected: float | None) -> None:
    part = sounder(bottom=Plane())
    soundings(part, 10.0, 1)
    part.fault = SensorFault(kind, size, 0.0, 0.0, generator(1, "x"))
    part.sample(0.2, 0.0, 0.0, 0.0, sea(heave_m=1.0 if kind == "stuck" else 0.0))
    reading = part.read()
    assert reading is not None
    assert reading.depth_m == (None if expected is None else pytest.approx(expected))
