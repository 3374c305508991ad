"""The route through the water: its legs go straight to the farthest corner in sight."""

import pytest
from boat_rig import nav_at
from laid_fence import L_WATER, laid, square
from mode_inputs import around

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point, path_length_m
from companion.geofence.fence import Fence
from companion.geofence.water_route import WaterRoute, Way, is_clear

CONFIG = BoatConfig()
HOME = Point(0.0, 0.0)


def along(fence: Fence, start: Point, corners: list[Point], clearance_m: float) -> WaterRoute:
    """The route along corners that keep a clearance from a fence."""
    way = Way(tuple(corners), path_length_m((start, *corners)), clearance_m)
    return WaterRoute(around(fence).is_clear, start, way, CONFIG)


def sailed(route: WaterRoute) -> list[Point]:
    """The ends of its legs, reached one after the other."""
    ends = []
    for _ in range(100):
        ends.append(route.leg.end)
        assert route.is_last is (route.leg.end == route.end)
        if route.advance(nav_at(*route.leg.end), CONFIG):
            return ends
    raise AssertionError("the end is never reached")


def row(*norths: float) -> list[Point]:
    return [Point(north_m, 0.0) for north_m in norths]


@pytest.mark.parametrize("count", [1, 2, 9])
def test_corners_in_a_straight_line_are_one_leg(count: int) -> None:
    corners = row(*range(-40, -40 + 2 * count, 2))
    route = along(laid(square(50.0)), Point(-45.0, 0.0), corners, 2.0)
    assert sailed(route) == [corners[-1]]
    assert route.leg.start == Point(-45.0, 0.0)
    assert route.leg.next_end is None


@pytest.mark.parametrize("before", [1, 2, 7])
def test_the_leg_ends_at_the_last_corner_in_sight_however_many_there_are(before: int) -> None:
    # East along the wide part, then south: the corner of the water hides everything beyond the bend
    east = [Point(60.0, 70.0 - number) for number in range(before)]
    bend = Point(60.0, 70.0 - before)
    south = [Point(60.0 - number, 0.0) for number in range(0, 55, 5)]
    fence, start, corners = laid(L_WATER), Point(60.0, 72.0), [*east, bend, *south]
    route = along(fence, start, corners, 3.0)
    visible = [corner for corner in corners if is_clear(fence, start, corner, 3.0)]
    assert route.leg.end == visible[-1]


def test_the_next_leg_and_the_radius_of_a_corner_are_known_to_the_leg() -> None:
    corners = [Point(60.0, 60.0), Point(12.0, 48.0), Point(0.0, 40.0), HOME]
    route = along(laid(L_WATER), Point(70.0, 60.0), corners, 3.0)
    assert route.leg.next_end is not None
    assert route.leg.radius_m == 1.5, "half of the clearance, where that is less than the configured 2 m"
    wide = along(laid(L_WATER), Point(70.0, 60.0), corners, 5.0)
    assert wide.leg.radius_m == 2.0
    ends = sailed(route)
    assert ends[-1] == HOME
    assert route.end == HOME


@pytest.mark.parametrize(
    ("start", "end", "is_seen"),
    [
        (Point(0.0, -40.0), Point(0.0, 40.0), True),
        (Point(45.5, -40.0), Point(45.5, 40.0), True),
        (Point(48.0, -40.0), Point(48.0, 40.0), True),  # as near as its ends are
        (Point(51.0, -40.0), Point(0.0, 40.0), False),
        (Point(0.0, -40.0), Point(51.0, 40.0), False),
    ],
)
def test_a_leg_keeps_the_clearance_of_its_ends(start: Point, end: Point, is_seen: bool) -> None:
    assert is_clear(laid(square(50.0)), start, end, 5.0) is is_seen
