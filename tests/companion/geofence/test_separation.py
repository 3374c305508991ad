"""What parts two places, against a search that looks everywhere."""

import math
import random
from itertools import pairwise

import pytest

from companion.core.geo import Point
from companion.geofence.separation import Separation
from companion.planning.visibility import NoWay
from companion.planning.water import Shore, Water

SQUARE = [Point(-50.0, -50.0), Point(-50.0, 50.0), Point(50.0, 50.0), Point(50.0, -50.0)]


def rings(draw: random.Random) -> list[list[Point]]:
    """A ragged water, with walls in it in every direction."""
    ragged = [
        Point(radius_m * math.cos(bearing), radius_m * math.sin(bearing))
        for bearing in (math.tau * number / 24.0 for number in range(24))
        for radius_m in (draw.uniform(25.0, 60.0),)
    ]
    walls = []
    for _ in range(draw.randint(1, 8)):
        north_m, east_m, bearing = draw.uniform(-40, 40), draw.uniform(-40, 40), draw.uniform(0.0, math.tau)
        along, across = draw.uniform(5.0, 45.0), draw.uniform(0.5, 3.0)
        sides = ((along, across), (-along, across), (-along, -across), (along, -across))
        walls.append(
            [
                Point(
                    north_m + a * math.cos(bearing) - b * math.sin(bearing),
                    east_m + a * math.sin(bearing) + b * math.cos(bearing),
                )
                for a, b in sides
            ]
        )
    return [ragged, *walls]


@pytest.mark.parametrize("seed", range(25))
def test_two_places_are_parted_where_a_search_finds_no_way(seed: int) -> None:
    draw = random.Random(seed)
    shores = rings(draw)
    water = Water([Shore(shores[0])]).with_shores([Shore(wall) for wall in shores[1:]])
    clearance_m = draw.choice([0.05, 1.0, 3.0])
    routes, separation = water.routes(clearance_m), Separation(shores, clearance_m)
    drawn = (Point(draw.uniform(-60.0, 60.0), draw.uniform(-60.0, 60.0)) for _ in range(400))
    free = [place for place in drawn if routes.is_free(place)][:8]
    for one, other in pairwise(free):
        try:
            routes.route(one, other)
            has_way = True
        except NoWay:
            has_way = False
        assert separation.parts(one, other) is not has_way
        assert separation.parts(other, one) is not has_way


@pytest.mark.parametrize(("gap_m", "is_parted"), [(6.01, False), (5.99, True)])
def test_a_gap_is_open_from_twice_the_clearance(gap_m: float, is_parted: bool) -> None:
    walls = [
        [Point(-1.0, west), Point(-1.0, east), Point(1.0, east), Point(1.0, west)]
        for west, east in ((-60.0, -0.5 * gap_m), (0.5 * gap_m, 60.0))
    ]
    separation = Separation([SQUARE, *walls], 3.0)
    assert separation.parts(Point(-20.0, 10.0), Point(20.0, -15.0)) is is_parted
    assert not separation.parts(Point(-20.0, 10.0), Point(-20.0, -15.0))


def test_inside_and_outside_of_one_ring_are_parted() -> None:
    separation = Separation([SQUARE], 1.0)
    assert separation.parts(Point(0.0, 0.0), Point(0.0, 60.0))
    assert not separation.parts(Point(0.0, 60.0), Point(0.0, -60.0)), "the line crosses the ring twice"
