"""The grid's free cells against the true shores; the search against Dijkstra's and published lengths."""

import heapq
import itertools
import math
from typing import cast

import numpy as np
import pytest
import shapely
from data_files import GRIDS
from hypothesis import given
from hypothesis import strategies as st
from shapely import affinity

from companion.core.geo import LatLon, LocalFrame
from mission_tools.errors import NoRoute
from mission_tools.maps import Chart, Feature, build_chart
from mission_tools.planning.astar import SearchResult, astar, estimates
from mission_tools.planning.grid import EightNeighbours, Grid, occupancy
from mission_tools.planning.plan_settings import HEURISTICS, HeuristicName

pytestmark = pytest.mark.slow

SQRT2 = math.sqrt(2.0)


def drawn(rows: list[str], passable: str = ".") -> Grid:
    """From the top, with a blocked border."""
    inner = np.array([[mark in passable for mark in row] for row in reversed(rows)], dtype=np.bool_)
    return Grid(np.pad(inner, 1), -1.0, -1.0, 1.0)


def cell(grid: Grid, x: int, y: int) -> int:
    """x to the right, y down from the top left of the drawing."""
    return (grid.rows - 2 - y) * grid.columns + x + 1


def search(grid: Grid, start: int, goal: int, heuristic: HeuristicName = "octile") -> SearchResult:
    return astar(EightNeighbours(grid), estimates(heuristic, grid, goal), start, goal)


def basin(*obstacles: shapely.Polygon) -> Chart:
    features = [Feature(f"rock {n}", "obstacle", shape) for n, shape in enumerate(obstacles)]
    return build_chart("Basin", LocalFrame(LatLon(50.0, -1.2)), shapely.box(-20, -20, 20, 20), features)


def test_a_grid_needs_a_blocked_border_and_real_cells() -> None:
    with pytest.raises(ValueError, match="border cells must be blocked"):
        Grid(np.ones((3, 3), dtype=np.bool_), 0.0, 0.0, 1.0)
    with pytest.raises(ValueError, match="cell_m must be positive"):
        Grid(np.zeros((3, 3), dtype=np.bool_), 0.0, 0.0, 0.0)


@given(
    east=st.floats(-15, 15),
    north=st.floats(-15, 15),
    size=st.floats(0.01, 8.0),
    turn=st.floats(0, 90),
    cell_m=st.floats(0.4, 3.0),
    clearance_m=st.floats(0.0, 5.0),
)
def test_a_cell_is_free_exactly_if_its_middle_is_far_enough_from_every_true_shore(
    east: float, north: float, size: float, turn: float, cell_m: float, clearance_m: float
) -> None:
    rock = affinity.rotate(
        shapely.box(east - size, north - 0.2 * size, east + size, north + 0.2 * size), turn
    )
    chart = basin(rock)
    grid = occupancy(chart, chart.navigable.bounds, cell_m, clearance_m)
    needed_m = math.hypot(clearance_m, cell_m / math.sqrt(2.0))
    middles = [grid.centre(cell) for cell in range(grid.rows * grid.columns)]
    at = shapely.points([(middle.east_m, middle.north_m) for middle in middles])
    to_shore_m = np.where(shapely.contains(chart.navigable, at), shapely.distance(chart.shores, at), 0.0)
    sure = np.abs(to_shore_m - needed_m) > 1e-6
    assert ((to_shore_m > needed_m) == grid.free.reshape(-1))[sure].all()


@pytest.mark.parametrize("is_east", [True, False])
def test_bounds_smaller_than_the_water_have_a_blocked_border_and_shores_beyond_them_count(
    is_east: bool,
) -> None:
    strip = shapely.box(0.0, -21.0, 10.0, -6.0) if is_east else shapely.box(-21.0, 0.0, -6.0, 10.0)
    grid = occupancy(basin(strip), (-5.0, -5.0, 15.0, 15.0), 1.0, 3.0)
    middles = [grid.centre(n) for n in range(grid.rows * grid.columns) if grid.free.flat[n]]
    assert all(-5.0 < at.east_m < 15.0 and -5.0 < at.north_m < 15.0 for at in middles)
    points = shapely.points([(at.east_m, at.north_m) for at in middles])
    assert shapely.distance(basin(strip).shores, points).min() >= math.hypot(3.0, SQRT2 / 2.0)
    assert len(middles) > 200


def dijkstra_length(grid: Grid, start: int, goal: int) -> float | None:
    """Written from scratch on rows and columns, so that it shares nothing with the code under test."""
    done: set[tuple[int, int]] = set()
    target = divmod(goal, grid.columns)
    heap = [(0.0, divmod(start, grid.columns))]
    while heap:
        length, at = heapq.heappop(heap)
        if at == target:
            return length
        if at in done:
            continue
        done.add(at)
        row, column = at
        for dr in (-1, 0, 1):
            for dc in (-1, 0, 1):
                beside = grid.free[row + dr, column] and grid.free[row, column + dc]
                if (dr or dc) and beside and grid.free[row + dr, column + dc]:
                    heapq.heappush(heap, (length + math.hypot(dr, dc), (row + dr, column + dc)))
    return None


def test_the_goal_counts_when_it_is_popped_and_a_cell_is_expanded_once() -> None:
    class TwoWays:
        """0 → 3 at a cost of 10, or 0 → 1 → 2 → 3 at a cost of 3, and back again."""

        size = 4

        def moves(self, cell: int) -> list[tuple[int, int]]:
            return {0: [(3, 10), (1, 1)], 1: [(1, 1), (-1, 1)], 2: [(1, 1), (-1, 1)], 3: []}[cell]

    result = astar(cast(EightNeighbours, TwoWays()), [0, 0, 0, 0], 0, 3)
    assert (result.cells, result.cost, result.expanded) == ((0, 1, 2, 3), 3, 4)


grids = st.integers(2, 9).flatmap(
    lambda width: st.lists(st.text(alphabet="...#", min_size=width, max_size=width), min_size=2, max_size=9)
)


@given(rows=grids, data=st.data())
def test_every_path_is_valid_and_the_admissible_ones_are_shortest(
    rows: list[str], data: st.DataObject
) -> None:
    grid = drawn(rows)
    free = [n for n in range(grid.rows * grid.columns) if grid.free.flat[n]]
    if len(free) < 2:
        return
    start, goal = data.draw(st.sampled_from(free)), data.draw(st.sampled_from(free))
    shortest = dijkstra_length(grid, start, goal)
    for heuristic in HEURISTICS:
        if shortest is None:
            with pytest.raises(NoRoute, match="no route"):
                search(grid, start, goal, heuristic)
            continue
        result = search(grid, start, goal, heuristic)
        assert_valid(grid, result)
        if heuristic == "manhattan":
            assert result.length >= shortest - 1e-9
        else:
            assert result.length == pytest.approx(shortest, rel=1e-9)


def assert_valid(grid: Grid, result: SearchResult) -> None:
    length = 0.0
    assert len(set(result.cells)) == len(result.cells)
    for a, b in itertools.pairwise(result.cells):
        (row, column), (next_row, next_column) = divmod(a, grid.columns), divmod(b, grid.columns)
        assert max(abs(next_row - row), abs(next_column - column)) == 1
        assert grid.free[row, column]
        assert grid.free[next_row, next_column]
        assert grid.free[next_row, column], "cut a corner"
        assert grid.free[row, next_column], "cut a corner"
        length += math.hypot(next_row - row, next_column - column)
    assert result.length == pytest.approx(length, rel=1e-9)


def test_lengths_equal_the_published_optima() -> None:
    text = (GRIDS / "arena2.map").read_text(encoding="ascii")
    grid = drawn(text.split("map\n", 1)[1].split(), passable=".GS")
    expansion = EightNeighbours(grid)
    lines = (GRIDS / "arena2.map.scen").read_text(encoding="ascii").split("\n", 1)[1].strip().split("\n")
    for line in lines[:: max(1, len(lines) // 20)]:
        *_, x0, y0, x1, y1, optimum = line.split()
        start, goal = cell(grid, int(x0), int(y0)), cell(grid, int(x1), int(y1))
        result = astar(expansion, estimates("octile", grid, goal), start, goal)
        assert result.length == pytest.approx(float(optimum), rel=6e-6), line  # six digits are published
