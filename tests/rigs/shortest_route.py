"""Shortest routes by brute force, independent of the planner: shapely's erosion, all pairs, Dijkstra."""

import random
from typing import Any, TypeAlias

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra
from shapely.geometry import Polygon

from benchmarks.planning.route_oracle import Shape, star
from companion.core.geo import Point, distance_m

Array: TypeAlias = NDArray[Any]
ARC_SEGMENTS = 64  # a quarter circle: its chords are (pi/128)²/24, 0.003 %, shorter than the arc
TOUCH_M = 1e-5  # a leg along the edge of free water is in it


def shortest_route_m(water: Shape, clearance_m: float, start: Point, goal: Point) -> float:
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


def random_lake(rng: random.Random) -> Polygon:
    """A lake of some 100 m with up to sixteen islands, which may join each other or the shore."""
    water = star(rng, 0.0, 0.0, 100.0, rng.randint(3, 24), rng.choice((0.1, 0.5, 0.8)))
    for _ in range(rng.randint(2, 16)):
        x, y = rng.uniform(-70, 70), rng.uniform(-70, 70)
        water -= star(rng, x, y, rng.uniform(1, 40), rng.randint(3, 9), rng.choice((0.2, 0.7)))
    parts = [part for part in shapely.get_parts(water) if part.geom_type == "Polygon"]
    return max(parts, key=lambda part: part.area)
