"""The way home inside the fence as RTL sails it: straight, round the shore, to rally points, or none."""

import math
from itertools import pairwise

import pytest
from boat_rig import FRAME, nav_at, place
from fence_rig import box
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from laid_fence import L_WATER, area, circle, laid, square
from mode_inputs import around

from companion.config.boat_config import BoatConfig, with_value
from companion.config.tuning import FenceSetting
from companion.core.geo import LatLon, Point, distance_m
from companion.core.intent import FollowLeg, KeepStation
from companion.core.status_text import StatusText
from companion.geofence.fence import Fence
from companion.vehicle.return_route import ReturnRoute
from companion.vehicle.surroundings import Surroundings

HOME = Point(0.0, 0.0)


def way_home(fence: Fence, config: BoatConfig = BoatConfig(), rally: tuple[LatLon, ...] = ()) -> ReturnRoute:  # noqa: B008
    status_texts: list[StatusText] = []
    way = ReturnRoute(around(fence), status_texts)
    way.rally = rally
    home = FRAME.to_global(HOME)
    for _ in range(2):  # the goals, then the water
        way.prepare(FRAME, home, config)
    return way


def corners(way: ReturnRoute, start: Point) -> list[Point]:
    """Sail along without water or hull; where the boat turns, and where it ends."""
    way.restart()
    at, turns = start, [start]
    for tick in range(200):
        intent = way.update(nav_at(*at), BoatConfig(), 2.0, float(tick))
        if isinstance(intent, KeepStation):
            return turns
        assert isinstance(intent, FollowLeg)
        at = intent.end
        turns.append(at)
    raise AssertionError("never home")


@given(
    st.lists(st.tuples(st.floats(-80.0, 80.0), st.floats(-80.0, 80.0), st.floats(3.0, 25.0)), max_size=8),
    st.floats(-90.0, 90.0),
    st.floats(-90.0, 90.0),
)
@settings(max_examples=15, deadline=None)
def test_no_leg_of_the_way_leaves_the_fence(
    islands: list[tuple[float, float, float]], north_m: float, east_m: float
) -> None:
    circles = [circle(*island) for island in islands]
    fence = laid(square(100.0), *circles)
    start = Point(north_m, east_m)
    assume(fence.margin_m(HOME) > 3.5 and fence.margin_m(start) > 3.5)
    way = way_home(fence)
    turns = corners(way, start)
    for one, other in pairwise(turns):
        assert fence.is_clear(one, other, 1.0)
    if way.has_arrived:
        assert distance_m(turns[-1], HOME) <= BoatConfig().guidance.waypoint_radius_m
        length_m = sum(distance_m(one, other) for one, other in pairwise(turns))
        assert length_m <= way.home_distance_m(start) + 1e-6


def test_without_a_fence_the_way_is_straight_to_the_nearest_of_home_and_rally_points() -> None:
    rally = (place(100.0, 0.0), place(0.0, 90.0))
    way = way_home(laid(), rally=rally)
    assert corners(way, Point(80.0, 5.0)) == [Point(80.0, 5.0), pytest.approx((100.0, 0.0), abs=1e-3)]
    assert way.target == rally[0]
    assert corners(way, Point(10.0, 5.0))[-1] == pytest.approx(HOME, abs=1e-3)
    without = way_home(laid(), with_value(BoatConfig(), "fence.rally_includes_home", False), rally)
    assert corners(without, Point(10.0, 5.0))[-1] == pytest.approx((0.0, 90.0), abs=1e-3)


def test_of_rally_points_the_one_nearest_by_water_is_sailed_to() -> None:
    rally = (place(70.0, 70.0), place(0.0, 20.0))
    way = way_home(laid(L_WATER), rally=rally)
    turns = corners(way, Point(40.0, 60.0))
    assert turns[-1] == pytest.approx((70.0, 70.0), abs=1e-3)
    assert way.home_distance_m(Point(70.0, 60.0)) == pytest.approx(10.0, abs=0.2)
    assert len(corners(way_home(laid(L_WATER)), Point(60.0, 60.0))) <= 5, "it turns only at the corner"


def test_where_there_is_no_way_the_boat_stays_and_says_so() -> None:
    wall = area(box(40.0, -200.0, 50.0, 200.0), is_inclusion=False)
    status_texts: list[StatusText] = []
    way = ReturnRoute(around(laid(square(100.0), wall)), status_texts)
    start = Point(80.0, 0.0)
    way.restart()
    for tick in range(400):
        way.prepare(FRAME, FRAME.to_global(HOME), BoatConfig())
        assert isinstance(way.update(nav_at(*start), BoatConfig(), 2.0, tick * 0.5), KeepStation)
    assert [notice.text for notice in status_texts] == ["RTL: no way home inside the fence, keeping station"]
    assert math.isinf(way.home_distance_m(start))


def has_water(surroundings: Surroundings) -> bool:
    return surroundings.water is not None


def test_the_water_is_indexed_once_in_the_tick_after_a_change() -> None:
    fence, home = laid(L_WATER), FRAME.to_global(HOME)
    surroundings = around(fence)
    way = ReturnRoute(surroundings, [])
    way.prepare(FRAME, home, BoatConfig())
    assert not has_water(surroundings)
    assert way.home_distance_m(Point(60.0, 60.0)) == pytest.approx(math.hypot(60.0, 60.0))
    way.prepare(FRAME, home, BoatConfig())
    water = surroundings.water
    assert water is not None
    assert way.home_distance_m(Point(60.0, 60.0)) == pytest.approx(97.845, abs=0.01)
    for _ in range(3):  # another home is another goal in the same water
        way.prepare(FRAME, FRAME.to_global(Point(0.0, 60.0)), BoatConfig())
        assert surroundings.water is water
    assert way.home_distance_m(Point(0.0, 0.0)) == pytest.approx(60.0, abs=0.01)
    fence.set_areas([square(50.0)])
    fence.update(FRAME, None, FenceSetting())
    assert not has_water(surroundings), "that of another fence"
