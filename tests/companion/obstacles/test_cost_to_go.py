"""The way that is left to the goal, around obstacles."""

import math
from itertools import accumulate
from operator import or_

import pytest
from avoidance_rig import Lines, ring
from hypothesis import given
from hypothesis import strategies as st

from companion.core.geo import Point
from companion.obstacles.planning.clearance import ClearanceField
from companion.obstacles.planning.cost_to_go import CostToGo, _counted

HERE, GOAL = Point(0.0, 0.0), Point(50.0, 0.0)


def wall(west_m: float, east_m: float, north_m: float = 4.0) -> list[Point]:
    return [Point(north_m, west_m + 0.2 * step) for step in range(round((east_m - west_m) / 0.2) + 1)]


def to_go(
    *solid: Point, goal: Point = GOAL, bounds: Lines | None = None, here: Point = HERE, reach_m: float = 10.0
) -> CostToGo:
    field = ClearanceField(here, 0.2, reach_m)
    if bounds is not None:
        field.fence(bounds, 1.0)
    field.fill(list(solid), list(solid), 0.35)
    return CostToGo(field, here, goal, 1.0, 0.6)


def left_m(found: CostToGo, north_m: float, east_m: float) -> float:
    """As compared with the way from the boat."""
    return found.at(north_m, east_m) - found.at(0.0, 0.0)


@pytest.mark.parametrize("goal", [Point(50.0, 0.0), Point(0.0, 50.0), Point(-50.0, 0.0), Point(0.0, -50.0)])
def test_towards_a_far_goal_every_straight_way_is_the_same_on_either_side(goal: Point) -> None:
    found = to_go(goal=goal)
    ahead, right = (goal.north_m / 50.0, goal.east_m / 50.0), (-goal.east_m / 50.0, goal.north_m / 50.0)
    for along_m, aside_m in ((4.0, 3.0), (0.0, 6.0), (-5.0, 2.0)):
        places = [
            [along_m * a + side * aside_m * r for a, r in zip(ahead, right, strict=True)] for side in (-1, 1)
        ]
        one, other = (left_m(found, *at) for at in places)
        assert one == pytest.approx(other, abs=0.5)
        expected = math.hypot(50.0 - along_m, aside_m) - 50.0
        assert one == pytest.approx(expected, abs=1.0)


def test_a_goal_within_the_grid_is_the_only_minimum() -> None:
    found = to_go(goal=Point(6.0, 3.0))
    at_goal = found.at(6.0, 3.0)
    assert at_goal < 0.5 + min(found.at(6.0 + n, 3.0 + e) for n in (-1.0, 1.0) for e in (-1.0, 1.0))
    assert found.at(0.0, 0.0) - at_goal == pytest.approx(math.hypot(6.0, 3.0), abs=0.8)


def test_the_way_leads_around_a_wall_by_its_nearer_end() -> None:
    found = to_go(*wall(-6.0, 2.0))
    assert left_m(found, 0.0, 2.0) < -0.5 < 0.5 < left_m(found, 0.0, -2.0)
    beyond = found.at(0.0, 0.0) - found.at(6.0, 0.0)
    assert beyond > 6.5
    assert found.is_open


def test_a_pocket_is_left_backwards() -> None:
    sides = [Point(n, e) for e in (-3.0, 3.0) for n in (at.east_m for at in wall(-2.0, 4.0))]
    found = to_go(*wall(-3.0, 3.0), *sides)
    assert found.is_open
    assert left_m(found, -2.0, 0.0) < -1.0


def test_a_narrow_gap_is_taken_only_where_the_way_around_is_long() -> None:
    rows = [3.0 + 0.4 * row for row in range(6)]
    short = to_go(*(at for row in rows for at in (*wall(-2.0, -0.95, row), *wall(0.95, 2.0, row))))
    long = to_go(*(at for row in rows for at in (*wall(-9.0, -0.95, row), *wall(0.95, 9.0, row))))
    assert left_m(long, 2.0, 0.0) < -1.0
    assert left_m(short, 2.0, 2.0) < left_m(short, 2.0, 0.0) + 0.5


def test_the_fence_closes_a_side_and_back_is_no_way() -> None:
    found = to_go(*wall(-6.0, 2.0), bounds=Lines(-12.0, 3.0))
    assert left_m(found, 0.0, -2.0) < -0.5
    assert not to_go(*wall(-6.0, 6.0), bounds=Lines(-6.0, 6.0)).is_open


def test_long_ways_are_counted_up_to_the_limit_of_a_byte() -> None:
    found = to_go(*ring(3.0), reach_m=30.0)
    assert found.steps <= 255
    assert max(found.cells) <= 255


@given(st.lists(st.integers(0, 2**12 - 1), max_size=255))
def test_a_cell_counts_the_waves_that_hold_it(fresh: list[int]) -> None:
    waves = list(accumulate(fresh, or_))
    assert list(_counted(waves, 12)) == [sum(wave >> cell & 1 for wave in waves) for cell in range(12)]
