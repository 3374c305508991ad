"""The fence's answers, by hand-calculated geometry and against brute force over its areas."""

import math

import pytest
import shapely
from boat_rig import FRAME, place
from hypothesis import assume, given
from hypothesis import strategies as st
from laid_fence import circle, laid, square
from test_fence_areas import ANGLE, POINT, shape_of, stars

from companion.config.tuning import FenceSetting
from companion.core.geo import LatLon, LocalFrame, Point
from companion.geofence.fence import Fence
from companion.planning.areas import Disc, Ring

ISLAND = circle(20.0, 0.0, 5.0)
HOME = place(100.0, 0.0)


def test_the_allowed_water_is_inside_the_inclusion_and_outside_the_exclusion() -> None:
    fence = laid(square(50.0), ISLAND)
    where = {(0.0, 0.0): True, (49.0, 49.0): True, (51.0, 0.0): False, (20.0, 1.0): False, (26.0, 0.0): True}
    for point, is_allowed in where.items():
        assert fence.allows(Point(*point)) is is_allowed
        assert fence.is_outside(Point(*point)) is not is_allowed
        fence.margin_m(Point(*point))
        assert fence.is_outside(Point(*point)) is not is_allowed, "as remembered"


def test_what_was_uploaded_is_kept_and_counts_from_the_next_update() -> None:
    fence = Fence()
    assert fence.version == 0
    fence.set_areas([square(50.0)])
    assert fence.uploaded == (square(50.0),)
    setting = FenceSetting()
    assert fence.margin_m(Point(0.0, 0.0)) == math.inf
    fence.update(FRAME, None, setting)
    assert fence.is_active
    assert fence.version == 1
    fence.update(FRAME, HOME, setting)
    assert fence.version == 1, "nothing that counts has changed"


def test_every_change_of_the_lines_makes_a_new_version() -> None:
    fence, setting = Fence(), FenceSetting(kinds=6)
    fence.set_areas([square(50.0)])
    frames = [FRAME, FRAME, LocalFrame(LatLon(50.0, -1.2)), FRAME, FRAME]
    homes = [HOME, LatLon(50.0, -1.2), None, None, None]
    settings = [setting, setting, setting, FenceSetting(kinds=4), setting]
    for version, (frame, home, one) in enumerate(zip(frames, homes, settings, strict=True), 1):
        fence.update(frame, home, one)
        assert fence.version == version
    fence.set_areas([square(40.0)])
    fence.update(FRAME, None, setting)
    assert fence.version == 6


def test_without_a_frame_or_a_home_or_permission_there_are_no_lines() -> None:
    fence = Fence()
    fence.set_areas([square(50.0)])
    fence.update(None, HOME, FenceSetting())
    assert not fence.is_active
    assert not laid(square(50.0), setting=FenceSetting(enabled=False)).is_active
    assert not laid(setting=FenceSetting(kinds=2)).is_active
    assert len(laid(square(50.0), setting=FenceSetting(kinds=6), home=HOME).areas) == 2
    assert isinstance(laid(square(50.0), setting=FenceSetting(kinds=2), home=HOME).areas[0], Disc)
    assert isinstance(laid(square(50.0), setting=FenceSetting(kinds=4), home=HOME).areas[0], Ring)


@given(POINT, st.floats(0.1, 40.0))
def test_a_margin_with_a_limit_is_the_margin_up_to_the_limit(point: Point, limit_m: float) -> None:
    fence = laid(square(50.0), ISLAND, square(8.0, is_inclusion=False, north_m=-20.0))
    margin_m = fence.margin_m(point)
    assert fence.margin_within_m(*point, limit_m) == pytest.approx(max(min(margin_m, limit_m), -limit_m))


@given(st.lists(POINT, min_size=1, max_size=6), st.floats(0.5, 20.0))
def test_near_is_never_denied_wrongly_and_seldom_said_wrongly(track: list[Point], reach_m: float) -> None:
    fence = laid(square(50.0), ISLAND)
    for point in track:
        margin_m = laid(square(50.0), ISLAND).margin_m(point)
        is_near = fence.is_near(point, reach_m)
        assert is_near or margin_m >= reach_m
        assert not is_near or margin_m < reach_m + 1.0, "a metre is what the memory may be off"


@pytest.mark.parametrize(("course_deg", "room_m"), [(170.0, 20.0), (100.0, 20.0), (80.0, 0.0), (-80.0, 0.0)])
def test_beyond_a_line_room_is_where_the_line_comes_nearer(course_deg: float, room_m: float) -> None:
    fence = laid(square(50.0))
    for outside in (Point(52.0, 3.0), Point(52.0, -3.0)):
        assert fence.room_m(outside, math.radians(course_deg), 20.0) == room_m
    east = Point(3.0, 52.0)
    assert fence.room_m(east, math.radians(course_deg + 90.0), 20.0) == room_m


def way_of(start: Point, end: Point) -> shapely.LineString:
    return shapely.LineString([(start.east_m, start.north_m), (end.east_m, end.north_m)])


def disc_gap_m(centre: Point, radius_m: float, start: Point, end: Point) -> float:
    """From a circle to a straight way: distances from the centre take every value between these two."""
    nearest_m = way_of(start, end).distance(shapely.Point(centre.east_m, centre.north_m))
    farthest_m = max(math.dist(centre, start), math.dist(centre, end))
    return float(max(nearest_m - radius_m, radius_m - farthest_m, 0.0))


@given(POINT, POINT)
def test_a_way_is_clear_where_it_keeps_the_margin_from_every_line(start: Point, end: Point) -> None:
    fence = laid(square(50.0), ISLAND)
    box = shapely.box(-50.0, -50.0, 50.0, 50.0).exterior.distance(way_of(start, end))
    gap_m = min(box, disc_gap_m(Point(20.0, 0.0), 5.0, start, end))
    assume(abs(gap_m - 3.0) > 0.01)
    assert fence.is_clear(start, end, 3.0) is (gap_m > 3.0)


@given(stars(), POINT, POINT, st.floats(0.5, 20.0))
def test_a_ring_is_as_near_to_a_way_as_shapely_says(
    vertices: list[Point], start: Point, end: Point, within_m: float
) -> None:
    gap_m = shape_of(vertices).exterior.distance(way_of(start, end))
    assume(abs(gap_m - within_m) > 1e-6)
    assert Ring(vertices, is_inclusion=True).is_near_way(start, end, within_m) is (gap_m < within_m)


@given(st.floats(2.0, 40.0), POINT, POINT, st.floats(0.5, 20.0))
def test_a_disc_is_as_near_to_a_way_as_its_centre_says(
    radius_m: float, start: Point, end: Point, within_m: float
) -> None:
    disc = Disc(Point(3.0, -4.0), radius_m, is_inclusion=True)
    gap_m = disc_gap_m(disc.centre, radius_m, start, end)
    assume(abs(gap_m - within_m) > 1e-6)
    assert disc.is_near_way(start, end, within_m) is (gap_m < within_m)


@given(POINT, ANGLE, st.floats(1.0, 80.0))
def test_a_way_crosses_where_there_is_less_room_than_its_length(
    start: Point, course_rad: float, length_m: float
) -> None:
    fence = laid(square(50.0), ISLAND)
    assume(fence.margin_m(start) > 0.5)
    end = Point(
        start.north_m + length_m * math.cos(course_rad), start.east_m + length_m * math.sin(course_rad)
    )
    assume(abs(fence.margin_m(end)) > 0.01)
    room_m = fence.room_m(start, course_rad, 200.0)
    assert fence.crosses(start, end) is (room_m < length_m)


WATER = (square(100.0), square(10.0, is_inclusion=False), circle(60.0, 40.0, 8.0))


@given(POINT, st.floats(0.0, 5.0))
def test_the_nearest_water_has_the_margin_that_was_asked_for(point: Point, margin_m: float) -> None:
    fence = laid(*WATER)
    found = fence.inside(point, margin_m)
    assert fence.margin_m(found) >= margin_m - 1e-6
    if fence.margin_m(point) >= margin_m:
        assert found == point
    assert laid().inside(point, margin_m) == point


def test_a_margin_that_is_remembered_says_nothing_of_a_place_far_away() -> None:
    for far in (Point(-30.0, 0.0), Point(0.0, -70.0)):
        fence = laid(square(50.0, north_m=40.0))  # from 10 m south to 90 m north
        fence.margin_m(Point(-far.north_m, -far.east_m / 2.0))
        assert fence.is_near(far, 5.0)
        fence.margin_m(Point(-far.north_m, -far.east_m / 2.0))
        assert fence.is_outside(far)


@pytest.mark.parametrize(
    ("margin_m", "at", "expected"),
    [
        (4.0, (49.0, 10.0), (46.0, 10.0)),
        (4.0, (-48.0, 47.0), (-46.0, 46.0)),
        (10.0, (0.0, 52.0), (0.0, 40.0)),
        (4.0, (30.0, 30.0), (30.0, 30.0)),
    ],
)
def test_the_nearest_place_inside_a_square_is_its_projection(
    margin_m: float, at: tuple[float, float], expected: tuple[float, float]
) -> None:
    fence = laid(square(50.0))
    found = fence.inside(Point(*at), margin_m)
    assert found == pytest.approx(expected, abs=0.02)
    assert fence.margin_m(found) >= margin_m
    around = laid(ISLAND).inside(Point(20.0 + at[0] / 14.0, at[1] / 14.0), 2.0)
    assert math.dist(around, (20.0, 0.0)) == pytest.approx(7.0, abs=0.02), "straight away from an island"


def test_the_owner_knows_the_water_inside_an_uploaded_inclusion_only() -> None:
    within, beyond = Point(0.0, 0.0), Point(60.0, 0.0)
    fence = laid(square(50.0))
    assert fence.is_charted(within) is True
    assert fence.is_charted(beyond) is False
    assert laid(ISLAND).is_charted(within) is False, "an exclusion says nothing of the rest"
    assert laid(ISLAND, square(50.0)).is_charted(within) is True
    home = laid(setting=FenceSetting(kinds=2), home=HOME)
    assert home.is_charted(Point(100.0, 0.0)) is False, "nor does the circle around home"
    assert Fence().is_charted(within) is False
    fence.set_areas([])
    fence.update(FRAME, None, FenceSetting())
    assert fence.is_charted(within) is False
