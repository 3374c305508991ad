"""What a view leaves out is barred, and it leaves out most of what is."""

import gc
import math
import weakref
from array import array
from random import Random

import pytest

from companion.core.geo import Point
from companion.planning.arcs import Arcs
from companion.planning.segments import Segments
from companion.planning.tangent_search import TangentSearch
from companion.planning.tangents import MOST_TANGENTS, Tangents
from companion.planning.view import View
from companion.planning.water import Shore, Water

POINT = -1


class Glass(View):
    """Shores hide nothing."""

    def _hide(self, block: int) -> None:
        """Leave every beam as it is."""


def archipelago(seed: int, clearance_m: float) -> Arcs:
    """A basin with islands of up to 70 corners, some of them walls."""
    random = Random(seed)
    rings = [([(-900.0, -900.0), (-900.0, 900.0), (900.0, 900.0), (900.0, -900.0)], -1)]
    for _ in range(14):
        x, y, size = random.uniform(-800, 800), random.uniform(-800, 800), random.uniform(5.0, 250.0)
        corners = random.choice((2, 5, 20, 70))
        turns = [math.tau * n / corners for n in range(corners)]
        lengths = [size * random.uniform(0.6, 1.0) for _ in turns]
        island = [(x + r * math.cos(a), y + r * math.sin(a)) for r, a in zip(lengths, turns, strict=True)]
        rings.append((island, 0 if corners == 2 else -1))
    sides: list[tuple[float, ...]] = []
    following: list[int] = []
    left: list[int] = []
    for ring, water_side in rings:
        first = len(sides)
        sides += [(*ring[n], *ring[(n + 1) % len(ring)]) for n in range(len(ring))]
        following += [*range(first + 1, first + len(ring)), first]
        left += [water_side] * len(ring)
    segments = Segments(*(array("d", values) for values in zip(*sides, strict=True)))
    return Arcs(segments, array("q", following), array("q", left), array("d", [clearance_m] * len(sides)))


def fan(arcs: Arcs, view: View, node: int, x: float, y: float) -> set[tuple[int, float]]:
    """The tangents of a node or point as targets and lengths."""
    tangents = Tangents(arcs, view)
    first = tangents.fan_of(node, x, y)
    return {(tangents.target[n], tangents.length[n]) for n in range(first, tangents.count)}


def clear(arcs: Arcs, node: int, x: float, y: float) -> set[tuple[int, float]]:
    """Those that no shore bars, of all that there are."""
    tangents = Tangents(arcs, Glass(arcs))
    first = tangents.fan_of(node, x, y)
    return {
        (tangents.target[n], tangents.length[n])
        for n in range(first, tangents.count)
        if arcs.segments.is_clear(
            tangents.begin_x[n], tangents.begin_y[n], tangents.end_x[n], tangents.end_y[n],
            arcs.limit2, arcs.reach,
        )
    }  # fmt: skip


@pytest.mark.parametrize("clearance_m", [1e-6, 3.0, 30.0])
@pytest.mark.parametrize("seed", range(3))
def test_every_clear_tangent_is_in_the_fan(seed: int, clearance_m: float) -> None:
    arcs, random = archipelago(seed, clearance_m), Random(seed)
    view = View(arcs)
    nodes = [random.randrange(2 * arcs.count) for _ in range(60)]
    places = [(node, 0.0, 0.0) for node in nodes]
    places += [(POINT, random.uniform(-900, 900), random.uniform(-900, 900)) for _ in range(20)]
    seen = joined = 0
    for place in places:
        found, wanted = fan(arcs, view, *place), clear(arcs, *place)
        assert wanted <= found, place
        seen += len(found)
        joined += len(fan(arcs, Glass(arcs), *place))
    assert seen < (0.9 if clearance_m > 3.0 else 0.6) * joined


def test_tangents_are_forgotten_before_a_search_once_there_are_too_many() -> None:
    arcs = archipelago(1, 3.0)
    tangents = Tangents(arcs, View(arcs))
    search = TangentSearch(tangents)

    def length_m() -> float:
        search.begin(-880.0, -880.0, 880.0, 880.0)
        while not search.is_done(100):
            pass
        return search.bound

    before, count = length_m(), tangents.count
    assert length_m() == before
    assert tangents.count == count
    tangents.count = MOST_TANGENTS + 1
    assert length_m() == before
    assert tangents.count == count


def test_water_goes_with_its_routes_once_nobody_uses_it() -> None:
    """A boat whose fence is replaced often waits for no garbage collection of megabytes."""
    square = [Point(0.0, 0.0), Point(0.0, 90.0), Point(90.0, 90.0), Point(90.0, 0.0)]
    island = [Point(30.0, 40.0), Point(30.0, 50.0), Point(60.0, 50.0), Point(60.0, 40.0)]
    water = Water([Shore(square), Shore(island)])
    assert water.routes(2.0).route(Point(45.0, 20.0), Point(45.0, 70.0)).expanded
    water_lives, routes_live = weakref.ref(water), weakref.ref(water.routes(2.0))
    gc.disable()
    try:
        del water
        assert water_lives() is None
        assert routes_live() is None
    finally:
        gc.enable()
