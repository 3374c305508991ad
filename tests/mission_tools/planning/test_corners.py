"""Corners are widened by what a turn cuts off, and no farther than there is room."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.core.geo import Point, distance_m
from mission_tools.planning.smooth import corner_cut_m, widen_corners

CORNER = (Point(0.0, 0.0), Point(100.0, 0.0), Point(100.0, 100.0))


def everywhere(a: Point, b: Point) -> bool:
    return True


def nowhere(a: Point, b: Point) -> bool:
    return False


@given(st.floats(0.01, 3.1), st.floats(0.1, 10.0))
def test_the_cut_is_the_gap_between_the_corner_and_the_arc_that_rounds_it(
    turn: float, radius_m: float
) -> None:
    arc_radius_m = radius_m / math.tan(0.5 * turn)
    centre_to_corner_m = math.hypot(arc_radius_m, radius_m)
    assert corner_cut_m(turn, radius_m) == pytest.approx(
        centre_to_corner_m - arc_radius_m, rel=1e-6, abs=1e-9
    )


def test_a_corner_moves_outwards_by_its_cut_and_the_ends_stay() -> None:
    start, moved, end = widen_corners(CORNER, everywhere, 2.0, math.inf)
    assert (start, end) == (CORNER[0], CORNER[2])
    assert distance_m(moved, CORNER[1]) == pytest.approx(2.0 * math.tan(math.pi / 8.0))
    assert moved.north_m > 100.0  # a turn to starboard at the north end: outwards is north-west
    assert moved.east_m < 0.0


def test_the_rounded_track_no_longer_comes_nearer_to_the_headland_than_the_taut_corner_did() -> None:
    _, moved, _ = widen_corners(CORNER, everywhere, 2.0, math.inf)
    headland = Point(96.0, 4.0)
    inwards = math.atan2(headland.east_m - moved.east_m, headland.north_m - moved.north_m)
    cut_m = corner_cut_m(0.5 * math.pi, 2.0)
    apex = Point(moved.north_m + cut_m * math.cos(inwards), moved.east_m + cut_m * math.sin(inwards))
    assert distance_m(apex, headland) == pytest.approx(distance_m(CORNER[1], headland), abs=0.01)


def test_a_corner_with_little_room_moves_as_far_as_it_may() -> None:
    def is_south_of_a_quay(a: Point, b: Point) -> bool:
        return max(a.north_m, b.north_m) < 100.3

    _, moved, _ = widen_corners(CORNER, is_south_of_a_quay, 2.0, math.inf)
    assert 100.0 < moved.north_m < 100.3
