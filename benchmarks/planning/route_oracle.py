"""Shortest routes by brute force, independent of the planner: shapely's erosion, all pairs, Dijkstra."""

import random
from collections.abc import Sequence
from math import cos, pi, sin
from typing import Any, TypeAlias

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra
from shapely.geometry import MultiPolygon, Polygon

from companion.core.geo import Point, distance_m
from companion.planning.water import Shore

Shape: TypeAlias = Polygon | MultiPolygon
Array: TypeAlias = NDArray[Any]
ARC_SEGMENTS = 64  # a quarter circle: its chords are (pi/128)²/24, 0.003 %, shorter than the arc
TOUCH_M = 1e-5  # a leg along the edge of free water is in it


def shores_of(water: Shape) -> list[Shore]:
    """The rings of shapely polygons, x east."""
    rings = [
        ring
        for part in shapely.get_parts(water)
        for ring in (part.exterior, *part.interiors)
        if part.area > 0
    ]
    return [Shore([Point(y, x) for x, y in ring.coords[:-1]]) for ring in rings]


def shortest_m(water: Shape, clearance_m: float, start: Point, goal: Point) -> float:
    """Length of the shortest route, up to 0.003 % of its arcs too short; infinite where there is none."""
    free = water.buffer(-clearance_m, quad_segs=ARC_SEGMENTS)
    inside = free.buffer(TOUCH_M, quad_segs=2)
    shapely.prepare(inside)
    ends = [(start.east_m, start.north_m), (goal.east_m, goal.north_m)]
    if inside.covers(shapely.LineString(ends)):
        return distance_m(start, goal)
    # Each node with the corners before and after it; an end has none, which is itself twice.
    corners = np.array([*((end, end, end) for end in ends), *_bends(free)])
    nodes = corners[:, 1]
    first, last = np.triu_indices(len(nodes), 1)
    grazes = _is_tangent(corners, first, last) & _is_tangent(corners, last, first)
    first, last = first[grazes], last[grazes]
    seen = shapely.covers(inside, shapely.linestrings(np.stack([nodes[first], nodes[last]], axis=1)))
    length = np.hypot(*(nodes[first] - nodes[last]).T)
    graph = coo_matrix((length[seen], (first[seen], last[seen])), shape=(len(nodes), len(nodes)))
    return float(dijkstra(graph, directed=False, indices=0)[1])


def _is_tangent(corners: Array, at: Array, to: Array) -> Array:
    """Whether both neighbours of a corner lie on one side of the leg: a taut string bends nowhere else."""
    leg = corners[to, 1] - corners[at, 1]
    before, after = (corners[at, n] - corners[at, 1] for n in (0, 2))
    sides = [leg[:, 0] * side[:, 1] - leg[:, 1] * side[:, 0] for side in (before, after)]
    noise = 1e-9 * np.hypot(*leg.T)
    one_side: Array = (np.minimum(*sides) > -noise) | (np.maximum(*sides) < noise)
    return one_side


def _bends(free: Shape) -> list[tuple[Any, Any, Any]]:
    """Corners of free water that a taut string may bend round, each between its neighbours."""
    bends = []
    for part in shapely.get_parts(free):
        for ring in shapely.get_parts(shapely.boundary(shapely.orient_polygons(part))):
            corners = [*ring.coords[:-1], *ring.coords[:2]]
            for a, b, c in zip(corners, corners[1:], corners[2:], strict=False):
                if (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]) < 0.0:
                    bends.append((a, b, c))
    return bends


def clearance_m(water: Shape, points: Sequence[Point]) -> float:
    """Distance of a route from the shore; 0 where it leaves the water."""
    line = shapely.LineString([(point.east_m, point.north_m) for point in points])
    return float(water.boundary.distance(line)) if water.covers(line) else 0.0


def star(rng: random.Random, x: float, y: float, radius: float, corners: int, jag: float) -> Polygon:
    """A polygon round a point, jagged by this share of its radius."""
    spread = [radius * (1.0 - jag * rng.random()) for _ in range(corners)]
    turn = rng.random()
    return shapely.Polygon(
        [
            (x + r * cos(2 * pi * (n + turn) / corners), y + r * sin(2 * pi * (n + turn) / corners))
            for n, r in enumerate(spread)
        ]
    )


def lake(rng: random.Random) -> Polygon:
    """A lake of some 100 m with up to sixteen islands, which may join each other or the shore."""
    water = star(rng, 0.0, 0.0, 100.0, rng.randint(3, 24), rng.choice((0.1, 0.5, 0.8)))
    for _ in range(rng.randint(2, 16)):
        x, y = rng.uniform(-70, 70), rng.uniform(-70, 70)
        water -= star(rng, x, y, rng.uniform(1, 40), rng.randint(3, 9), rng.choice((0.2, 0.7)))
    parts = [part for part in shapely.get_parts(water) if part.geom_type == "Polygon"]
    return max(parts, key=lambda part: part.area)


def free_points(rng: random.Random, water: Shape, clearance_m: float, count: int) -> list[Point]:
    """Random points that have the clearance; fewer where there is hardly any free water."""
    free = water.buffer(-1.02 * clearance_m - 1e-3)  # the chords of its arcs cut a hundredth off
    found: list[Point] = []
    if free.is_empty:
        return found
    west, south, east, north = free.bounds
    for _ in range(200 * count):
        x, y = rng.uniform(west, east), rng.uniform(south, north)
        if free.contains(shapely.Point(x, y)):
            found.append(Point(y, x))
            if len(found) == count:
                break
    return found
