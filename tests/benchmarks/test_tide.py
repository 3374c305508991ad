"""The oracle of voyages in currents that change, against cases worked out by hand, and one of its voyages."""

import math

import numpy as np
import pytest
import shapely

from benchmarks.planning.tide import cases, drawn, swinging
from benchmarks.planning.time_expanded import Array, Sailor, earliest, sailed_s

NO_LAND = shapely.Polygon()
BOAT = Sailor(1.0, 1.5)


def still(north: Array, east: Array, time_s: Array) -> tuple[Array, Array]:
    return 0.0 * (north + time_s), 0.0 * (east + time_s)


@pytest.mark.parametrize("goal", [(0.0, 300.0), (300.0, 0.0), (-200.0, 260.0)])
def test_in_still_water_it_is_the_straight_line(goal: tuple[float, float]) -> None:
    away = math.hypot(*goal)
    found = earliest(
        NO_LAND, (-300, -100, 400, 400), (0.0, 0.0), goal, BOAT, still, cell=away / 30, layer_s=5.0
    )
    assert found == pytest.approx(away, rel=0.003)


def test_with_a_tide_on_the_beam_it_is_the_wind_triangle() -> None:
    def across(north: Array, east: Array, time_s: Array) -> tuple[Array, Array]:
        return 0.0 * (north + time_s), 0.0 * east + 1.2

    found = earliest(
        NO_LAND, (-50, -100, 350, 100), (0.0, 0.0), (300.0, 0.0), BOAT, across, cell=10.0, layer_s=5.0
    )
    assert found == pytest.approx(300.0 / math.sqrt(1.5**2 - 1.2**2), rel=1e-6)  # 0.9 m/s, less than asked


def test_it_waits_until_a_stream_can_be_stemmed() -> None:
    def gate(north: Array, east: Array, time_s: Array) -> tuple[Array, Array]:
        closed = (np.abs(east - 150.0) < 20.0) & (time_s < 500.0)
        return 0.0 * north, np.where(closed, -3.0, 0.0)

    bounds = (-30, -20, 30, 320)
    start, goal = (0.0, 0.0), (0.0, 300.0)
    found = earliest(NO_LAND, bounds, start, goal, BOAT, gate, cell=10.0, layer_s=5.0, reach=2)
    assert found == pytest.approx(500.0 + 170.0, abs=12.0)


def test_a_route_is_timed_by_the_tide_on_the_way() -> None:
    boat, flow = Sailor(1.2, 1.2, steerage=1.2), swinging(0.5, 90.0, 3600.0)
    found = sailed_s([(0.0, 0.0), (0.0, 600.0)], boat, flow, 300.0)
    rate = 2.0 * math.pi / 3600.0
    drift_m = 0.5 / rate * (math.sin(rate * found) - math.sin(rate * 300.0))
    assert 1.2 * (found - 300.0) + drift_m == pytest.approx(600.0, abs=0.5)
    assert sailed_s([(0.0, 0.0), (0.0, -600.0)], Sailor(0.3, 0.4), flow, 0.0) == math.inf


def test_the_planner_is_within_half_a_percent_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mission_tools.costs.cheapest.LATTICE_CELLS", 10_000)
    case = cases()["jet"]
    found = case.ours()
    assert found.arrive_s < 0.97 * found.shortest_cost
    assert found.arrive_s == pytest.approx(
        case.oracle_s(found.arrive_s, 40), rel=0.008
    )  # of 40 cells, not 140


def test_a_case_is_drawn_by_its_seed() -> None:
    first, again, other = drawn(9700), drawn(9700), drawn(9701)
    at = np.array([100.0]), np.array([900.0]), np.array([2000.0])
    assert first.flow(*at) == again.flow(*at) != other.flow(*at)
    assert first.chart.shores.equals(again.chart.shores)
