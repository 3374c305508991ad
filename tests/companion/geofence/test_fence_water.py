"""The fence as water, and the shortest way through it: against the fence's own queries and exact lengths."""

import math
import random
from itertools import pairwise

import pytest
from fence_rig import box
from laid_fence import L_WATER, area, circle, laid, square

from companion.core.geo import Point, distance_m
from companion.geofence import water_route
from companion.geofence.fence import Fence
from companion.geofence.water_route import FenceWater, Way, way_to_nearest
from companion.planning.visibility import Routes

HOME = Point(0.0, 0.0)
MARGIN_M = 2.0


def way(fence: Fence, here: Point, *goals: Point, margin_m: float = MARGIN_M) -> Way | None:
    return way_to_nearest(fence, FenceWater(fence), here, goals or [HOME], margin_m)


FENCES = {
    "an L": laid(L_WATER),
    "an L and islands": laid(L_WATER, circle(0.0, 30.0, 4.0), square(5.0, False, north_m=60.0)),
    "a circle": laid(circle(5.0, 10.0, 60.0, is_inclusion=True), circle(20.0, 20.0, 10.0)),
    "two areas": laid(square(30.0), square(30.0, north_m=25.0)),
    "areas of every kind": laid(L_WATER, circle(30.0, 20.0, 55.0, is_inclusion=True), square(60.0)),
    "the open sea": laid(circle(20.0, 20.0, 10.0), square(8.0, False, north_m=-20.0)),
}


@pytest.mark.parametrize("name", FENCES)
def test_the_water_is_where_the_fence_allows_and_no_farther_from_its_lines(name: str) -> None:
    fence, places = FENCES[name], random.Random(1)
    water, seen = FenceWater(fence).water, set[bool]()
    for _ in range(300):
        point = Point(places.uniform(-90.0, 90.0), places.uniform(-90.0, 90.0))
        margin_m = fence.margin_m(point)
        if abs(margin_m) > 0.17:  # what the polygon of a circle may lie beside it
            assert water.is_water(point) is (margin_m > 0.0), point
            seen.add(margin_m > 0.0)
        if margin_m > 0.17:
            assert margin_m - 0.17 <= water.distance_m(point) <= margin_m + 1e-6
    assert seen == {True, False}


@pytest.mark.parametrize("radius_m", [3.0, 300.0])
@pytest.mark.parametrize("is_inclusion", [True, False])
def test_the_polygon_of_a_circle_keeps_the_circle(radius_m: float, is_inclusion: bool) -> None:
    water = FenceWater(laid(circle(0.0, 0.0, radius_m, is_inclusion=is_inclusion))).water
    side = -1.0 if is_inclusion else 1.0
    for number in range(180):
        bearing = math.pi * number / 90.0
        north, east = math.cos(bearing), math.sin(bearing)
        kept_m = radius_m - side * 1e-3
        assert not water.is_water(Point(kept_m * north, kept_m * east))
        free_m = radius_m + side * max(0.11, 0.0006 * radius_m)
        assert water.is_water(Point(free_m * north, free_m * east))


def test_round_the_corner_the_way_is_the_string_pulled_tight() -> None:
    # Tangents to the circle of the clearance about the corner, and its arc
    here, corner, clearance_m = Point(60.0, 60.0), Point(15.0, 45.0), 1.5 * MARGIN_M
    found = way(laid(L_WATER), here)
    assert found is not None
    sides = [math.sqrt(distance_m(end, corner) ** 2 - clearance_m**2) for end in (here, HOME)]
    bearings = [math.atan2(end.east_m - corner.east_m, end.north_m - corner.north_m) for end in (here, HOME)]
    apart = (bearings[1] - bearings[0]) % math.tau  # through the water, clockwise
    arc = apart - sum(math.acos(clearance_m / distance_m(end, corner)) for end in (here, HOME))
    assert found.length_m == pytest.approx(sum(sides) + clearance_m * arc, rel=2e-4)
    assert found.corners[-1] == HOME
    assert found.clearance_m == clearance_m
    legs = list(pairwise((here, *found.corners)))
    assert found.length_m == pytest.approx(sum(distance_m(one, other) for one, other in legs))
    assert all(laid(L_WATER).is_clear(one, other, 0.999 * clearance_m) for one, other in legs)


@pytest.mark.parametrize(("gap_m", "clearance_m"), [(6.1, 3.0), (5.9, 1.5), (2.9, 0.5), (0.9, None)])
def test_a_passage_is_taken_with_the_largest_clearance_that_fits(
    gap_m: float, clearance_m: float | None
) -> None:
    half_m = 0.5 * gap_m
    ends = [(half_m, 70.0), (-70.0, -half_m)]
    walls = [area(box(20.0, west, 24.0, east), is_inclusion=False) for west, east in ends]
    fence = laid(square(60.0), *walls)
    found = way(fence, Point(50.0, 10.0))
    assert (None if found is None else found.clearance_m) == clearance_m
    if found is not None:
        legs = pairwise((Point(50.0, 10.0), *found.corners))
        assert all(fence.is_clear(one, other, 0.999 * found.clearance_m) for one, other in legs)


@pytest.mark.parametrize("margin_m", [2.0, 0.0])
@pytest.mark.parametrize("here", [Point(14.0, -10.0), Point(-14.8, -14.8), Point(74.5, 46.0)])
def test_a_boat_near_a_line_leaves_it_straight_and_inside(here: Point, margin_m: float) -> None:
    fence = laid(L_WATER)
    for start, goal in ((here, Point(60.0, 60.0)), (Point(60.0, 60.0), here), (here, Point(-5.0, 0.5))):
        found = way(fence, start, goal, margin_m=margin_m)
        assert found is not None
        assert found.corners[-1] == goal
        assert found.clearance_m == max(1.5 * margin_m, 0.05)
        assert not any(fence.crosses(one, other) for one, other in pairwise((start, *found.corners)))


def test_of_several_goals_the_nearest_by_water_counts() -> None:
    fence = laid(L_WATER)
    behind, ahead = Point(10.0, 40.0), Point(60.0, 72.0)  # 22 m over land, and 28 m
    here = Point(30.0, 49.5)
    assert distance_m(here, behind) < distance_m(here, ahead)
    wall = area(box(20.0, 44.0, 22.0, 72.0), is_inclusion=False)
    for goals in ((behind, ahead), (ahead, behind)):
        found = way(laid(L_WATER, wall), here, *goals)
        assert found is not None
        assert found.corners[-1] == ahead
        straight = way(fence, here, *goals)
        assert straight is not None
        assert straight.corners[-1] == behind


def test_what_parts_the_water_is_found_out_one_clearance_a_call(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[float] = []
    monkeypatch.setattr(water_route, "Separation", lambda _, clearance_m: made.append(clearance_m))
    water = FenceWater(laid(L_WATER))
    for expected in ([3.0], [3.0, 1.5], [3.0, 1.5, 0.5], [3.0, 1.5, 0.5]):
        water.prepare(MARGIN_M)
        assert made == expected


def test_between_waters_that_do_not_meet_there_is_no_way_and_none_is_searched_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(Routes, "route", lambda *_: pytest.fail("a search that looks everywhere"))
    wall = area(box(40.0, -200.0, 50.0, 200.0), is_inclusion=False)
    assert way(laid(square(100.0), wall), Point(80.0, 0.0)) is None
    assert way(laid(square(30.0), square(30.0, north_m=200.0)), Point(0.0, 0.0)) is None
