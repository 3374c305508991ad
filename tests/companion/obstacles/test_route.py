"""A way around on the grid."""

import math

import pytest
from avoidance_rig import Lines, ring

from companion.core.geo import Point
from companion.obstacles.planning.clearance import ClearanceField
from companion.obstacles.planning.detour import Detour, blocked_m
from companion.obstacles.planning.route import find_route

HERE, GOAL = Point(0.0, 0.0), Point(50.0, 0.0)


def water(*solid: Point, bounds: Lines | None = None) -> ClearanceField:
    field = ClearanceField(HERE, 0.2, 9.0)
    if bounds is not None:
        field.fence(bounds, 1.0)
    field.fill(list(solid), list(solid), 0.35)
    return field


def wall(west_m: float, east_m: float, north_m: float = 4.0) -> list[Point]:
    return [Point(north_m, west_m + 0.2 * step) for step in range(round((east_m - west_m) / 0.2) + 1)]


def route(*solid: Point, goal: Point = GOAL, bounds: Lines | None = None) -> list[Point]:
    found = find_route(water(*solid, bounds=bounds), HERE, goal, 1.0, 0.8)
    assert found is not None
    return found


def test_open_water_is_crossed_straight() -> None:
    assert max(abs(at.east_m) for at in route()) < 0.5


def test_a_wall_is_passed_at_its_nearer_end() -> None:
    assert max(at.east_m for at in route(*wall(-6.0, 2.0))) > 2.7
    assert min(at.east_m for at in route(*wall(-2.0, 6.0))) < -2.7


@pytest.mark.parametrize("deg", [0.0, 90.0, 180.0, -90.0, 45.0])
def test_equal_ways_go_to_starboard(deg: float) -> None:
    course = math.radians(deg)
    goal = Point(50.0 * math.cos(course), 50.0 * math.sin(course))
    rock = [
        Point(4.0 * math.cos(course) + n, 4.0 * math.sin(course) + e)
        for n, e in (*ring(0.8), Point(0.0, 0.0))
    ]
    sides = [at.east_m * math.cos(course) - at.north_m * math.sin(course) for at in route(*rock, goal=goal)]
    assert max(sides) > 1.0
    assert min(sides) > -0.8


def test_a_route_keeps_clear_of_what_it_rounds() -> None:
    solid = wall(-3.0, 3.0)
    assert blocked_m(route(*solid), water(*solid), 0.6) == math.inf


def test_a_narrow_gap_is_taken_only_where_the_way_around_is_long() -> None:
    gap = 1.9
    rows = [3.0 + 0.4 * row for row in range(6)]
    short = [at for row in rows for at in (*wall(-2.0, -gap / 2, row), *wall(gap / 2, 2.0, row))]
    long = [at for row in rows for at in (*wall(-9.0, -gap / 2, row), *wall(gap / 2, 9.0, row))]
    at_wall = [abs(at.east_m) for at in route(*long) if 3.0 < at.north_m < 5.0]
    assert all(aside < 0.8 for aside in at_wall)
    assert max(abs(at.east_m) for at in route(*short)) > 2.4


def test_a_closed_ring_has_no_way_out() -> None:
    assert find_route(water(*ring(3.0)), HERE, GOAL, 1.0, 0.8) is None


def test_a_goal_on_an_obstacle_is_replaced_by_free_water_beside_it() -> None:
    rock = [Point(5.0 + n, e) for n, e in ring(0.4)]
    end = route(*rock, goal=Point(5.0, 0.0))[-1]
    assert 0.5 < math.dist(end, (5.0, 0.0)) < 3.0


def test_the_fence_closes_a_side() -> None:
    found = route(*wall(-6.0, 2.0), bounds=Lines(-12.0, 3.0))
    assert min(at.east_m for at in found) < -6.5
    assert max(at.east_m for at in found) < 2.1


def test_a_boat_too_near_to_something_still_finds_its_way() -> None:
    assert len(route(Point(0.3, 0.0))) > 1


def test_a_path_is_blocked_from_where_it_comes_too_near() -> None:
    field = water(Point(4.0, 0.0))
    straight = [HERE, GOAL]
    assert blocked_m(straight, field, 0.8) == pytest.approx(3.0, abs=0.4)
    assert blocked_m([HERE, Point(0.0, 9.0)], field, 0.8) == math.inf
    assert blocked_m([HERE, Point(2.0, 0.0)], field, 0.8) == math.inf


def test_a_path_away_from_something_near_is_free() -> None:
    field = water(Point(-0.4, 0.0))
    assert blocked_m([HERE, GOAL], field, 0.8) == math.inf


def updated(detour: Detour, field: ClearanceField, here: Point, now_s: float, certain: bool = True) -> bool:
    return detour.update(here, GOAL, field, 1.0, 0.6, now_s, is_certain=certain)


def test_a_detour_keeps_its_side_while_the_other_is_little_shorter() -> None:
    detour = Detour()
    assert updated(detour, water(*wall(-2.2, 2.0)), HERE, 0.0)
    assert detour.aside_m() > 1.0
    assert updated(detour, water(*wall(-2.0, 2.4)), HERE, 1.0)
    assert detour.aside_m() > 1.0
    assert updated(detour, water(*wall(-2.0, 8.0)), HERE, 2.0)
    assert detour.aside_m() < -1.0


def test_without_a_way_the_detour_gives_up_after_three_searches() -> None:
    detour, closed = Detour(), water(*ring(3.0))
    assert [updated(detour, closed, HERE, float(time_s)) for time_s in range(3)] == [True, True, False]


def test_single_echoes_do_not_make_it_give_up() -> None:
    detour, closed = Detour(), water(*ring(3.0))
    assert all(updated(detour, closed, HERE, float(time_s), certain=False) for time_s in range(9))
    assert detour.length_m == 0.0


def test_the_length_counts_since_the_last_progress() -> None:
    detour, field = Detour(), water(*wall(-9.0, 2.0))
    for step in range(10):
        updated(detour, field, Point(0.0, 0.5 * step), 0.1 * step)
    assert detour.length_m == pytest.approx(4.5)
    updated(detour, field, Point(3.0, 4.5), 1.0)
    assert detour.length_m == 0.0


def test_the_target_is_the_farthest_place_in_sight() -> None:
    detour, field = Detour(), water(*wall(-6.0, 2.0))
    assert detour.target(HERE, field, 5.0, 0.6) is None
    updated(detour, field, HERE, 0.0)
    target = detour.target(HERE, field, 5.0, 0.6)
    assert target is not None
    assert blocked_m([HERE, target], field, 0.6) == math.inf
    assert math.dist(HERE, target) > 2.5
