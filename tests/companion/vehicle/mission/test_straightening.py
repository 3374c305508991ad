"""The straightened line through waypoints that lie close together."""

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.core.geo import Line, Point, distance_m, path_length_m
from companion.vehicle.mission.straightening import SHIFT_SHARE, straighten

RADIUS_M = 2.0
HALF_M = SHIFT_SHARE * RADIUS_M
NEIGHBOURS = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)]


def corners(*places: tuple[float, float]) -> list[Point]:
    points = [Point(*place) for place in places]
    return [corner for corner, _ in straighten(points, [RADIUS_M] * len(points))]


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


def test_a_drawn_curve_is_kept_as_it_is() -> None:
    """Gentle turns to one side are no zigzag, and the shortest line would hug the inside."""
    curve = [(25.0 * math.sin(0.1 * n), 25.0 - 25.0 * math.cos(0.1 * n)) for n in range(30)]
    assert corners(*curve) == [Point(*at) for at in curve]


@given(cell_walks())
def test_every_waypoint_is_passed_in_its_turn_and_the_line_is_never_longer_than_the_plan(
    walk: list[Point],
) -> None:
    line = [corner for corner, _ in straighten(walk, [RADIUS_M] * len(walk))]
    assert (line[0], line[-1]) == (walk[0], walk[-1])
    assert all(min(off_m(at, *leg) for leg in pairwise(line)) <= HALF_M + 1e-9 for at in walk)
    length_m = path_length_m(line)
    assert length_m <= path_length_m(walk) + 1e-9


@given(cell_walks())
def test_the_line_is_nowhere_further_from_the_plan_than_half_a_portal(walk: list[Point]) -> None:
    for start, end in pairwise(corner for corner, _ in straighten(walk, [RADIUS_M] * len(walk))):
        for share in (0.0, 0.25, 0.5, 0.75):
            at = Point(
                start.north_m + share * (end.north_m - start.north_m),
                start.east_m + share * (end.east_m - start.east_m),
            )
            assert min(off_m(at, *leg) for leg in pairwise(walk)) <= HALF_M + 1e-9


@given(cell_walks())
def test_each_corner_is_on_the_portal_of_its_waypoint_and_they_come_in_order(walk: list[Point]) -> None:
    found = straighten(walk, [RADIUS_M] * len(walk))
    assert all(distance_m(corner, walk[n]) <= HALF_M + 1e-9 for corner, n in found)
    assert all(one < other for (_, one), (_, other) in pairwise(found))


@given(st.lists(st.tuples(st.floats(-30.0, 30.0), st.floats(-30.0, 30.0)), min_size=2, max_size=20))
def test_any_places_give_a_line_from_the_first_to_the_last(places: list[tuple[float, float]]) -> None:
    line = corners(*places)
    assert (line[0], line[-1]) == (places[0], places[-1])
    assert len(line) <= len(places)


def turned_deg(degrees: float, leg_m: float = 4.0) -> tuple[float, float]:
    """The place a leg beyond (4, 0), after a turn to starboard."""
    turn = math.radians(degrees)
    return 4.0 + leg_m * math.cos(turn), leg_m * math.sin(turn)


@pytest.mark.parametrize(
    ("degrees", "off_m"), [(45.0, 0.9), (-45.0, 0.9), (31.0, 0.9), (29.0, 0.0), (99.0, 0.9), (101.0, 0.0)]
)
def test_a_corner_of_short_legs_is_shifted_to_the_inside_by_0_45_of_the_radius(
    degrees: float, off_m: float
) -> None:
    found = corners((0.0, 0.0), (4.0, 0.0), turned_deg(degrees))
    half = math.radians(degrees) / 2.0 + math.copysign(math.pi / 2.0, degrees)
    assert len(found) == 3
    assert found[1] == pytest.approx((4.0 + off_m * math.cos(half), off_m * math.sin(half)))


@pytest.mark.parametrize(("leg_m", "off_m"), [(1.0, 0.5), (1.7, 0.85), (1.9, 0.9), (5.9, 0.9), (6.1, 0.0)])
def test_the_shift_is_half_of_the_shorter_leg_at_most_and_none_at_legs_over_three_radii(
    leg_m: float, off_m: float
) -> None:
    for places in (
        [(0.0, 0.0), (5.5, 0.0), (5.5, leg_m), (5.5, leg_m + 20.0)],
        [(5.5, leg_m + 20.0), (5.5, leg_m), (5.5, 0.0), (0.0, 0.0)],
    ):
        at = next(corner for corner in corners(*places) if distance_m(corner, Point(5.5, 0.0)) < 1.0)
        assert distance_m(at, Point(5.5, 0.0)) == pytest.approx(off_m)


@pytest.mark.parametrize(("back_m", "is_left_out"), [(1.85, True), (1.95, False)])
def test_near_the_ends_a_place_is_left_out_within_0_95_of_its_radius(
    back_m: float, is_left_out: bool
) -> None:
    first = [(0.0, 0.0), (-back_m, 0.0), (20.0, 0.0)]
    last = [(0.0, 0.0), (20.0 + back_m, 0.0), (20.0, 0.0)]
    for places in (first, last):
        expected = [places[0], places[2]] if is_left_out else places
        assert corners(*places) == [Point(*at) for at in expected]


@pytest.mark.parametrize(("back_m", "is_left_out"), [(0.95, True), (1.05, False)])
def test_on_the_way_a_place_to_turn_back_at_is_left_out_within_half_of_its_radius(
    back_m: float, is_left_out: bool
) -> None:
    found = corners((0.0, 0.0), (20.0, 0.0), (20.0 + back_m, 0.0), (0.0, 30.0))
    assert (Point(20.0 + back_m, 0.0) not in found) is is_left_out
    assert Point(20.0, 0.0) in found


@pytest.mark.parametrize(("turns_deg", "at"), [((20.0, -20.0, 20.0, 20.0), 3), ((20.0, 20.0, -20.0), 2)])
def test_a_gentle_turn_is_a_bend_only_between_turns_to_its_own_side(
    turns_deg: tuple[float, ...], at: int
) -> None:
    places, course = [(0.0, 0.0), (4.0, 0.0)], 0.0
    for turn_deg in turns_deg:
        course += math.radians(turn_deg)
        north, east = places[-1]
        places.append((north + 4.0 * math.cos(course), east + 4.0 * math.sin(course)))
    assert Point(*places[at]) not in corners(*places)
