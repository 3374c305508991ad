"""Parts of the planner by themselves: where offsets meet, and the open list."""

import math
from array import array
from itertools import pairwise
from random import Random

import pytest

from companion.core.geo import Point
from companion.planning.arcs import Arcs
from companion.planning.area_shores import outside_of
from companion.planning.areas import Ring
from companion.planning.exits import _Circle, _distance, _feet, _Line, _meetings
from companion.planning.segments import Segments
from companion.planning.tangent_search import TangentSearch
from companion.planning.tangents import Tangents
from companion.planning.view import View

ALONG = _Line(-5.0, 3.0, 1.0, 0.0, 10.0)  # ten metres east, at 3 m north
UP = _Line(2.0, 0.0, 0.0, 1.0, 8.0)
ROUND = _Circle(0.0, 0.0, 5.0)


@pytest.mark.parametrize(
    ("one", "other", "expected"),
    [
        (ALONG, UP, {(3.0, 2.0)}),
        (ALONG, UP._replace(length=2.9), set()),
        (ALONG, UP._replace(ay=3.1), set()),
        (ALONG, ALONG._replace(ay=4.0), set()),
        (ALONG, ROUND, {(3.0, -4.0), (3.0, 4.0)}),
        (ALONG._replace(length=5.0), ROUND, {(3.0, -4.0)}),
        (ALONG._replace(ay=5.1), ROUND, set()),
        (ROUND, _Circle(8.0, 0.0, 5.0), {(3.0, 4.0), (-3.0, 4.0)}),
        (ROUND, _Circle(0.0, -4.0, 3.0), {(-4.0, -3.0), (-4.0, 3.0)}),
        (ROUND, _Circle(10.1, 0.0, 5.0), set()),
        (ROUND, ROUND._replace(radius=1.0), set()),
    ],
)
def test_offsets_meet_where_both_are(
    one: _Line | _Circle, other: _Line | _Circle, expected: set[tuple[float, float]]
) -> None:
    for places in (_meetings(one, other), _meetings(other, one)):
        assert {(round(place.north_m, 9), round(place.east_m, 9)) for place in places} == expected
        for place in places:
            assert _distance(one, place.east_m, place.north_m) == pytest.approx(0.0, abs=1e-9)


def test_the_foot_is_the_nearest_point_of_an_offset() -> None:
    assert _feet(ALONG, 2.0, 9.0) == [Point(3.0, 2.0)]
    assert _feet(ALONG, 5.1, 9.0) == _feet(ALONG, -5.1, 9.0) == []
    (foot,) = _feet(ROUND, 3.0, 4.0)
    assert foot == pytest.approx((4.0, 3.0))
    (foot,) = _feet(ROUND, -0.6, 0.8)
    assert foot == pytest.approx((4.0, -3.0))
    assert [math.dist(place, (0.0, 0.0)) for place in _feet(ROUND, 0.0, 0.0)] == [5.0, 5.0]


@pytest.mark.parametrize(
    ("offset", "at", "expected_m"),
    [(ALONG, (2.0, 9.0), 6.0), (ALONG, (8.0, 7.0), 5.0), (ALONG, (-8.0, -1.0), 5.0), (ROUND, (3.0, 0.0), 2.0),
     (ROUND, (-6.0, 8.0), 5.0)],
)  # fmt: skip
def test_an_offset_is_as_far_as_its_nearest_point(
    offset: _Line | _Circle, at: tuple[float, float], expected_m: float
) -> None:
    assert _distance(offset, *at) == pytest.approx(expected_m)


@pytest.mark.parametrize("turn", range(4))
def test_the_line_of_a_ring_is_near_a_way_beside_the_middle_of_a_long_side(turn: int) -> None:
    def at(north_m: float, east_m: float) -> Point:
        for _ in range(turn):
            north_m, east_m = -east_m, north_m
        return Point(north_m, east_m)

    ring = Ring([at(-100.0, 0.0), at(100.0, 0.0), at(0.0, -100.0)], is_inclusion=True)
    way = at(-1.0, 1.0), at(1.0, 1.0)
    assert ring.is_near_way(*way, 1.1)
    assert not ring.is_near_way(*way, 0.9)


@pytest.mark.parametrize("step", [1, -1])
def test_a_frame_without_a_ring_is_one_ring_whichever_way_the_ring_turns(step: int) -> None:
    corners = [Point(0.0, 0.0), Point(10.0, 0.0), Point(10.0, 20.0), Point(0.0, 20.0)][::step]
    shore = outside_of(corners, (-50.0, -50.0, 50.0, 50.0)).corners
    twice_m2 = sum(a.east_m * b.north_m - b.east_m * a.north_m for a, b in pairwise([*shore, shore[0]]))
    assert abs(twice_m2) == pytest.approx(2.0 * (100.0 * 100.0 - 10.0 * 20.0))


def test_the_open_list_gives_its_entries_in_the_order_of_their_cost() -> None:
    ring = [(0.0, 0.0), (9.0, 0.0), (9.0, 9.0), (0.0, 9.0)]
    sides = [(*ring[at - 1], *ring[at]) for at in range(4)]
    segments = Segments(*(array("d", values) for values in zip(*sides, strict=True)))
    arcs = Arcs(segments, array("q", (1, 2, 3, 0)), array("q", (-1,) * 4), array("d", (1.0,) * 4))
    search, random, costs = TangentSearch(Tangents(arcs, View(arcs))), Random(1), []
    for number in range(700):  # more than it holds at first
        costs.append(random.uniform(0.0, 100.0))
        search._push(costs[-1], number, number + 1)
        if number % 3 == 0:
            least = min(range(len(costs)), key=costs.__getitem__)
            assert search._pop() == least
            costs[least] = math.inf
    while search.heap_size:
        least = min(range(len(costs)), key=costs.__getitem__)
        entry = search._pop()
        assert (entry, search.entry_from[entry], search.entry_edge[entry]) == (least, least, least + 1)
        costs[least] = math.inf
    assert min(costs) == math.inf


@pytest.mark.parametrize("turned", [0.0, 1.0, -2.0])
def test_an_arc_ends_where_another_shore_buries_it(turned: float) -> None:
    """Two squares of land 2 m apart, with a clearance of 2 m: the arcs between them are buried in part."""
    c, s = math.cos(turned), math.sin(turned)
    rings = [[(x, y), (x + 10.0, y), (x + 10.0, y + 10.0), (x, y + 10.0)] for x, y in ((0, 0), (12.0, 0.0))]
    rings = [[(x * c - y * s, x * s + y * c) for x, y in ring] for ring in rings]
    sides = [(*ring[at], *ring[(at + 1) % 4]) for ring in rings for at in range(4)]
    segments = Segments(*(array("d", values) for values in zip(*sides, strict=True)))
    following = array("q", [4 * (k // 4) + (k + 1) % 4 for k in range(8)])
    graph = Arcs(segments, following, array("q", (-1,) * 8), array("d", (2.0,) * 8))
    assert graph.count == 8
    for i in range(8):
        a_x, a_y, b_x, b_y = graph.a_x[i], graph.a_y[i], graph.b_x[i], graph.b_y[i]
        assert math.hypot(a_x, a_y) == pytest.approx(1.0)
        assert math.hypot(b_x, b_y) == pytest.approx(1.0)
        assert math.atan2(a_x * b_y - a_y * b_x, a_x * b_x + a_y * b_y) == pytest.approx(graph.width[i])
    # Two circles of 2 m whose centres are 2 m apart: 60° of a right angle are within the other one. What
    # is buried is looked for in pieces of at most 15°, and a piece that is free in part stays.
    widths = sorted(math.degrees(width) for width in graph.width[:8])
    assert all(30.0 <= width < 45.0 for width in widths[:4])
    assert widths[4:] == pytest.approx([90.0] * 4)
