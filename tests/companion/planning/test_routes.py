"""Shortest routes against brute force, their clearance, and what is said where there is none."""

import math
import random
from itertools import pairwise

import pytest
import shapely
from shortest_route import random_lake, shortest_route_m

from benchmarks.planning import route_oracle as oracle
from companion.core.geo import Point, distance_m, path_length_m
from companion.planning import visibility
from companion.planning.visibility import NoWay
from companion.planning.water import Shore, Water

pytestmark = pytest.mark.slow

CLEARANCES_M = (0.5, 1.0, 2.0, 4.0, 6.0)
SQUARE = [Point(-50.0, -50.0), Point(-50.0, 50.0), Point(50.0, 50.0), Point(50.0, -50.0)]


def blocked_pair(seed: int) -> tuple[oracle.Shape, float, Point, Point] | None:
    """A lake, a clearance, and two free points that see each other not, if there are any."""
    rng = random.Random(seed)
    lake, clearance_m = random_lake(rng), rng.choice(CLEARANCES_M)
    free = oracle.free_points(rng, lake, clearance_m, 8)
    pairs = [
        (a, b)
        for a in free
        for b in free
        if a < b
        and lake.boundary.distance(shapely.LineString([(a.east_m, a.north_m), (b.east_m, b.north_m)]))
        < clearance_m
    ]
    return (lake, clearance_m, *rng.choice(pairs)) if pairs else None


@pytest.mark.parametrize("first", [0, 6])
def test_routes_are_the_shortest_and_keep_their_clearance(first: int) -> None:
    for seed in range(first, first + 6):
        case = blocked_pair(seed)
        if case is None:
            continue
        lake, clearance_m, start, goal = case
        routes = Water(oracle.shores_of(lake)).routes(clearance_m)
        shortest_m = shortest_route_m(lake, clearance_m, start, goal)
        if math.isinf(shortest_m):
            with pytest.raises(NoWay):
                routes.route(start, goal)
            continue
        there, back = routes.route(start, goal), routes.route(goal, start)
        # The oracle's chords are up to 0.003 % short of its arcs
        assert -1e-6 <= there.length_m / shortest_m - 1.0 <= 1e-4 + 3e-5, f"seed {seed}"
        assert oracle.clearance_m(lake, there.points) >= clearance_m, f"seed {seed}"
        assert there.length_m == pytest.approx(path_length_m(there.points), abs=1e-9)
        assert back.length_m == pytest.approx(there.length_m, abs=1e-9)
        assert back.points == there.points[::-1]


def test_queries_do_not_depend_on_those_before_them() -> None:
    rng = random.Random(7)
    lake = random_lake(rng)
    shores = oracle.shores_of(lake)
    free = oracle.free_points(rng, lake, 1.0, 12)
    shared = Water(shores).routes(1.0)
    for a, b in pairwise([*free, *free]):
        try:
            fresh = Water(shores).routes(1.0).route(a, b)
        except NoWay:
            with pytest.raises(NoWay):
                shared.route(a, b)
        else:
            assert shared.route(a, b).points == fresh.points


def test_a_search_from_the_goal_that_ends_first_finds_the_same_route(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for seed in range(8):
        drawn = blocked_pair(seed)
        if drawn is None:
            continue
        lake, clearance_m, a, b = drawn
        lengths_m = []
        for turn, turn_back in ((64, 8), (1, 10_000)):
            monkeypatch.setattr(visibility, "TURN", turn)
            monkeypatch.setattr(visibility, "TURN_BACK", turn_back)
            try:
                route = Water(oracle.shores_of(lake)).routes(clearance_m).route(a, b)
            except NoWay:
                lengths_m.append(math.inf)
            else:
                assert (route.points[0], route.points[-1]) == (a, b)
                assert oracle.clearance_m(lake, route.points) >= clearance_m
                lengths_m.append(route.length_m)
        # legs about an arc are halved where there is no room, which differs from end to end
        assert lengths_m[0] == pytest.approx(lengths_m[1], rel=1e-4), f"seed {seed}"


def test_a_closed_cove_is_found_unconnected_without_a_search_of_the_lake() -> None:
    lake = [Point(0.0, 0.0), Point(0.0, 400.0), Point(400.0, 400.0), Point(400.0, 0.0)]
    cove = [Point(450.0, 450.0), Point(450.0, 480.0), Point(480.0, 480.0), Point(480.0, 450.0)]
    islands = [
        [Point(north_m + n, east_m + e) for n, e in ((0, 0), (9, 0), (9, 9), (0, 9))]
        for north_m in range(20, 380, 20)
        for east_m in range(20, 380, 20)
    ]
    routes = Water([Shore(ring) for ring in (lake, cove, *islands)]).routes(1.0)
    for ends in ((Point(10.0, 10.0), Point(465.0, 465.0)), (Point(465.0, 465.0), Point(10.0, 10.0))):
        with pytest.raises(NoWay, match="unconnected"):
            routes.route(*ends)
        assert routes._searches is not None
        assert sum(search.expanded for search in routes._searches) <= 100


def test_lengths_are_those_of_the_routes() -> None:
    lake = Water([square(100.0), square(40.0)])
    routes = lake.routes(2.0)
    here, goals = Point(0.0, -70.0), [Point(0.0, 70.0), Point(70.0, 0.0), Point(0.0, 0.0), Point(200.0, 0.0)]
    lengths_m = routes.lengths_m(here, goals)
    assert lengths_m[:2] == [routes.route(here, goal).length_m for goal in goals[:2]]
    assert lengths_m[2:] == [math.inf, math.inf]


def square(half_m: float) -> Shore:
    return Shore([Point(n * half_m, e * half_m) for n, e in ((-1, -1), (1, -1), (1, 1), (-1, 1))])


def channel(width_m: float, turn_rad: float = 0.0, half_m: float = 1000.0) -> Water:
    """Two basins joined by a straight channel 50 m long."""
    h, w = 0.5 * width_m, half_m
    outline = [(-w, -w / 2), (-25, -w / 2), (-25, -h), (25, -h), (25, -w / 2), (w, -w / 2)]
    outline += [(-x, -y) for x, y in outline]
    cos, sin = math.cos(turn_rad), math.sin(turn_rad)
    return Water([Shore([Point(x * sin + y * cos, x * cos - y * sin) for x, y in outline])])


@pytest.mark.parametrize("turn_deg", [0.0, 27.0])
@pytest.mark.parametrize("excess_m", [1e-5, 0.4])
def test_a_channel_that_is_wide_enough_is_found(turn_deg: float, excess_m: float) -> None:
    turn_rad = math.radians(turn_deg)
    water = channel(8.0 + excess_m, turn_rad)
    ends = [
        Point(
            x * math.sin(turn_rad) + y * math.cos(turn_rad), x * math.cos(turn_rad) - y * math.sin(turn_rad)
        )
        for x, y in ((-300.0, 90.0), (300.0, 40.0))
    ]
    route = water.routes(4.0).route(*ends)
    assert min(water.leg_distance_m(a, b) for a, b in pairwise(route.points)) >= 4.0
    assert route.length_m < 640.0


def test_a_start_or_goal_without_the_clearance_names_the_nearest_that_has_it() -> None:
    routes = Water([square(100.0), square(10.0)]).routes(4.0)
    free = Point(50.0, 50.0)
    for place, nearest in (
        (Point(0.0, 98.0), Point(0.0, 96.0)),
        (Point(99.0, 99.0), Point(96.0, 96.0)),
        (Point(0.0, 9.0), Point(0.0, 14.0)),
        (Point(10.0, 120.0), Point(10.0, 96.0)),
    ):
        for start, goal, reason in ((place, free, "start"), (free, place, "goal")):
            with pytest.raises(NoWay) as failure:
                routes.route(start, goal)
            assert failure.value.reason == reason
            assert failure.value.nearest is not None
            assert distance_m(failure.value.nearest, nearest) < 1e-5


@pytest.mark.parametrize("seed", range(6))
def test_no_free_water_is_nearer_than_the_first_exit(seed: int) -> None:
    rng = random.Random(seed)
    lake = random_lake(rng)
    routes = Water(oracle.shores_of(lake)).routes(3.0)
    free = lake.buffer(-3.0, quad_segs=64)
    if free.is_empty:
        return
    for _ in range(10):
        at = Point(rng.uniform(-100, 100), rng.uniform(-100, 100))
        if routes.is_free(at):
            continue
        first = next(routes.exits(at, is_afloat=False))
        assert routes.is_free(first)
        assert distance_m(at, first) <= free.distance(shapely.Point(at.east_m, at.north_m)) + 1e-3


def test_an_exit_for_a_boat_is_not_across_land() -> None:
    pier = Shore([Point(-100.0, 0.0), Point(90.0, 0.0), Point(90.0, 0.5), Point(-100.0, 0.5)])
    routes = Water([square(100.0)]).with_shores([pier]).routes(4.0)
    berth = Point(-50.0, -0.3)
    first = next(routes.exits(berth))
    assert first.east_m < 0.0
    assert distance_m(berth, first) == pytest.approx(3.7, abs=1e-5)
    away_m = [distance_m(berth, place) for place in routes.exits(berth, is_afloat=False)]
    assert len(away_m) > 3
    assert all(one < other for one, other in pairwise(away_m)), "each once, the nearest first"


@pytest.mark.parametrize("place", [Point(math.nan, 0.0), Point(0.0, math.inf)])
@pytest.mark.parametrize("is_open", [False, True])
def test_a_place_that_is_not_finite_is_refused_at_once(place: Point, is_open: bool) -> None:
    routes = Water([Shore(SQUARE)], is_open=is_open).routes(1.0)
    with pytest.raises(NoWay) as start:
        routes.route(place, Point(0.0, 0.0))
    assert (start.value.reason, start.value.nearest) == ("start", None)
    assert list(routes.exits(place)) == []
