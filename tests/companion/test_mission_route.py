"""The way that a mission leads: its corners, and every waypoint still passed in its turn."""

import math
from itertools import pairwise

import pytest
from boat_rig import FRAME, nav_at, place
from hypothesis import given
from hypothesis import strategies as st

from companion.config import BoatConfig
from companion.geo import Line, Point
from companion.vehicle.intent import FollowLeg
from companion.vehicle.mission_progress import MissionProgress
from companion.vehicle.mission_route import MOST, SHIFT_SHARE, corners_of, waypoints_ahead
from companion.vehicle.mission_steps import Home, Jump, SetSpeed, Step, Wait, Waypoint

CONFIG = BoatConfig()
RADIUS_M = 2.0
SHIFT_M = SHIFT_SHARE * RADIUS_M
NEIGHBOURS = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)]


def corners(*places: tuple[float, float]) -> list[Point]:
    points = [Point(*at) for at in places]
    return [points[n] for n in corners_of(points, [RADIUS_M] * len(points))]


def mission(*places: tuple[float, float]) -> MissionProgress:
    return progress_of(*(Waypoint(place(*at)) for at in places))


def progress_of(*steps: Step) -> MissionProgress:
    progress = MissionProgress()
    progress.replace((Home(), *steps))
    return progress


def sailed(progress: MissionProgress, at: Point, step_m: float = 0.1, most: int = 20000) -> list[FollowLeg]:
    """The different legs that a boat is given which is exactly on its line, up to the end of the mission."""
    legs: list[FollowLeg] = []
    for _ in range(most):
        intent = progress.update(nav_at(*at), FRAME, CONFIG, 0.0)
        if progress.finished:
            return legs
        assert isinstance(intent, FollowLeg)
        if not legs or legs[-1] is not intent:
            legs.append(intent)
        line = intent.line
        along = line.along_and_cross_track_m(at)[0] + step_m
        at = Point(
            line.start.north_m + along * math.cos(line.course_rad),
            line.start.east_m + along * math.sin(line.course_rad),
        )
    raise AssertionError("the mission does not end")


def stairs(cells: int) -> list[tuple[float, float]]:
    """North and north-east in turn, from cell to cell of a grid of 1 m."""
    return [(float(n), float(n // 2)) for n in range(1, cells + 1)]


def off_m(at: Point, start: Point, end: Point) -> float:
    """Distance from a leg."""
    line = Line(start, end)
    along, cross = line.along_and_cross_track_m(at)
    return math.hypot(cross, max(-along, along - line.length_m, 0.0))


@st.composite
def cell_walks(draw: st.DrawFn) -> list[Point]:
    """From cell to neighbouring cell of a grid, turning by 45° or 90° at most."""
    cell_m = draw(st.sampled_from((0.5, 1.0, 2.0, 4.0)))
    at, direction, walk = Point(0.0, 0.0), 0, [Point(0.0, 0.0)]
    for turn, cells in draw(
        st.lists(st.tuples(st.integers(-2, 2), st.integers(1, 5)), min_size=3, max_size=15)
    ):
        direction = (direction + turn) % 8
        north, east = NEIGHBOURS[direction]
        for _ in range(cells):
            at = Point(at.north_m + cell_m * north, at.east_m + cell_m * east)
            walk.append(at)
    return walk


# Which waypoints are corners


def test_a_zigzag_from_cell_to_cell_becomes_one_leg() -> None:
    assert corners((0.0, 0.0), *stairs(30)) == [Point(0.0, 0.0), Point(30.0, 15.0)]


def test_waypoints_in_a_row_are_no_corners() -> None:
    assert corners(*((float(n), 0.0) for n in range(9))) == [Point(0.0, 0.0), Point(8.0, 0.0)]


def test_how_far_a_waypoint_may_lie_beside_the_way_goes_with_its_radius() -> None:
    near, far = 0.89, 0.91
    assert len(corners((0.0, 0.0), (3.0, near), (6.0, 0.0))) == 2
    assert len(corners((0.0, 0.0), (3.0, far), (6.0, 0.0))) == 3
    points = [Point(0.0, 0.0), Point(3.0, far), Point(6.0, 0.0)]
    assert corners_of(points, [2.0, 3.0, 2.0]) == [0, 2]


def test_a_drawn_curve_is_kept_as_it_is() -> None:
    """Gentle turns to one side are no zigzag, though chords across some would be near enough."""
    curve = [(25.0 * math.sin(0.1 * n), 25.0 - 25.0 * math.cos(0.1 * n)) for n in range(30)]
    assert corners(*curve) == [Point(*at) for at in curve]


def test_corners_between_long_legs_stay_where_they_are() -> None:
    lanes = [(0.0, 0.0), (50.0, 0.0), (50.0, 2.5), (0.0, 2.5), (0.0, 5.0), (50.0, 5.0)]
    assert corners(*lanes) == [Point(*at) for at in lanes]


def test_a_way_back_along_the_same_line_is_not_cut_off() -> None:
    there_and_back = [(0.0, 0.0), (10.0, 0.0), (4.0, 0.0), (20.0, 0.0)]
    assert corners(*there_and_back) == [Point(*at) for at in there_and_back]


def test_a_place_that_the_way_only_turns_back_to_from_its_start_or_end_is_left_out() -> None:
    assert corners((0.0, 0.0), (-1.5, 0.5), (20.0, 0.0)) == [Point(0.0, 0.0), Point(20.0, 0.0)]
    assert corners((0.0, 0.0), (21.5, 0.5), (20.0, 0.0)) == [Point(0.0, 0.0), Point(20.0, 0.0)]


def test_a_place_further_back_is_sailed_to() -> None:
    there = [(0.0, 0.0), (-2.5, 0.5), (20.0, 0.0)]
    assert corners(*there) == [Point(*at) for at in there]


@given(cell_walks())
def test_every_waypoint_lies_near_the_way_between_its_corners_one_after_the_other(walk: list[Point]) -> None:
    found = corners_of(walk, [RADIUS_M] * len(walk))
    assert (found[0], found[-1]) == (0, len(walk) - 1)
    assert all(one < other for one, other in pairwise(found))
    for one, other in pairwise(found):
        line, along_m = Line(walk[one], walk[other]), 0.0
        for n in range(one + 1, other):
            if n in (1, len(walk) - 2) and off_m(walk[n], walk[one], walk[other]) > SHIFT_M:
                continue  # the way only turns back there
            assert off_m(walk[n], walk[one], walk[other]) <= SHIFT_M + 1e-9
            further_m = line.along_and_cross_track_m(walk[n])[0]
            assert further_m >= along_m - SHIFT_M - 1e-9
            along_m = max(along_m, further_m)


@given(st.lists(st.tuples(st.floats(-30.0, 30.0), st.floats(-30.0, 30.0)), min_size=2, max_size=20))
def test_any_places_have_corners_from_the_first_to_the_last(places: list[tuple[float, float]]) -> None:
    found = corners(*places)
    assert (found[0], found[-1]) == (places[0], places[-1])
    assert len(found) <= len(places)


# Which waypoints follow


def test_it_looks_as_far_as_the_boat_goes_on_without_a_stop() -> None:
    a, b, stay = (Waypoint(place(n, 0.0), hold_s) for n, hold_s in ((1.0, 0.0), (2.0, 0.0), (3.0, 5.0)))
    assert waypoints_ahead((Home(), a, b, stay, a), 1, {}) == ([b, stay], False)
    assert waypoints_ahead((Home(), a, SetSpeed(1.0), b, Wait(1.0), a), 1, {}) == ([b], False)
    assert waypoints_ahead((Home(), stay, a), 1, {}) == ([], False)


def test_it_looks_through_one_jump_as_often_as_that_is_still_made() -> None:
    a, b, c = (Waypoint(place(n, 0.0)) for n in (1.0, 2.0, 3.0))
    steps = (Home(), a, b, Jump(1, 2), c)
    assert waypoints_ahead(steps, 2, {3: 2}) == ([c], False)
    assert waypoints_ahead(steps, 2, {3: 1}) == ([a, b], True)


def test_it_does_not_look_through_the_whole_of_a_long_mission() -> None:
    row = [Waypoint(place(float(n), 0.0)) for n in range(200)]
    ahead, is_open = waypoints_ahead((Home(), *row), 1, {})
    assert ahead == row[1 : 1 + MOST]
    assert is_open


# What is sailed


def test_stairs_are_sailed_as_one_leg_and_every_waypoint_is_reported() -> None:
    progress = mission(*stairs(30))
    legs = sailed(progress, Point(0.0, 0.0))
    assert len(legs) == 1
    assert legs[0].end == pytest.approx((30.0, 15.0), abs=1e-3)
    assert progress.take_reached() == list(range(1, 31))


def test_a_long_mission_is_looked_through_piece_by_piece_without_a_bend_where_they_join() -> None:
    progress = mission(*stairs(200))
    legs = sailed(progress, Point(0.0, 0.0))
    courses = [leg.line.course_rad for leg in legs]
    assert max(courses) - min(courses) < math.radians(5.0)
    assert progress.take_reached() == list(range(1, 201))


def test_legs_of_a_mission_with_long_legs_are_sailed_as_they_are() -> None:
    places = [(50.0, 0.0), (50.0, 50.0), (0.0, 50.0)]
    legs = sailed(mission(*places), Point(0.0, 0.0))
    assert [tuple(leg.end) for leg in legs] == [pytest.approx(at, abs=1e-3) for at in places]
    assert legs[0].next_end == pytest.approx(places[1], abs=1e-3)
    assert [tuple(at) for at in legs[0].onward] == [pytest.approx(places[2], abs=1e-3)]
    assert legs[2].next_end is None


def test_a_leg_begins_where_the_one_before_it_was_told_to_lead() -> None:
    """So the fillet between them is sailed to its end."""
    turns = [(float(n), 0.0) for n in range(1, 12)] + [(11.0, float(n)) for n in range(1, 12)]
    legs = sailed(mission(*turns, (11.0, 60.0), (80.0, 60.0)), Point(0.0, 0.0))
    for leg, onward in pairwise(legs):
        assert (leg.end, leg.next_end) == (onward.start, onward.end)


def test_a_speed_between_two_waypoints_does_not_count_as_one() -> None:
    turns = [Waypoint(place(float(n), 0.0)) for n in (4, 8, 12)]
    progress = progress_of(
        turns[0], SetSpeed(1.0), turns[1], SetSpeed(2.0), turns[2], Waypoint(place(12.0, 9.0))
    )
    legs = sailed(progress, Point(0.0, 0.0))
    assert [leg.speed_m_s for leg in legs] == [2.0, 1.0, 2.0, 2.0]
    assert [tuple(leg.end) for leg in legs[:3]] == [pytest.approx((12.0, 0.0), abs=1e-3)] * 3
    assert progress.take_reached() == [1, 3, 5, 6]


def test_a_waypoints_own_radius_goes_with_its_corner() -> None:
    progress = progress_of(Waypoint(place(50.0, 0.0), radius_m=5.0), Waypoint(place(50.0, 50.0)))
    assert [leg.radius_m for leg in sailed(progress, Point(0.0, 0.0))] == [5.0, 0.0]


def test_a_first_waypoint_just_behind_the_boat_is_passed_without_turning_back() -> None:
    progress = mission((-1.0, 0.3), (20.0, 0.0))
    legs = sailed(progress, Point(0.0, 0.0))
    assert [leg.end.north_m for leg in legs] == [pytest.approx(20.0, abs=1e-3)] * len(legs)
    assert progress.take_reached() == [1, 2]


def test_a_boat_that_was_swept_away_from_a_short_leg_aims_at_its_waypoint_again() -> None:
    progress = mission(*stairs(30))
    progress.update(nav_at(0.0, 0.0), FRAME, CONFIG, 0.0)
    intent = progress.update(nav_at(9.0, -9.0), FRAME, CONFIG, 0.0)
    assert isinstance(intent, FollowLeg)
    assert intent.start == (9.0, -9.0)
    assert intent.end == pytest.approx((1.0, 0.0), abs=1e-3)


def test_a_ring_of_short_legs_is_sailed_round_and_round() -> None:
    ring = [(4.0 * math.sin(n * math.pi / 4), 4.0 * math.cos(n * math.pi / 4)) for n in range(8)]
    progress = progress_of(*(Waypoint(place(*at)) for at in ring), Jump(1, 2))
    legs = sailed(progress, Point(0.0, 4.0))
    assert progress.take_reached() == list(range(1, 9)) * 3
    assert len(legs) > 20
    assert all(leg.next_end is not None for leg in legs[:-1])
