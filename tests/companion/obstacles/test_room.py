"""The room that obstacles leave by direction and along a path, from hand-calculated geometry."""

import math

import pytest
from boat_rig import nav_at

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.intent import FollowCircle, FollowLeg
from companion.obstacles.planning.detour import PORT, STARBOARD, Detour
from companion.obstacles.planning.detour_history import DetourHistory
from companion.obstacles.planning.free_space import FreeSpace, clear_m
from companion.obstacles.planning.way_ahead import way_ahead

HERE = Point(0.0, 0.0)
FREE = math.inf


# The room by direction and along a path


@pytest.mark.parametrize("bearing_rad", [0.0, 1.5 * math.pi, 0.5 * math.pi])
def test_within_the_clearance_only_courses_away_are_open(bearing_rad: float) -> None:
    water = FreeSpace(HERE, [Point(0.5 * math.cos(bearing_rad), 0.5 * math.sin(bearing_rad))], 1.0, 4.0)
    for off_deg, room_m in (
        (0.0, 0.0),
        (80.0, 0.0),
        (-80.0, 0.0),
        (85.0, 4.0),
        (-85.0, 4.0),
    ):  # 1.4 rad: 80.2°
        assert water.room_m(bearing_rad + math.radians(off_deg)) == room_m


@pytest.mark.parametrize("off_deg", [0.0, 10.0, -15.0])
def test_the_room_in_a_direction_ends_at_the_circle_of_the_clearance(off_deg: float) -> None:
    water, off = FreeSpace(HERE, [Point(3.0, 0.0)], 1.2, 4.0), math.radians(off_deg)
    assert water.room_m(off) == pytest.approx(
        3.0 * math.cos(off) - math.sqrt(1.44 - (3.0 * math.sin(off)) ** 2)
    )
    assert FreeSpace(HERE, [Point(5.1, 0.0)], 1.2, 4.0).room_m(0.0) == pytest.approx(3.9)
    assert FreeSpace(HERE, [Point(5.3, 0.0)], 1.2, 4.0).room_m(0.0) == 4.0


class East:
    """A line to the east."""

    def __init__(self, east_m: float, is_active: bool = True) -> None:
        self.east_m, self.is_active = east_m, is_active

    def room_m(self, point: Point, course_rad: float, reach_m: float) -> float:
        east = math.sin(course_rad)
        return reach_m if east <= 1e-9 else min((self.east_m - point.east_m) / east, reach_m)


@pytest.mark.parametrize(
    ("east_m", "inside_m", "is_open"),
    [(4.1, 0.0, True), (4.1, 0.2, False), (3.9, 0.0, False), (4.3, 0.2, True)],
)
def test_an_open_course_ends_within_the_bounds(east_m: float, inside_m: float, is_open: bool) -> None:
    water, east = FreeSpace(HERE, [], 1.0, 4.0), 0.5 * math.pi
    water.set_bounds(East(east_m), inside_m)
    assert water.first_open_rad(east, STARBOARD, 4.0) == (pytest.approx(east) if is_open else None)
    water = FreeSpace(HERE, [], 1.0, 4.0)
    water.set_bounds(East(east_m, is_active=False), inside_m)
    assert water.first_open_rad(east, STARBOARD, 4.0) == pytest.approx(east)


@pytest.mark.parametrize("from_deg", [0.0, 90.0, -120.0])
def test_the_search_for_a_course_begins_where_it_is_told(from_deg: float) -> None:
    water = FreeSpace(HERE, [], 1.0, 4.0)
    for side in (STARBOARD, PORT):
        assert water.first_open_rad(math.radians(from_deg), side, 4.0) == pytest.approx(
            math.radians(from_deg)
        )
        assert water.first_open_rad(0.0, side, 4.1) is None


@pytest.mark.parametrize(
    ("angle_deg", "room_m"), [(0.0, 0.0), (52.0, 0.0), (-52.0, 0.0), (54.0, FREE), (179.0, FREE)]
)
@pytest.mark.parametrize("distance_m", [0.5, 0.95])
def test_a_path_may_pass_what_is_too_near_already_unless_it_comes_closer(
    angle_deg: float, room_m: float, distance_m: float
) -> None:
    angle = math.radians(angle_deg)  # it passes at sin: 0.8 of the distance at 53.1°
    rock = Point(distance_m * math.cos(angle), distance_m * math.sin(angle))
    assert clear_m([HERE, Point(9.0, 0.0)], [rock], 1.0, 5.0) == room_m


def test_the_second_leg_of_a_path_begins_where_the_first_one_ends() -> None:
    way = [HERE, Point(2.0, 0.0), Point(2.0, 6.0)]
    assert clear_m(way, [Point(2.3, 0.5)], 0.4, 9.0) == pytest.approx(2.5 - math.sqrt(0.07))
    assert clear_m(way, [Point(2.0, 0.3)], 0.4, 9.0) == pytest.approx(2.0 - math.sqrt(0.07))
    assert clear_m(way, [Point(2.0, 4.5), Point(2.0, 3.5)], 0.4, 9.0) == pytest.approx(5.1)
    assert clear_m([HERE, HERE, Point(9.0, 0.0)], [Point(3.0, 0.0)], 1.0, 9.0) == pytest.approx(2.0)
    assert clear_m([HERE, Point(9.0, 0.0)], [Point(0.5, 1.2), Point(4.0, 0.0)], 1.0, 9.0) == pytest.approx(
        3.0
    )


def test_a_boat_off_a_leg_to_the_east_joins_it() -> None:
    leg = FollowLeg(Point(1.0, -10.0), Point(1.0, 30.0), 1.0)
    way = way_ahead(leg, nav_at(), BoatConfig(), 10.0)
    assert way[1] == pytest.approx((1.0, 2.0))


def test_a_circle_is_at_least_one_step_ahead_even_from_its_centre() -> None:
    short = way_ahead(FollowCircle(Point(0.0, 10.0), 10.0, True, 1.0), nav_at(), BoatConfig(), 0.0)
    assert len(short) == 2
    centre = way_ahead(FollowCircle(HERE, 10.0, True, 1.0), nav_at(), BoatConfig(), 0.0)
    assert centre[1] == pytest.approx((10.0 * math.cos(0.35), 10.0 * math.sin(0.35)))


# Detours at another scale


@pytest.mark.parametrize(
    ("edge_rad", "is_followed"), [(0.68, True), (0.72, False), (-1.88, True), (-1.92, False)]
)
@pytest.mark.parametrize("side", [STARBOARD, PORT])
def test_the_edge_that_is_followed_lies_on_the_side_of_the_obstacle(
    edge_rad: float, is_followed: bool, side: int
) -> None:
    detour = Detour(HERE, Point(-90.0, 0.0), side, 0.0)
    rock = Point(2.0 * math.cos(edge_rad), side * 2.0 * math.sin(edge_rad))
    assert detour.steer(HERE, [rock], FreeSpace(HERE, [], 1.0, 4.0), 4.0)
    expected = side * edge_rad if is_followed else math.pi
    assert abs(math.remainder(detour.course_rad - expected, math.tau)) < math.radians(2.6)


@pytest.mark.parametrize(("moved_m", "is_tried_again"), [(0.7, False), (0.8, True)])
def test_the_same_spot_is_one_and_a_half_margins_wide(moved_m: float, is_tried_again: bool) -> None:
    history, goal = DetourHistory(), Point(20.0, 0.0)
    assert history.detour_length_m == 0.0
    water = FreeSpace(HERE, [], 0.5, 4.0)
    for _ in (STARBOARD, PORT):
        assert history.start_detour(HERE, goal, water, 4.0, 0.5) is not None
    found = history.start_detour(Point(0.0, moved_m), goal, water, 4.0, 0.5)
    assert (found is not None) is is_tried_again
