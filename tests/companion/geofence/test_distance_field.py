"""The way home over the fence's free water: distances, ways, and what it costs a tick."""

import math
from itertools import pairwise

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from test_fence_lines import FRAME, globe, laid, square

from companion.config.boat_config import BoatConfig, with_value
from companion.core.geo import LatLon, Point, distance_m
from companion.core.intent import FollowLeg, KeepStation
from companion.core.state import NavState
from companion.core.status_text import StatusText
from companion.geofence.costmap import Costmap
from companion.geofence.distance_field import DistanceField
from companion.geofence.fence import Fence, FenceCircle, FencePolygon
from companion.vehicle.return_route import ReturnRoute

L_CORNERS = [(-15.0, -15.0), (-15.0, 75.0), (75.0, 75.0), (75.0, 45.0), (15.0, 45.0), (15.0, -15.0)]
L_WATER = FencePolygon(globe(L_CORNERS), is_inclusion=True)
HOME = Point(0.0, 0.0)


def field_of(fence: Fence, *goals: Point, clearance_m: float = 3.0) -> DistanceField:
    field = DistanceField(fence, goals, Costmap(fence, goals, clearance_m))
    for _ in range(5000):
        if field.is_complete:
            return field
        field.advance()
    raise AssertionError("the field is never complete")


def way_home(fence: Fence, config: BoatConfig = BoatConfig(), rally: tuple[LatLon, ...] = ()) -> ReturnRoute:  # noqa: B008
    status_texts: list[StatusText] = []
    way = ReturnRoute(fence, status_texts)
    way.rally = rally
    home = FRAME.to_global(HOME)
    for _ in range(2000):
        way.prepare(FRAME, home, config, nav_at(HOME))
        if way.is_ready:
            break
    return way


def nav_at(point: Point) -> NavState:
    return NavState(0.0, *point, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def corners(way: ReturnRoute, start: Point) -> list[Point]:
    """Sail along without water or hull; where the boat turns, and where it ends."""
    way.restart()
    at, turns = start, [start]
    for tick in range(200):
        intent = way.update(nav_at(at), BoatConfig(), 2.0, float(tick))
        if isinstance(intent, KeepStation):
            return turns
        assert isinstance(intent, FollowLeg)
        at = intent.end
        turns.append(at)
    raise AssertionError("never home")


@given(st.floats(-300.0, 300.0), st.floats(-300.0, 300.0))
@settings(max_examples=30)
def test_in_open_water_the_distance_is_the_straight_line(north_m: float, east_m: float) -> None:
    point = Point(north_m, east_m)
    straight_m = distance_m(point, HOME)
    assert OPEN.distance_m(point) == pytest.approx(straight_m, rel=0.04, abs=2.0 * OPEN.grid.cell_m)


OPEN = field_of(laid(square(400.0)), HOME)


def test_round_the_corner_it_is_the_string_pulled_tight_to_four_percent() -> None:
    fence = laid(L_WATER)
    point, corner = Point(60.0, 60.0), Point(15.0 - 3.0 / math.sqrt(2.0), 45.0 + 3.0 / math.sqrt(2.0))
    tight_m = distance_m(point, corner) + distance_m(corner, HOME)
    assert field_of(fence, HOME).distance_m(point) == pytest.approx(tight_m, rel=0.04)
    assert way_home(fence).home_distance_m(point) == pytest.approx(tight_m, rel=0.04)


def test_no_free_cell_is_nearer_to_a_line_than_the_clearance() -> None:
    fence = laid(L_WATER, FenceCircle(globe([(0.0, 30.0)])[0], 4.0, is_inclusion=False))
    grid = field_of(fence, HOME).grid
    frees = [grid.centre(cell) for cell in range(len(grid.free)) if grid.free[cell]]
    assert len(frees) > 1000
    assert min(fence.margin_m(point) for point in frees) >= grid.clearance_m
    missed = [
        cell
        for cell in range(len(grid.free))
        if not grid.free[cell] and fence.margin_m(grid.centre(cell)) > grid.clearance_m + 1e-9
    ]
    assert not missed


@given(
    st.lists(st.tuples(st.floats(-80.0, 80.0), st.floats(-80.0, 80.0), st.floats(3.0, 25.0)), max_size=8),
    st.floats(-90.0, 90.0),
    st.floats(-90.0, 90.0),
)
@settings(max_examples=15, deadline=None)
def test_no_leg_of_the_way_leaves_the_fence(
    islands: list[tuple[float, float, float]], north_m: float, east_m: float
) -> None:
    circles = [FenceCircle(globe([(n, e)])[0], r, is_inclusion=False) for n, e, r in islands]
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
        assert length_m <= 1.05 * way.home_distance_m(start) + 3.0


def test_the_way_turns_only_at_the_corner() -> None:
    assert len(corners(way_home(laid(L_WATER)), Point(60.0, 60.0))) <= 4


def test_without_a_fence_the_way_is_straight_to_the_nearest_of_home_and_rally_points() -> None:
    rally = globe([(100.0, 0.0), (0.0, 90.0)])
    way = way_home(laid(), rally=rally)
    assert corners(way, Point(80.0, 5.0)) == [Point(80.0, 5.0), pytest.approx((100.0, 0.0), abs=1e-3)]
    assert way.target == rally[0]
    assert corners(way, Point(10.0, 5.0))[-1] == pytest.approx(HOME, abs=1e-3)
    without = way_home(laid(), with_value(BoatConfig(), "fence.rally_includes_home", False), rally)
    assert corners(without, Point(10.0, 5.0))[-1] == pytest.approx((0.0, 90.0), abs=1e-3)


def test_a_passage_too_narrow_for_the_clearance_is_taken_with_less() -> None:
    centres = globe([(20.0, east_m) for east_m in (-56.0, -28.0, 0.0, 28.0, 56.0)])
    fence = laid(square(60.0), *[FenceCircle(centre, 12.0, is_inclusion=False) for centre in centres])
    way = way_home(fence)
    start = Point(50.0, 10.0)
    assert math.isinf(field_of(fence, HOME).distance_m(start))
    way.restart()
    for tick in range(3000):
        way.prepare(FRAME, FRAME.to_global(HOME), BoatConfig(), nav_at(start))
        intent = way.update(nav_at(start), BoatConfig(), 2.0, tick * 0.02)
        if isinstance(intent, FollowLeg):
            return
    raise AssertionError("no way was found")


def test_where_there_is_no_way_the_boat_stays_and_says_so() -> None:
    wall = FencePolygon(globe([(40.0, -200.0), (40.0, 200.0), (50.0, 200.0), (50.0, -200.0)]), False)
    status_texts: list[StatusText] = []
    way = ReturnRoute(laid(square(100.0), wall), status_texts)
    start = Point(80.0, 0.0)
    way.restart()
    for tick in range(1500):
        way.prepare(FRAME, FRAME.to_global(HOME), BoatConfig(), nav_at(start))
        assert isinstance(way.update(nav_at(start), BoatConfig(), 2.0, tick * 0.5), KeepStation)
    assert [notice.text for notice in status_texts] == ["RTL: no way home inside the fence, keeping station"]
    assert math.isinf(way.home_distance_m(start))


def test_a_boat_outside_comes_back_by_the_nearest_water() -> None:
    turns = corners(way_home(laid(L_WATER)), Point(60.0, 30.0))
    assert turns[1] == pytest.approx((60.0, 48.0), abs=0.5)
    assert turns[-1] == pytest.approx(HOME, abs=1e-6)


def test_one_step_of_the_work_is_small_even_for_a_thousand_vertices() -> None:
    ring = [
        (300.0 + 40.0 * math.sin(7.0 * a), a) for a in (math.tau * number / 1000.0 for number in range(1000))
    ]
    fence = laid(FencePolygon(globe([(r * math.cos(a), r * math.sin(a)) for r, a in ring]), True))
    grid = Costmap(fence, [HOME], 3.0)
    field = DistanceField(fence, [HOME], grid)
    assert sum(1 for cell in grid.free if cell) == 0
    steps = 0
    while not field.is_complete:
        field.advance()
        steps += 1
    assert 100 < steps < 1500  # of a fraction of a millisecond each: half a minute at the most
    assert sum(grid.free) < 20_000
