"""Shortest paths on grids: exact, without cut corners, and the same from kernel and twin."""

import math
import random
from types import ModuleType

import pytest
from grid_cases import (
    least_cost,
    path_cost,
    random_grid,
)

from companion.planning import jump_points
from companion.planning.grid import (
    DIAGONAL,
    MAX_CELLS,
    STRAIGHT,
    GridInputError,
    GridMap,
    NoGridPath,
    shortest_path,
)
from companion.planning.kernels import load
from mission_tools.planning import expansion

SEED = 20_261_122
AGREEING_CASES = 10_000
RULES_CASES = 1_500


def grid_of(*rows: str) -> GridMap:
    return GridMap(bytes(mark == "." for row in rows for mark in row), len(rows[0]), len(rows))


def octile(_from: int, _to: int, direction: int) -> float:
    return math.sqrt(2.0) if direction & 1 else 1.0


def kernel(compiled: str, twin: ModuleType) -> ModuleType:
    found = load(compiled, twin.__name__.rpartition(".")[2])
    if found is twin:
        pytest.skip("the kernels are not built or not asked for: python setup.py build_ext --inplace")
    return found


def test_jump_point_kernel_and_twin_agree() -> None:
    searcher = kernel("_jump_points", jump_points).Searcher
    draw = random.Random(SEED)
    for case in range(AGREEING_CASES):
        grid, start, goal = random_grid(draw)
        size = (grid.free, grid.width, grid.height)
        assert searcher(*size).shortest(start, goal) == jump_points.Searcher(*size).shortest(start, goal), (
            f"seed {SEED}, case {case}"
        )


def test_shortest_paths_are_as_short_as_the_rules_allow_and_cut_no_corner() -> None:
    draw = random.Random(SEED + 1)
    joined = 0
    for case in range(RULES_CASES):
        grid, start, goal = random_grid(draw)
        least = least_cost(grid, start, goal, octile)
        if math.isinf(least):
            with pytest.raises(NoGridPath):
                shortest_path(grid, start, goal)
            continue
        joined += 1
        path = shortest_path(grid, start, goal)
        assert (path.cells[0], path.cells[-1]) == (start, goal)
        walked = path_cost(grid, path.cells, octile)
        assert (path.length, walked) == pytest.approx((least,) * 2, rel=1e-9), f"case {case}"
    assert joined > RULES_CASES // 2


def test_one_map_answers_more_queries_than_a_cost_has_epochs() -> None:
    grid, start, goal = grid_of("..........", ".########.", ".........."), 10, 19
    lengths = {
        shortest_path(grid, *ends).length for _ in range(1100) for ends in ((start, goal), (goal, start))
    }
    assert lengths == {11.0}


def test_a_corner_is_not_cut() -> None:
    grid = grid_of(".#", "..")
    assert shortest_path(grid, 0, 3).cells == (0, 2, 3)
    with pytest.raises(NoGridPath, match=r"no path from cell 0 \(column 0, row 0\) to cell 3"):
        shortest_path(grid_of(".#", "#."), 0, 3)


def test_the_path_names_its_corners_and_every_cell() -> None:
    path = shortest_path(grid_of("......", "......", "......"), 0, 17)
    assert path.corners in ((0, 14, 17), (0, 3, 17), (0, 1, 15, 17), (0, 2, 16, 17))
    assert len(path.cells) == 6
    assert path.length == pytest.approx(3.0 + 2.0 * math.sqrt(2.0))
    assert shortest_path(grid_of("..."), 1, 1).cells == (1,)
    assert shortest_path(grid_of("..."), 2, 0).corners == (2, 0)


def test_inputs_that_cannot_be_used_are_named() -> None:
    with pytest.raises(GridInputError, match="grid map of 0 × 3 cells: expected at least one"):
        GridMap(b"", 0, 3)
    with pytest.raises(GridInputError, match="grid map of 2 × 2 cells has 3 bytes: expected 4"):
        GridMap(b"\1\1\1", 2, 2)
    with pytest.raises(GridInputError, match=f"expected at most {MAX_CELLS}"):
        GridMap(bytes(MAX_CELLS + 1), MAX_CELLS + 1, 1)
    grid = grid_of(".#.", "...")
    with pytest.raises(GridInputError, match=r"start cell 1 \(column 1, row 0\) is blocked"):
        shortest_path(grid, 1, 5)
    with pytest.raises(GridInputError, match=r"goal cell 1 \(column 1, row 0\) is blocked"):
        shortest_path(grid, 0, 1)
    with pytest.raises(GridInputError, match="goal cell 6 is outside the map of 3 × 2 cells"):
        shortest_path(grid, 0, 6)
    with pytest.raises(GridInputError, match="start cell -1 is outside"):
        shortest_path(grid, -1, 0)
    with pytest.raises(GridInputError, match="column 3, row 0 is outside the map of 3 × 2 cells"):
        grid.cell_at(3, 0)


def test_a_step_costs_what_the_paper_s_search_takes() -> None:
    assert (expansion.STRAIGHT, expansion.DIAGONAL) == (STRAIGHT, DIAGONAL)


def test_a_cell_is_counted_row_by_row_and_only_on_the_map() -> None:
    grid = grid_of("...", "...")
    assert [grid.cell_at(column, row) for row in range(2) for column in range(3)] == list(range(6))
    for column, row in ((-1, 0), (3, 0), (0, -1), (0, 2)):
        with pytest.raises(GridInputError, match="outside the map of 3 × 2 cells"):
            grid.cell_at(column, row)
