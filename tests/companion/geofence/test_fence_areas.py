"""The fence's geometry against shapely's."""

import math
from collections.abc import Callable
from random import Random

import pytest
import shapely
from boat_rig import FRAME
from hypothesis import assume, given
from hypothesis import strategies as st
from laid_fence import laid, square

from companion.config.tuning import FenceSetting
from companion.core.geo import Point
from companion.planning.areas import Disc, Ring

COORDINATE = st.integers(-400, 400).map(lambda n: n / 4.0)
POINT = st.builds(Point, COORDINATE, COORDINATE)
ANGLE = st.floats(-math.pi, math.pi)


@st.composite
def stars(draw: Callable[[st.SearchStrategy[float]], float]) -> list[Point]:
    """Simple polygons: a radius for each of some bearings round a centre."""
    count = int(draw(st.integers(3, 60)))
    centre = Point(draw(COORDINATE), draw(COORDINATE))
    vertices = []
    for number in range(count):
        radius, bearing = draw(st.floats(5.0, 80.0)), math.tau * number / count
        north = centre.north_m + radius * math.cos(bearing)
        vertices.append(Point(north, centre.east_m + radius * math.sin(bearing)))
    return vertices


def shape_of(vertices: list[Point]) -> shapely.Polygon:
    return shapely.Polygon([(vertex.east_m, vertex.north_m) for vertex in vertices])


@given(stars(), POINT)
def test_a_ring_knows_inside_and_distance_as_shapely_does(vertices: list[Point], at: Point) -> None:
    ring, shape = Ring(vertices, is_inclusion=True), shape_of(vertices)
    where = shapely.Point(at.east_m, at.north_m)
    distance_m = shape.exterior.distance(where)
    assert ring.distance_m(*at) == pytest.approx(distance_m, abs=1e-9)
    assert ring.distance_m(*at, within_m=3.0) == pytest.approx(min(distance_m, 3.0), abs=1e-9)
    nearest = ring.nearest(*at)
    assert math.dist(nearest, at) == pytest.approx(distance_m, abs=1e-9)
    if distance_m > 1e-9:
        assert ring.contains(*at) is bool(shape.contains(where))


@given(stars(), POINT, ANGLE, st.floats(0.1, 300.0))
def test_a_ring_is_crossed_where_shapely_says(
    vertices: list[Point], at: Point, course_rad: float, reach_m: float
) -> None:
    ring, shape = Ring(vertices, is_inclusion=True), shape_of(vertices)
    where = shapely.Point(at.east_m, at.north_m)
    north, east = math.cos(course_rad), math.sin(course_rad)
    way = shapely.LineString(
        [(at.east_m, at.north_m), (at.east_m + reach_m * east, at.north_m + reach_m * north)]
    )
    touches = shapely.intersection(shape.exterior, way)
    expected = reach_m if touches.is_empty else shapely.distance(touches, where)
    # A way that only grazes the line crosses it or not, as rounding has it
    grazes = any(shapely.Point(v.east_m, v.north_m).distance(way) < 1e-6 for v in vertices)
    assume(not grazes and shape.exterior.distance(where) > 1e-6)
    assert ring.crossing_m(at, north, east, reach_m) == pytest.approx(expected, abs=1e-6)


@given(st.floats(0.5, 50.0), POINT, ANGLE, st.floats(0.1, 300.0))
def test_a_disc_is_crossed_on_its_circle_and_not_before(
    radius_m: float, at: Point, course_rad: float, reach_m: float
) -> None:
    disc = Disc(Point(3.0, -4.0), radius_m, is_inclusion=True)
    away_m = math.dist(at, disc.centre)
    assert disc.distance_m(*at) == pytest.approx(abs(away_m - radius_m), abs=1e-9)
    assert math.dist(disc.nearest(*at), disc.centre) == pytest.approx(radius_m)
    assert math.dist(disc.nearest(*at), at) == pytest.approx(abs(away_m - radius_m), abs=1e-9)
    north, east = math.cos(course_rad), math.sin(course_rad)
    room_m = disc.crossing_m(at, north, east, reach_m)
    assert 0.0 <= room_m <= reach_m
    if room_m < reach_m:
        there = Point(at.north_m + room_m * north, at.east_m + room_m * east)
        assert math.dist(there, disc.centre) == pytest.approx(radius_m, abs=1e-6)
    half = Point(at.north_m + 0.5 * room_m * north, at.east_m + 0.5 * room_m * east)
    if disc.distance_m(*at) > 1e-6 and disc.distance_m(*half) > 1e-6:
        assert disc.contains(*half) is disc.contains(*at)


def test_close_to_a_jagged_line_the_nearest_side_is_found_in_whichever_band_it_lies() -> None:
    random, vertices = Random(1), []
    for number in range(300):
        radius_m, bearing = random.uniform(48.0, 52.0), math.tau * number / 300
        vertices.append(Point(radius_m * math.cos(bearing), radius_m * math.sin(bearing)))
    ring, line = Ring(vertices, is_inclusion=True), shape_of(vertices).exterior
    for vertex in vertices:
        at = Point(vertex.north_m + random.uniform(-1.0, 1.0), vertex.east_m + random.uniform(-1.0, 1.0))
        assert ring.distance_m(*at) == pytest.approx(line.distance(shapely.Point(at.east_m, at.north_m)))


@pytest.mark.parametrize(("start", "end"), [
    ((0.0, 0.0), (4.0, 4.0)),  # as long again, the way would cross the line
    ((-8.0, 10.0), (0.0, 18.0)),  # crosses what would be the continuation of a side
])  # fmt: skip
def test_a_way_that_would_cross_a_side_only_if_one_were_longer_is_not_near(
    start: tuple[float, float], end: tuple[float, float]
) -> None:
    diamond = [Point(10.0, 0.0), Point(0.0, 10.0), Point(-10.0, 0.0), Point(0.0, -10.0)]
    ring = Ring(diamond, is_inclusion=True)
    assert not ring.is_near_way(Point(*start), Point(*end), 1.0)
    assert ring.is_near_way(Point(*start), Point(2.0 * end[0], 2.0 * end[1]), 1.0) is (start == (0.0, 0.0))


def test_a_point_level_with_a_vertex_is_judged_like_any_other() -> None:
    corners = [(10.0, 0.0), (9.755282581475768, 1.545084971874737), (4.045084971874737, 25.67), (5.0, 8.0)]
    ring = Ring([Point(*corner) for corner in [*corners, (-3.0, 4.0), (5.0, -6.0)]], is_inclusion=True)
    shape = shape_of([Point(*corner) for corner in [*corners, (-3.0, 4.0), (5.0, -6.0)]])
    for north_m, _ in corners:
        for quarter in range(-40, 120):
            at = Point(north_m, quarter / 4.0)
            where = shapely.Point(at.east_m, at.north_m)
            if shape.exterior.distance(where) > 1e-9:
                assert ring.contains(*at) is bool(shape.contains(where))


def test_a_ring_of_two_vertices_and_a_disc_of_no_radius_are_refused() -> None:
    with pytest.raises(ValueError, match="2 vertices"):
        Ring([Point(0.0, 0.0), Point(1.0, 0.0)], is_inclusion=True)
    for radius_m in (0.0, -1.0, math.inf, math.nan):
        with pytest.raises(ValueError, match="radius"):
            Disc(Point(0.0, 0.0), radius_m, is_inclusion=True)


# The fence as a whole


def test_the_circle_round_home_counts_when_it_is_asked_for() -> None:
    home = FRAME.to_global(Point(100.0, 0.0))
    asked = laid(setting=FenceSetting(kinds=2, radius_m=30.0), home=home)
    assert asked.margin_m(Point(80.0, 0.0)) == pytest.approx(10.0, abs=0.01)
    assert not laid(square(10.0), setting=FenceSetting(kinds=2)).is_active
    assert not laid(square(10.0), setting=FenceSetting(enabled=False), home=home).is_active


@given(st.lists(POINT, min_size=2, max_size=30), ANGLE, st.floats(0.5, 30.0))
def test_what_is_remembered_changes_no_answer(track: list[Point], course_rad: float, reach_m: float) -> None:
    areas = (square(60.0), square(9.0, is_inclusion=False, north_m=20.0))
    asked_often = laid(*areas)
    for at in track:
        fresh = laid(*areas)
        assert asked_often.room_m(at, course_rad, reach_m) == fresh.room_m(at, course_rad, reach_m)
        assert asked_often.is_outside(at) is (fresh.margin_m(at) < 0.0)
        assert asked_often.is_near(at, reach_m) or fresh.margin_m(at) >= reach_m
