"""Corners: an arc that touches both legs."""

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from companion.config import BoatConfig, with_value
from companion.geo import Line, Point, distance_m
from companion.guidance.corner import CIRCLE_SHARE, Corner, corner_between
from companion.units import wrap_pi

CONFIG = BoatConfig()
NORTH = Line(Point(0.0, 0.0), Point(50.0, 0.0))
EAST = Line(Point(50.0, 0.0), Point(50.0, 50.0))
turns = st.floats(-2.3, 2.3).filter(lambda turn: abs(turn) > 0.01)


def legs(turn_rad: float, course_rad: float = 0.3, length_m: float = 40.0) -> tuple[Line, Line]:
    start = Point(-7.0, 3.0)
    corner = Point(
        start.north_m + length_m * math.cos(course_rad), start.east_m + length_m * math.sin(course_rad)
    )
    onward = course_rad + turn_rad
    end = Point(corner.north_m + length_m * math.cos(onward), corner.east_m + length_m * math.sin(onward))
    return Line(start, corner), Line(corner, end)


def arc_point(corner: Corner, share: float) -> Point:
    """A place on the arc, worked out by going along it in small steps."""
    line = corner.line
    along = line.length_m - corner.entry_m
    north = line.start.north_m + along * math.cos(line.course_rad)
    east = line.start.east_m + along * math.sin(line.course_rad)
    steps = 2000
    step = share * corner.length_m / steps
    for n in range(steps):
        course = corner.course_rad((n + 0.5) * step)
        north += step * math.cos(course)
        east += step * math.sin(course)
    return Point(north, east)


def test_a_right_angle_leaves_the_leg_one_radius_before_the_corner() -> None:
    corner = Corner(NORTH, EAST, 1.5)
    assert corner.entry_m == pytest.approx(1.5)
    assert corner.length_m == pytest.approx(1.5 * math.pi / 2)
    assert corner.along_and_cross_track_m(Point(40.0, 2.0)) == pytest.approx((-8.5, 2.0))
    beyond = corner.along_and_cross_track_m(Point(51.0, 10.0))
    assert beyond == pytest.approx((corner.length_m + 8.5, -1.0))


@given(turns, st.floats(0.05, 0.95))
def test_a_boat_on_the_arc_is_on_its_path(turn: float, share: float) -> None:
    corner = corner_between(*legs(turn), 2.0, CONFIG)
    assert corner is not None
    along, cross = corner.along_and_cross_track_m(arc_point(corner, share))
    assert cross == pytest.approx(0.0, abs=1e-3)
    assert along == pytest.approx(share * corner.length_m, abs=1e-2)


@given(turns)
def test_the_arc_ends_on_the_next_leg_along_its_course(turn: float) -> None:
    corner = corner_between(*legs(turn), 2.0, CONFIG)
    assert corner is not None
    along, cross = corner.next_line.along_and_cross_track_m(arc_point(corner, 1.0))
    assert (along, cross) == pytest.approx((corner.entry_m, 0.0), abs=1e-3)
    assert wrap_pi(corner.course_rad(corner.length_m) - corner.next_line.course_rad) == pytest.approx(0.0)


@given(turns, st.floats(0.05, 20.0), st.floats(0.5, 60.0))
def test_the_arc_passes_within_the_waypoints_circle_and_stays_on_the_legs(
    turn: float, radius_m: float, length_m: float
) -> None:
    corner = corner_between(*legs(turn, length_m=length_m), radius_m, CONFIG)
    assert corner is not None
    assert corner.entry_m <= 0.5 * length_m + 1e-6
    miss = distance_m(arc_point(corner, 0.5), corner.line.end)
    assert miss <= CIRCLE_SHARE * radius_m + 1e-3


@given(turns, st.floats(-5.0, 5.0), st.floats(-5.0, 5.0))
def test_a_turn_to_port_is_the_mirror_of_one_to_starboard(turn: float, north: float, east: float) -> None:
    assume(abs(east) > 1e-6)
    start, corner = Point(-20.0, 0.0), Point(0.0, 0.0)
    ends = [Point(20.0 * math.cos(turn), side * 20.0 * math.sin(turn)) for side in (1.0, -1.0)]
    one, other = (Corner(Line(start, corner), Line(corner, end), 1.0) for end in ends)
    along, cross = one.along_and_cross_track_m(Point(north, east))
    mirrored = other.along_and_cross_track_m(Point(north, -east))
    assert mirrored == pytest.approx((along, -cross), abs=1e-6)


def test_starboard_of_the_arc_is_its_inside_in_a_turn_to_starboard() -> None:
    corner = Corner(NORTH, EAST, 2.0)
    _, cross = corner.along_and_cross_track_m(Point(48.5, 1.5))
    assert cross == pytest.approx(2.0 - math.hypot(0.5, 0.5))


def test_a_straight_junction_a_way_back_and_a_leg_without_length_have_no_arc() -> None:
    assert corner_between(NORTH, Line(NORTH.end, NORTH.start), 2.0, CONFIG) is None
    assert corner_between(NORTH, Line(NORTH.end, Point(90.0, 0.0)), 2.0, CONFIG) is None
    assert corner_between(NORTH, Line(NORTH.end, NORTH.end), 2.0, CONFIG) is None


def test_the_radius_asked_for_is_taken_where_it_fits() -> None:
    wide = with_value(CONFIG, "guidance.corner_radius_m", 30.0)
    gentle = corner_between(*legs(0.2, length_m=200.0), 2.0, wide)
    sharp = corner_between(*legs(1.57, length_m=200.0), 2.0, wide)
    assert gentle is not None
    assert sharp is not None
    assert gentle.radius_m == 30.0
    assert sharp.radius_m < 5.0


@given(st.floats(0.05, 1.57))
def test_a_lesser_turn_is_rounded_wider_without_passing_further_from_its_corner(turn: float) -> None:
    """A right angle's arc passes 0.414 of its radius from the corner."""
    corner = corner_between(*legs(turn, length_m=200.0), 2.0, CONFIG)
    assert corner is not None
    assert corner.radius_m >= CONFIG.guidance.corner_radius_m
    assert corner.radius_m * (1.0 / math.cos(0.5 * turn) - 1.0) <= 0.4143 * CONFIG.guidance.corner_radius_m


def test_a_slight_turn_takes_no_way_off_and_a_right_angle_is_rounded_as_tightly_as_asked() -> None:
    slight = corner_between(*legs(0.3, length_m=200.0), 2.0, CONFIG)
    square = corner_between(*legs(0.5 * math.pi, length_m=200.0), 2.0, CONFIG)
    assert slight is not None
    assert square is not None
    assert slight.speed_m_s(0.0, 2.0, CONFIG) == pytest.approx(2.0)
    assert square.radius_m == pytest.approx(CONFIG.guidance.corner_radius_m)
