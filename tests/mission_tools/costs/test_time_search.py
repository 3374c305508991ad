"""Routes in a current that changes, against small cases whose answer is known."""

import math

import numpy as np
import pytest
import shapely
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

from benchmarks.planning.tide import Water
from benchmarks.planning.time_expanded import Array
from companion.core.geo import LatLon, LocalFrame, Point
from mission_tools.costs.cheapest import _DIRECTIONS, cheapest_route
from mission_tools.costs.current import River
from mission_tools.costs.time_search import cheapest_cells
from mission_tools.costs.travel import BoatSpeed, Charge, TravelTime
from mission_tools.errors import NoRoute
from mission_tools.maps.chart import Chart, Feature, build_chart
from mission_tools.planning.grid import Grid

FRAME = LocalFrame(LatLon(50.0, 10.0))
BOAT = BoatSpeed(1.0, 1.2)


@pytest.fixture(autouse=True)
def coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mission_tools.costs.cheapest.LATTICE_CELLS", 2_500)


def grid_of(free: Array, cell_m: float = 10.0) -> Grid:
    return Grid(np.pad(free > 0.0, 1), -cell_m, -cell_m, cell_m)


def test_in_a_steady_current_it_is_dijkstras_search() -> None:
    rng = np.random.default_rng(11)
    grid = grid_of(np.ceil(rng.random((18, 24)) - 0.2))
    first, last = (int(cell) for cell in np.flatnonzero(grid.free)[[0, -1]])
    travel = TravelTime(BOAT, River((Point(90.0, 0.0), Point(120.0, 240.0)), 150.0, 0.8))
    size = grid.free.size
    costs = np.zeros((size, size))
    for tail in np.flatnonzero(grid.free):
        for up, right in _DIRECTIONS:
            row, column = divmod(int(tail), grid.columns)
            if not (0 <= row + up < grid.rows and 0 <= column + right < grid.columns):
                continue
            head = int(tail) + up * grid.columns + right
            if grid.free.ravel()[head]:
                a, b = grid.centre(int(tail)), grid.centre(head)
                at = np.array([0.5 * (a.north_m + b.north_m)]), np.array([0.5 * (a.east_m + b.east_m)])
                per_m = travel.per_m(*at, np.array([math.atan2(right, up)]), np.zeros(1))[0]
                costs[tail, head] = per_m * math.dist(a, b) if math.isfinite(per_m) else 0.0
    expected = dijkstra(csr_matrix(costs), indices=first)[last]
    found = cheapest_cells(grid, travel, _DIRECTIONS, first, last, 100.0)
    assert found is not None
    assert found[1] == pytest.approx(100.0 + expected)
    assert (found[0][0], found[0][-1]) == (first, last)


def test_cells_that_nothing_joins_have_no_path() -> None:
    free = np.ones((5, 12))
    free[:, 4:8] = 0.0
    grid = grid_of(free)
    first, last = (int(cell) for cell in np.flatnonzero(grid.free)[[0, -1]])
    assert cheapest_cells(grid, TravelTime(BOAT), _DIRECTIONS, first, last, 0.0) is None


def gate(opens_s: float, closes_s: float = math.inf) -> Water:
    """A stream to the west, too strong for the boat but between two times, near one meridian."""

    def flow(north_m: Array, east_m: Array, time_s: Array) -> tuple[Array, Array]:
        is_closed = (np.abs(east_m - 200.0) < 30.0) & ((time_s < opens_s) | (time_s > closes_s))
        return np.zeros_like(north_m), np.where(is_closed, -3.0, 0.0)

    return Water(flow)


def channel(*islands: shapely.Polygon) -> tuple[Point, Point, Chart]:
    features = [Feature(f"island {n}", "island", shape) for n, shape in enumerate(islands, 1)]
    chart = build_chart("channel", FRAME, shapely.box(0.0, 0.0, 400.0, 80.0), features)
    return Point(40.0, 10.0), Point(40.0, 390.0), chart


def test_it_leaves_so_late_that_the_gate_is_open() -> None:
    start, goal, chart = channel()
    found = cheapest_route(chart, (start, goal), 4.0, TravelTime(BOAT, gate(1000.0)), 100.0)
    assert found.shortest_cost == math.inf
    assert 100.0 + found.wait_s + 160.0 == pytest.approx(1000.0, abs=5.0)  # at the gate's near side
    assert found.arrive_s == pytest.approx(1000.0 + 220.0, abs=5.0)
    assert found.cost == pytest.approx(found.arrive_s - 100.0)
    assert found.points == (start, goal)


def test_a_gate_that_never_opens_is_refused_with_the_place() -> None:
    start, goal, chart = channel()
    with pytest.raises(
        NoRoute, match=r"every way, also after 18 h of waiting: first at 50\.\d+,10\.\d+, 1[67]\d m"
    ):
        cheapest_route(chart, (start, goal), 4.0, TravelTime(BOAT, gate(1e9)), 0.0)


def test_a_gate_is_reached_before_it_closes_or_not_at_all() -> None:
    start, goal, chart = channel()
    travel = TravelTime(BOAT, gate(0.0, 300.0))
    assert cheapest_route(chart, (start, goal), 4.0, travel, 50.0).wait_s == 0.0
    with pytest.raises(NoRoute):
        cheapest_route(chart, (start, goal), 4.0, travel, 150.0)


def test_it_goes_round_a_stream_that_will_be_there_when_it_comes() -> None:
    def flow(north_m: Array, east_m: Array, time_s: Array) -> tuple[Array, Array]:
        is_there = (north_m > 30.0) & (time_s > 60.0) & (np.abs(east_m - 200.0) < 100.0)
        return np.zeros_like(north_m), np.where(is_there, -0.9, 0.0)

    start, goal, chart = channel()
    travel = TravelTime(BOAT, Water(flow))
    found = cheapest_route(chart, (start, goal), 4.0, travel)
    assert found.shortest_cost > 800.0
    assert found.cost < 390.0
    assert min(point.north_m for point in found.points) < 32.0
    charge = cheapest_route(chart, (start, goal), 4.0, Charge(BOAT, lambda v: 0.2 + v**3, Water(flow)))
    assert charge.cost < 0.5 * charge.shortest_cost
