import math

import pytest
from boat_rig import nav_at
from hypothesis import given
from hypothesis import strategies as st

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point, distance_m
from companion.core.intent import FollowCircle, FollowLeg, HoldCourse, HoldHeading, KeepStation, Stop
from companion.obstacles.planning.detour import PORT, STARBOARD, Detour, choose_side
from companion.obstacles.planning.free_space import SECTOR_RAD, FreeSpace, clear_m
from companion.obstacles.planning.way_ahead import way_ahead

HERE = Point(0.0, 0.0)
AHEAD = Point(10.0, 0.0)
REACH_M = 4.0
coordinates = st.floats(-6.0, 6.0)
points = st.builds(Point, coordinates, coordinates)


class Walls:
    """Bounds with a line so far to starboard (east) of the start."""

    is_active = True

    def __init__(self, east_m: float) -> None:
        self.east_m = east_m

    def room_m(self, point: Point, course_rad: float, reach_m: float) -> float:
        east = math.sin(course_rad)
        return reach_m if east <= 0.0 else min((self.east_m - point.east_m) / east, reach_m)


def test_a_thing_ahead_shuts_what_its_clearance_takes_up() -> None:
    water = FreeSpace(HERE, [Point(3.0, 0.0)], 1.0, REACH_M)
    assert water.room_m(0.0) == pytest.approx(2.0)
    assert water.room_m(math.asin(1.0 / 3.0) + 2.0 * SECTOR_RAD) == REACH_M
    assert water.room_m(math.pi) == REACH_M


def test_the_first_open_course_is_found_on_either_side() -> None:
    water = FreeSpace(HERE, [Point(3.0, 0.0)], 1.0, REACH_M)
    starboard, port = (water.first_open_rad(0.0, side, REACH_M) for side in (STARBOARD, PORT))
    assert starboard is not None
    assert port is not None
    assert math.asin(1.0 / 3.0) < starboard < math.asin(1.0 / 3.0) + 2.0 * SECTOR_RAD
    assert port == pytest.approx(-starboard)


def test_bounds_on_one_side_shut_it() -> None:
    water = FreeSpace(HERE, [Point(3.0, 0.0)], 1.0, REACH_M)
    water.set_bounds(Walls(0.2), 0.0)
    assert water.first_open_rad(0.0, STARBOARD, REACH_M) is None
    assert choose_side(water, 0.0, REACH_M) is not None
    assert choose_side(water, 0.0, REACH_M)[0] == PORT  # type: ignore[index]


def test_sides_alike_mean_starboard_and_a_smaller_turn_wins() -> None:
    alike = FreeSpace(HERE, [Point(3.0, 0.1)], 1.0, REACH_M)
    assert choose_side(alike, 0.0, REACH_M)[0] == STARBOARD  # type: ignore[index]
    to_starboard = [Point(3.0, 0.3 * step) for step in range(8)]
    assert choose_side(FreeSpace(HERE, to_starboard, 1.0, REACH_M), 0.0, REACH_M)[0] == PORT  # type: ignore[index]


def test_a_boat_inside_the_clearance_may_sail_away_but_not_nearer() -> None:
    water = FreeSpace(HERE, [Point(0.5, 0.0)], 1.0, REACH_M)
    assert water.room_m(0.0) == 0.0
    assert water.room_m(math.pi) == REACH_M


@given(st.lists(points, max_size=12), st.floats(-math.pi, math.pi))
def test_an_open_course_is_clear_all_along(things: list[Point], from_rad: float) -> None:
    water = FreeSpace(HERE, things, 1.0, REACH_M)
    course = water.first_open_rad(from_rad, STARBOARD, REACH_M)
    if course is None or any(distance_m(HERE, thing) < 1.0 for thing in things):
        return
    for step in range(41):
        at = Point(0.1 * step * math.cos(course), 0.1 * step * math.sin(course))
        assert all(distance_m(at, thing) > 1.0 - 0.01 for thing in things)


def test_a_way_is_clear_up_to_the_clearance_and_round_its_corners() -> None:
    way = [HERE, Point(3.0, 0.0), Point(3.0, 5.0)]
    assert clear_m(way, [Point(3.0, 4.0)], 1.0, 20.0) == pytest.approx(6.0)
    assert clear_m(way, [Point(6.0, 0.0)], 1.0, 20.0) == math.inf
    assert clear_m(way, [Point(3.0, 4.0)], 1.0, 5.0) == math.inf
    assert clear_m([HERE], [Point(0.1, 0.0)], 1.0, 5.0) == math.inf


def test_a_way_along_a_shore_that_is_too_near_already_is_not_shut() -> None:
    shore = [Point(0.2 * step, 0.8) for step in range(-10, 30)]
    assert clear_m([HERE, Point(5.0, 0.0)], [shore[10]], 1.0, 5.0) == math.inf
    assert clear_m([HERE, Point(0.0, 5.0)], [Point(0.0, 0.8)], 1.0, 5.0) == 0.0


@given(st.lists(points, min_size=1, max_size=8), st.lists(points, min_size=2, max_size=4))
def test_no_point_before_the_clear_distance_is_too_near(things: list[Point], way: list[Point]) -> None:
    if any(distance_m(way[0], thing) < 1.1 for thing in things):
        return
    clear = clear_m(way, things, 1.0, 8.0)
    start, end = way[0], way[1]
    length = distance_m(start, end)
    for step in range(20):
        share = step / 20.0
        if share * length < min(clear, 8.0) - 0.01:
            at = Point(
                start.north_m + share * (end.north_m - start.north_m),
                start.east_m + share * (end.east_m - start.east_m),
            )
            assert all(distance_m(at, thing) > 1.0 - 0.01 for thing in things)


def test_the_way_ahead_of_each_intent() -> None:
    config, nav = BoatConfig(), nav_at()
    leg = FollowLeg(Point(-5.0, 0.0), AHEAD, 2.0, Point(10.0, 10.0))
    assert way_ahead(leg, nav, config, 6.0)[-2:] == [AHEAD, Point(10.0, 10.0)]
    assert way_ahead(KeepStation(AHEAD), nav, config, 6.0) == [HERE, AHEAD]
    assert way_ahead(HoldCourse(math.pi / 2, 1.0), nav, config, 6.0)[-1] == pytest.approx((0.0, 6.0))
    assert way_ahead(HoldHeading(0.0, -1.0), nav, config, 6.0)[-1] == pytest.approx((-6.0, 0.0))
    assert way_ahead(Stop(), nav, config, 6.0) == [HERE]
    circle = way_ahead(FollowCircle(Point(0.0, 5.0), 5.0, True, 1.0), nav, config, 6.0)
    assert all(distance_m(at, Point(0.0, 5.0)) == pytest.approx(5.0) for at in circle)
    assert circle[1].north_m > 0.0  # clockwise, from the circle's west


def test_a_boat_off_its_leg_comes_back_to_the_line_before_the_end() -> None:
    leg = FollowLeg(Point(-5.0, 0.0), Point(50.0, 0.0), 2.0)
    way = way_ahead(leg, nav_at(0.0, 3.0), BoatConfig(), 6.0)
    assert way[1].east_m == pytest.approx(0.0)
    assert 0.0 < way[1].north_m < 10.0


def test_a_detour_follows_the_edge_and_ends_nearer_the_goal() -> None:
    wall = [Point(3.0, 0.2 * step) for step in range(-10, 11)]
    detour = Detour(HERE, AHEAD, STARBOARD, 0.0)
    assert detour.steer(HERE, wall, FreeSpace(HERE, wall, 1.0, REACH_M), REACH_M)
    assert 0.7 < detour.course_rad < math.pi
    beside = Point(2.0, 3.4)
    detour.advance(beside, 1.0)
    assert detour.steer(beside, wall, FreeSpace(beside, wall, 1.0, REACH_M), REACH_M)
    assert abs(detour.course_rad) < 0.7
    assert detour.has_progressed(beside, REACH_M, 0.3)
    assert not detour.has_progressed(Point(-3.0, 3.4), 2.0, 0.3)


def test_a_detour_that_comes_back_to_its_beginning_is_round() -> None:
    detour = Detour(HERE, AHEAD, STARBOARD, 0.0)
    assert not detour.has_returned(HERE, 1.0)
    for at in (Point(0.0, 4.0), Point(4.0, 4.0), Point(0.5, 0.0)):
        detour.advance(at, 1.0)
    assert detour.has_returned(Point(0.5, 0.0), 1.0)
    assert detour.length_m > 8.0
