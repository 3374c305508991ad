"""The emulated depth sounder: the bottom under it, its errors and its faults."""

import statistics

import pytest

from companion.core.geo import Point
from companion.core.readings import DepthReading
from sitl.scenarios.scenario import load_scenario
from sitl.world.environment.settings import Environment
from sitl.world.sampling import generator
from sitl.world.sensors.depth import Bathymetry, SimDepthSounder
from sitl.world.sensors.fault import SensorFault
from sitl.world.sensors.settings import DepthSettings

EXACT = DepthSettings(noise_m=0.0, sound_gain=1.0, lost_share=0.0)
LAKE = load_scenario("lake")


class Slope:
    """Water that is as deep as it lies north."""

    @staticmethod
    def depth_m(north_m: float, east_m: float) -> float:
        return north_m


def sounder(settings: DepthSettings = EXACT, seed: int = 3) -> SimDepthSounder:
    return SimDepthSounder(settings, Slope(), seed)  # type: ignore[arg-type]


def soundings(part: SimDepthSounder, depth_m: float, count: int) -> list[DepthReading]:
    out = []
    for number in range(count):
        part.sample(0.2 * number, depth_m, 0.0)
        reading = part.read()
        assert reading is not None
        out.append(reading)
    return out


def test_the_bottom_slopes_from_the_shore_to_its_depth() -> None:
    bottom = Bathymetry(LAKE.chart, Environment(depth_m=3.0, shore_slope=0.25))
    here = LAKE.start
    clearance_m = LAKE.chart.clearance_m(Point(here.north_m, here.east_m))
    assert bottom.depth_m(here.north_m, here.east_m) == pytest.approx(min(3.0, 0.25 * clearance_m))
    assert bottom.depth_m(here.north_m + 1e5, here.east_m) == 0.0
    depths = {round(bottom.depth_m(here.north_m + off, here.east_m), 2) for off in range(-40, 40, 2)}
    assert max(depths) <= 3.0
    assert len(depths) >= 5
    sea = load_scenario("open")
    assert Bathymetry(sea.chart, Environment(depth_m=7.0)).depth_m(0.0, 0.0) == 7.0


def test_the_depth_is_below_the_transducer() -> None:
    (reading,) = soundings(sounder(), 4.0, 1)
    assert reading.depth_m == pytest.approx(3.9)
    assert reading.water_m == pytest.approx(4.0)
    assert reading.temperature_c == 15.0


def test_nearer_than_its_least_range_and_farther_than_its_greatest_there_is_no_bottom() -> None:
    assert soundings(sounder(), 0.39, 1)[0].depth_m is None
    assert soundings(sounder(), 0.41, 1)[0].depth_m is not None
    assert soundings(sounder(), 50.0, 1)[0].depth_m is not None
    assert soundings(sounder(), 50.2, 1)[0].depth_m is None


def test_its_errors_are_those_of_its_settings() -> None:
    settings = DepthSettings(noise_m=0.05, sound_gain=1.02, lost_share=0.1, double_share=0.2)
    all_m = [reading.depth_m for reading in soundings(sounder(settings), 5.1, 2000)]
    assert all_m.count(None) == pytest.approx(200, abs=40)
    single = [depth_m for depth_m in all_m if depth_m is not None and depth_m < 7.0]
    double = [depth_m for depth_m in all_m if depth_m is not None and depth_m >= 7.0]
    assert statistics.mean(single) == pytest.approx(5.1, abs=0.01)
    assert statistics.stdev(single) == pytest.approx(0.05, rel=0.1)
    assert len(double) == pytest.approx(0.2 * 1800, abs=50)
    assert statistics.mean(double) == pytest.approx(10.3, abs=0.02)


@pytest.mark.parametrize(
    ("kind", "size", "expected"),
    [("deaf", 0.0, None), ("wrong", -1.0, 2.9), ("wrong", -9.0, 0.01), ("stuck", 0.0, 3.9)],
)
def test_a_fault_changes_what_it_says(kind: str, size: float, expected: float | None) -> None:
    part = sounder()
    soundings(part, 4.0, 1)
    part.fault = SensorFault(kind, size, 0.0, 0.0, generator(1, "x"))
    part.sample(0.2, 4.0 if kind != "stuck" else 2.0, 0.0)
    reading = part.read()
    assert reading is not None
    assert reading.depth_m == (None if expected is None else pytest.approx(expected))
