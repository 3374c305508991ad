"""Shortest and cheapest paths on grids: exact, without cut corners, and the same from kernel and twin."""

import math
import random
from array import array
from types import ModuleType

import pytest
from grid_cases import (
    StepCost,
    least_cost,
    path_cost,
    random_costs,
    random_grid,
)
from hypothesis import given
from hypothesis import strategies as st

from companion.planning import cost_search, jump_points
from companion.planning.grid import (
    DIAGONAL,
    MAX_CELLS,
    STRAIGHT,
    GridInputError,
    GridMap,
    NoGridPath,
    StepCosts,
    cheapest_path,
    shortest_path,
)
from companion.planning.kernels import load
from companion.planning.step_costs import bucket_width, even_costs, facets, ring_size
from mission_tools.planning import expansion

SEED = 20_261_122
AGREEING_CASES = 10_000
RULES_CASES = 1_500


def grid_of(*rows: str) -> GridMap:
    return GridMap(bytes(mark == "." for row in rows for mark in row), len(rows[0]), len(rows))


def octile(_from: int, _to: int, direction: int) -> float:
    return math.sqrt(2.0) if direction & 1 else 1.0


def mean_of(costs: StepCosts) -> StepCost:
    def step_cost(cell: int, successor: int, direction: int) -> float:
        return 0.5 * sum(costs.rows[costs.classes[at]][direction] for at in (cell, successor))

    return step_cost


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


def test_cost_search_kernel_and_twin_agree() -> None:
    search = kernel("_cost_search", cost_search).Search
    draw = random.Random(SEED)
    for case in range(AGREEING_CASES):
        grid, start, goal = random_grid(draw)
        costs = random_costs(draw, len(grid.free))
        arguments = (
            grid.free, grid.width, grid.height, costs.classes, costs.table,
            facets(costs.rows), bucket_width(costs.rows), ring_size(costs.rows),
        )  # fmt: skip
        ends = (start % grid.width, start // grid.width, goal % grid.width, goal // grid.width)
        assert search(*arguments).cheapest(*ends) == cost_search.Search(*arguments).cheapest(*ends), (
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
        assert (path.cost, path.length, walked) == pytest.approx((least,) * 3, rel=1e-9), f"case {case}"
    assert joined > RULES_CASES // 2


def test_cheapest_paths_are_as_cheap_as_the_rules_allow_and_cut_no_corner() -> None:
    draw = random.Random(SEED + 2)
    joined = 0
    for case in range(RULES_CASES):
        grid, start, goal = random_grid(draw)
        costs = random_costs(draw, len(grid.free))
        least = least_cost(grid, start, goal, mean_of(costs))
        if math.isinf(least):
            with pytest.raises(NoGridPath):
                cheapest_path(grid, costs, start, goal)
            continue
        joined += 1
        path = cheapest_path(grid, costs, start, goal)
        walked = path_cost(grid, path.cells, mean_of(costs))
        assert (path.cost, walked) == pytest.approx((least,) * 2, rel=1e-9), f"case {case}"
    assert joined > RULES_CASES // 2


def test_with_even_costs_the_cheapest_path_is_the_shortest() -> None:
    draw = random.Random(SEED + 3)
    for _ in range(300):
        grid, start, goal = random_grid(draw)
        costs = StepCosts.by_weight([2.5] * len(grid.free))
        try:
            shortest = shortest_path(grid, start, goal)
        except NoGridPath:
            continue
        assert cheapest_path(grid, costs, start, goal).cost == pytest.approx(2.5 * shortest.cost)


def test_one_map_answers_more_queries_than_a_cost_has_epochs() -> None:
    grid, start, goal = grid_of("..........", ".########.", ".........."), 10, 19
    lengths = {
        shortest_path(grid, *ends).cost for _ in range(1100) for ends in ((start, goal), (goal, start))
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
    assert path.cost == pytest.approx(3.0 + 2.0 * math.sqrt(2.0))
    assert shortest_path(grid_of("..."), 1, 1).cells == (1,)
    assert shortest_path(grid_of("..."), 2, 0).corners == (2, 0)


def test_a_current_is_cheaper_with_than_against() -> None:
    # Two lanes joined at both ends; in the upper the current runs east, in the lower there is none.
    grid = grid_of(".......", ".#####.", ".......")
    current = tuple(
        1.0 / (1.0 + 0.5 * across / math.hypot(across, along)) for across, along in cost_search.STEPS
    )
    classes = array("H", [1] * 7 + [0] * 14)
    costs = StepCosts(classes, (even_costs(1.0), current))
    assert 3 in cheapest_path(grid, costs, 7, 13).cells
    assert 17 in cheapest_path(grid, costs, 13, 7).cells


def test_a_current_that_cannot_be_stemmed_leaves_no_path() -> None:
    no_west = tuple(math.inf if across < 0 else 1.0 for across, _ in cost_search.STEPS)
    costs = StepCosts(array("H", [0] * 5), (no_west,))
    assert cheapest_path(grid_of("....."), costs, 0, 4).cost == 4.0
    with pytest.raises(NoGridPath):
        cheapest_path(grid_of("....."), costs, 4, 0)


def test_open_water_is_preferred_as_far_as_its_weight_says() -> None:
    # Straight on through cells of weight 3, or round them.
    weights = [1.0] * 7 + [1.0, *[3.0] * 5, 1.0] + [1.0] * 7
    grid = grid_of(*["." * 7] * 3)
    path = cheapest_path(grid, StepCosts.by_weight(weights), 7, 13)
    assert not set(path.cells) & set(range(8, 13)) or path.cost < 18.0
    assert path.cost == pytest.approx(least_cost(grid, 7, 13, mean_of(StepCosts.by_weight(weights))))


@given(
    st.lists(st.tuples(*[st.floats(0.01, 100.0) | st.just(math.inf)] * 8), min_size=1, max_size=4).filter(
        lambda rows: any(math.isfinite(cost) for row in rows for cost in row)
    ),
    st.lists(st.integers(0, 7), max_size=30),
)
def test_the_bound_is_never_above_the_cost_of_any_walk(
    rows: list[tuple[float, ...]], directions: list[int]
) -> None:
    cost = sum(min(row[direction] for row in rows) for direction in directions)
    across = sum(cost_search.STEPS[direction][0] for direction in directions)
    along = sum(cost_search.STEPS[direction][1] for direction in directions)
    for normal_x, normal_y in facets(rows):
        assert normal_x * across + normal_y * along <= cost * (1.0 + 1e-9) + 1e-9


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
        cheapest_path(grid, StepCosts.by_weight([1.0] * 6), 0, 1)
    with pytest.raises(GridInputError, match="goal cell 6 is outside the map of 3 × 2 cells"):
        shortest_path(grid, 0, 6)
    with pytest.raises(GridInputError, match="start cell -1 is outside"):
        shortest_path(grid, -1, 0)
    with pytest.raises(GridInputError, match="column 3, row 0 is outside the map of 3 × 2 cells"):
        grid.cell_at(3, 0)
    with pytest.raises(GridInputError, match="step costs of 5 cells for a map of 6"):
        cheapest_path(grid, StepCosts.by_weight([1.0] * 5), 0, 2)


def test_costs_that_cannot_be_used_are_named() -> None:
    one = even_costs(1.0)
    with pytest.raises(ValueError, match="step costs of 0 classes"):
        StepCosts(array("H"), ())
    with pytest.raises(ValueError, match=r"class 1 .* expected eight positive numbers"):
        StepCosts(array("H", [0]), (one, (1.0, 0.0, *one[2:])))
    with pytest.raises(ValueError, match="a cell has class 2: there are 1"):
        StepCosts(array("H", [0, 2]), (one,))
    with pytest.raises(ValueError, match="array of 'B': expected 'H'"):
        StepCosts(array("B", [0]), (one,))
    with pytest.raises(ValueError, match="no step costs are finite"):
        cheapest_path(grid_of(".."), StepCosts(array("H", [0, 0]), ((math.inf,) * 8,)), 0, 1)


def test_a_step_costs_what_the_paper_s_search_takes() -> None:
    assert (expansion.STRAIGHT, expansion.DIAGONAL) == (STRAIGHT, DIAGONAL)


def test_a_cell_is_counted_row_by_row_and_only_on_the_map() -> None:
    grid = grid_of("...", "...")
    assert [grid.cell_at(column, row) for row in range(2) for column in range(3)] == list(range(6))
    for column, row in ((-1, 0), (3, 0), (0, -1), (0, 2)):
        with pytest.raises(GridInputError, match="outside the map of 3 × 2 cells"):
            grid.cell_at(column, row)
