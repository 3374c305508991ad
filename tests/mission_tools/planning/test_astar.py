"""The search against hand-counted paths, Dijkstra's, and published optimal lengths."""

import heapq
import itertools
import math

import pytest
from data_files import GRIDS
from hypothesis import given
from hypothesis import strategies as st

from mission_tools.errors import NoRoute, SearchBudgetExceeded
from mission_tools.planning.astar import (
    HEURISTICS,
    HeuristicName,
    SearchMetrics,
    SearchResult,
    astar,
    estimates,
)
from mission_tools.planning.grid import EightNeighbours, Grid, grid_from_rows

pytestmark = pytest.mark.slow

SQRT2 = math.sqrt(2.0)


def cell(grid: Grid, x: int, y: int) -> int:
    """x to the right, y down from the top left of the drawing."""
    return (grid.rows - 2 - y) * grid.columns + x + 1


def search(
    grid: Grid, start: int, goal: int, heuristic: HeuristicName = "octile", budget: int | None = None
) -> SearchResult:
    return astar(EightNeighbours(grid), estimates(heuristic, grid, goal), start, goal, budget)


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


@pytest.mark.parametrize(
    ("rows", "start", "goal", "length"),
    [
        (["....."], (0, 0), (4, 0), 4.0),
        (["...", "...", "..."], (0, 0), (2, 2), 2 * SQRT2),
        ([".#", "#."], (0, 0), (0, 0), 0.0),
        ([".#.", "..."], (0, 0), (2, 0), 4.0),  # no corner is cut: two down and up, two along
        (["...", ".#.", "..."], (0, 1), (2, 1), 4.0),
        (["....", ".##.", "...."], (0, 0), (3, 2), 5.0),
        ([".....", "..#..", ".....", "....."], (0, 0), (4, 3), 2 * SQRT2 + 3.0),
    ],
)
def test_small_drawings_have_the_length_counted_by_hand(
    rows: list[str], start: tuple[int, int], goal: tuple[int, int], length: float
) -> None:
    grid = grid_from_rows(rows)
    result = search(grid, cell(grid, *start), cell(grid, *goal))
    assert result.length == pytest.approx(length, rel=1e-9)
    assert result.cells[0] == cell(grid, *start)
    assert result.cells[-1] == cell(grid, *goal)


@pytest.mark.parametrize("rows", [[".#.", ".#."], [".#", "#."]])
def test_an_empty_open_list_is_no_route(rows: list[str]) -> None:
    grid = grid_from_rows(rows)
    with pytest.raises(NoRoute, match="no route"):
        search(grid, cell(grid, 0, 0), cell(grid, len(rows[0]) - 1, 1))


def test_a_spent_budget_is_not_mistaken_for_no_route() -> None:
    grid = grid_from_rows(["." * 20] * 20)
    start, goal = cell(grid, 0, 0), cell(grid, 19, 19)
    needed = search(grid, start, goal).metrics.expanded
    assert search(grid, start, goal, budget=needed).length == pytest.approx(19 * SQRT2)
    with pytest.raises(SearchBudgetExceeded, match=str(needed - 1)):
        search(grid, start, goal, budget=needed - 1)


def test_octile_walks_straight_to_the_goal_on_an_empty_grid() -> None:
    grid = grid_from_rows(["." * 40] * 40)
    result = search(grid, cell(grid, 3, 5), cell(grid, 33, 20))
    assert result.metrics.expanded == len(result.cells) == 31


def test_the_goal_counts_when_it_is_popped_not_when_it_is_first_generated() -> None:
    class TwoWays:
        """0 → 3 at a cost of 10, or 0 → 1 → 2 → 3 at a cost of 3."""

        size = 4

        def moves(self, cell: int) -> list[tuple[int, int]]:
            return {0: [(3, 10), (1, 1)], 1: [(1, 1)], 2: [(1, 1)], 3: []}[cell]

    result = astar(TwoWays(), [0, 0, 0, 0], 0, 3)
    assert result.cells == (0, 1, 2, 3)
    assert result.cost == 3
    assert result.metrics == SearchMetrics(expanded=4, generated=4, updated=1, max_open=2)


grids = st.integers(2, 9).flatmap(
    lambda width: st.lists(st.text(alphabet="...#", min_size=width, max_size=width), min_size=2, max_size=9)
)


@given(rows=grids, data=st.data())
def test_every_path_is_valid_and_the_admissible_ones_are_shortest(
    rows: list[str], data: st.DataObject
) -> None:
    grid = grid_from_rows(rows)
    free = [n for n in range(grid.rows * grid.columns) if grid.is_free(n)]
    if len(free) < 2:
        return
    start, goal = data.draw(st.sampled_from(free)), data.draw(st.sampled_from(free))
    shortest = dijkstra_length(grid, start, goal)
    for heuristic in HEURISTICS:
        if shortest is None:
            with pytest.raises(NoRoute):
                search(grid, start, goal, heuristic)
            continue
        result = search(grid, start, goal, heuristic)
        assert_valid(grid, result)
        if heuristic == "manhattan":
            assert result.length >= shortest - 1e-9
        else:
            assert result.length == pytest.approx(shortest, rel=1e-9)
            assert search(grid, goal, start, heuristic).length == pytest.approx(result.length, rel=1e-9)


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


def test_manhattan_may_return_a_longer_path_than_octile() -> None:
    # Manhattan prefers the lower way round, whose cells look nearer to the goal than they are.
    rows = [
        "..........",
        ".########.",
        ".########.",
        "..........",
    ]
    longer = 0
    for gap in range(10):
        drawn = [row[:gap] + "." + row[gap + 1 :] for row in rows]
        grid = grid_from_rows(drawn)
        for x in range(10):
            start, goal = cell(grid, x, 0), cell(grid, 9 - x, 3)
            greedy, best = search(grid, start, goal, "manhattan"), search(grid, start, goal, "octile")
            assert_valid(grid, greedy)
            longer += greedy.length > best.length + 1e-9
    assert longer > 0


def load_moving_ai(name: str) -> Grid:
    text = (GRIDS / name).read_text(encoding="ascii")
    return grid_from_rows(text.split("map\n", 1)[1].split(), passable=".GS")


def test_lengths_equal_the_published_optima() -> None:
    grid = load_moving_ai("arena2.map")
    expansion = EightNeighbours(grid)
    lines = (GRIDS / "arena2.map.scen").read_text(encoding="ascii").split("\n", 1)[1].strip().split("\n")
    for line in lines[:: max(1, len(lines) // 40)]:
        *_, x0, y0, x1, y1, optimum = line.split()
        start, goal = cell(grid, int(x0), int(y0)), cell(grid, int(x1), int(y1))
        result = astar(expansion, estimates("octile", grid, goal), start, goal)
        assert result.length == pytest.approx(float(optimum), rel=6e-6), line  # six digits are published
