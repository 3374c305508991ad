"""The fair line through waypoints that lie close together."""

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.core.geo import Line, Point, distance_m
from companion.vehicle.mission.fair_line import SHIFT_SHARE, fair_line, is_short

RADIUS_M = 2.0
HALF_M = SHIFT_SHARE * RADIUS_M
NEIGHBOURS = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)]


def corners(*places: tuple[float, float]) -> list[Point]:
    points = [Point(*place) for place in places]
    return [corner for corner, _ in fair_line(points, [RADIUS_M] * len(points))]


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
    # The last but one may be left out where it lies near the end
    return [*walk, Point(at.north_m + 10.0 * north, at.east_m + 10.0 * east)]


def test_a_zigzag_from_cell_to_cell_becomes_one_leg() -> None:
    stairs = [(0.0, 0.0), (1.0, 0.0), (2.0, 1.0), (3.0, 1.0), (4.0, 2.0), (5.0, 2.0), (6.0, 3.0), (9.0, 4.5)]
    assert corners(*stairs) == [Point(0.0, 0.0), Point(9.0, 4.5)]


def test_waypoints_in_a_row_are_no_corners() -> None:
    assert corners(*((float(n), 0.0) for n in range(9))) == [Point(0.0, 0.0), Point(8.0, 0.0)]


def test_a_bend_keeps_one_corner_on_the_inside_of_its_waypoint() -> None:
    row = [(float(n), 0.0) for n in range(6)] + [(5.0 + n, float(n)) for n in range(1, 6)]
    start, corner, end = corners(*row)
    assert (start, end) == (Point(0.0, 0.0), Point(10.0, 5.0))
    assert distance_m(corner, Point(5.0, 0.0)) == pytest.approx(0.5)  # half of the shorter leg
    assert corner.east_m > 0.0


def test_a_drawn_curve_is_kept_as_it_is() -> None:
    """Gentle turns to one side are no zigzag, and the shortest line would hug the inside."""
    curve = [(25.0 * math.sin(0.1 * n), 25.0 - 25.0 * math.cos(0.1 * n)) for n in range(30)]
    assert corners(*curve) == [Point(*at) for at in curve]


def test_corners_between_long_legs_stay_where_they_are() -> None:
    lanes = [(0.0, 0.0), (50.0, 0.0), (50.0, 2.5), (0.0, 2.5), (0.0, 5.0), (50.0, 5.0)]
    assert corners(*lanes) == [Point(*at) for at in lanes]
    assert is_short(2.5, RADIUS_M)
    assert not is_short(50.0, RADIUS_M)


def test_a_place_that_the_way_only_turns_back_to_from_its_start_or_end_is_left_out() -> None:
    assert corners((0.0, 0.0), (-1.5, 0.5), (20.0, 0.0)) == [Point(0.0, 0.0), Point(20.0, 0.0)]
    assert corners((0.0, 0.0), (21.5, 0.5), (20.0, 0.0)) == [Point(0.0, 0.0), Point(20.0, 0.0)]


def test_a_place_further_back_is_sailed_to() -> None:
    there = [(0.0, 0.0), (-2.5, 0.5), (20.0, 0.0)]
    assert corners(*there) == [Point(*at) for at in there]


@given(cell_walks())
def test_every_waypoint_is_passed_in_its_turn_and_the_line_is_never_longer_than_the_plan(
    walk: list[Point],
) -> None:
    line = [corner for corner, _ in fair_line(walk, [RADIUS_M] * len(walk))]
    assert (line[0], line[-1]) == (walk[0], walk[-1])
    assert all(min(off_m(at, *leg) for leg in pairwise(line)) <= HALF_M + 1e-9 for at in walk)
    length_m = sum(distance_m(a, b) for a, b in pairwise(line))
    assert length_m <= sum(distance_m(a, b) for a, b in pairwise(walk)) + 1e-9


@given(cell_walks())
def test_the_line_is_nowhere_further_from_the_plan_than_half_a_gate(walk: list[Point]) -> None:
    for start, end in pairwise(corner for corner, _ in fair_line(walk, [RADIUS_M] * len(walk))):
        for share in (0.0, 0.25, 0.5, 0.75):
            at = Point(
                start.north_m + share * (end.north_m - start.north_m),
                start.east_m + share * (end.east_m - start.east_m),
            )
            assert min(off_m(at, *leg) for leg in pairwise(walk)) <= HALF_M + 1e-9


@given(cell_walks())
def test_each_corner_is_on_the_gate_of_its_waypoint_and_they_come_in_order(walk: list[Point]) -> None:
    found = fair_line(walk, [RADIUS_M] * len(walk))
    assert all(distance_m(corner, walk[n]) <= HALF_M + 1e-9 for corner, n in found)
    assert all(one < other for (_, one), (_, other) in pairwise(found))


@given(st.lists(st.tuples(st.floats(-30.0, 30.0), st.floats(-30.0, 30.0)), min_size=2, max_size=20))
def test_any_places_give_a_line_from_the_first_to_the_last(places: list[tuple[float, float]]) -> None:
    line = corners(*places)
    assert (line[0], line[-1]) == (places[0], places[-1])
    assert len(line) <= len(places)
