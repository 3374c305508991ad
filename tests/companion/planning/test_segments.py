"""Distances and sides of shores, against shapely."""

import math
import random
from itertools import pairwise

import pytest
import shapely
from shortest_route import random_lake

from benchmarks.planning import route_oracle as oracle
from companion.core.geo import Point
from companion.planning.water import Shore, Water


def square(half_m: float, north_m: float = 0.0, east_m: float = 0.0) -> Shore:
    corners = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    return Shore([Point(north_m + n * half_m, east_m + e * half_m) for n, e in corners])


@pytest.mark.parametrize("seed", range(8))
def test_distances_and_sides_are_shapelys(seed: int) -> None:
    rng = random.Random(seed)
    lake = random_lake(rng)
    water = Water(oracle.shores_of(lake))
    for _ in range(50):
        a, b = (Point(rng.uniform(-130, 130), rng.uniform(-130, 130)) for _ in range(2))
        leg = shapely.LineString([(a.east_m, a.north_m), (b.east_m, b.north_m)])
        distance_m = lake.boundary.distance(leg)
        assert water.leg_distance_m(a, b) == pytest.approx(distance_m, abs=1e-9)
        assert water.is_water(a) == lake.contains(shapely.Point(a.east_m, a.north_m))
        for clearance_m in (0.9 * distance_m, 1.1 * distance_m + 0.01):
            assert water.is_clear(a, b, clearance_m) == (distance_m >= max(clearance_m, 1e-6))


def test_a_shore_may_ask_for_a_clearance_of_its_own() -> None:
    island = Shore(square(10.0).corners, clearance_m=5.0)
    sea = Water([island, square(10.0, north_m=100.0)], is_open=True)
    along = Point(-50.0, 13.0), Point(50.0, 13.0)
    assert not sea.is_clear(*along, clearance_m=1.0)
    assert sea.is_clear(Point(-50.0, 15.0), Point(50.0, 15.0), clearance_m=1.0)
    farther = Point(90.0, 13.0), Point(150.0, 13.0)
    assert sea.is_clear(*farther, clearance_m=3.0)
    assert not sea.is_clear(*farther, clearance_m=3.1)
    route = sea.routes(1.0).route(Point(0.0, -30.0), Point(0.0, 30.0)).points
    alone = Water([square(10.0)], is_open=True)
    assert min(alone.leg_distance_m(a, b) for a, b in pairwise(route)) == pytest.approx(5.0, abs=1e-3)


def test_obstacles_may_overlap_the_shore_and_each_other() -> None:
    lake = Water([square(100.0)])
    blocked = lake.with_shores([square(10.0), square(10.0, 5.0, 5.0), square(10.0, 100.0, 0.0)])
    for north_m, east_m in ((0.0, 0.0), (2.0, 2.0), (12.0, 12.0), (95.0, 0.0), (105.0, 0.0)):
        assert not blocked.is_water(Point(north_m, east_m))
    assert lake.is_water(Point(2.0, 2.0))
    route = blocked.routes(2.0).route(Point(0.0, -50.0), Point(0.0, 50.0))
    assert route.length_m > lake.routes(2.0).route(Point(0.0, -50.0), Point(0.0, 50.0)).length_m
    assert blocked.with_shores([]) is blocked


def test_a_wall_is_rounded_at_its_end() -> None:
    lake = Water([square(100.0)]).with_shores([Shore([Point(-100.0, 0.0), Point(20.0, 0.0)])])
    route = lake.routes(3.0).route(Point(0.0, -30.0), Point(0.0, 30.0))
    leg_m = math.sqrt(30**2 + 20**2 - 3**2)
    turn_rad = math.pi - 2 * (math.atan2(30, 20) - (math.pi / 2 - math.acos(3 / math.hypot(30, 20))))
    assert route.length_m >= 2 * leg_m
    assert route.length_m == pytest.approx(2 * leg_m + 3 * abs(turn_rad), rel=5e-2)
    assert max(point.north_m for point in route.points) > 22.9
