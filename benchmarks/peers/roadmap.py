"""Probabilistic roadmap: L. E. Kavraki, P. Svestka, J.-C. Latombe and M. H. Overmars, *Probabilistic
Roadmaps for Path Planning in High-Dimensional Configuration Spaces* (1996); found best for flooded
streets in reference [7].

OMPL's PRM grows by the wall clock in a thread of its own, so that a seed does not fix its path; this one is
plain.
"""

import math
import random

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from benchmarks.peers.interface import Deadline, NoPath, Path, Sea
from companion.core.geo import Point, distance_m

SAMPLES = 1200
_TRIES = 60  # per sample


def prm(sea: Sea, start: Point, goal: Point, seed: int, deadline: Deadline, effort: float) -> Path:
    """Even samples of the free water, each joined to its nearest neighbours that it sees; the shortest way.
    Raises NoPath: the roadmap does not join start and goal.
    """
    draw, samples = random.Random(seed), round(effort * SAMPLES)
    neighbours = math.ceil(1.5 * math.e * math.log(samples))  # PRM*'s number (Karaman and Frazzoli, 2011)
    west, south, east, north = sea.bounds
    points = [start, goal]
    for _ in range(samples * _TRIES):
        if len(points) == samples + 2:
            break
        at = Point(draw.uniform(south, north), draw.uniform(west, east))
        if sea.is_free(at):
            points.append(at)
        deadline.check()
    _, nearest = cKDTree(np.array(points)).query(np.array(points), k=min(neighbours + 1, len(points)))
    legs = set()
    for here, row in enumerate(nearest.tolist()):
        deadline.check()
        legs |= {(here, there) for there in row if sea.is_clear(points[here], points[there])}
    lengths = [max(distance_m(points[a], points[b]), 1e-9) for a, b in legs]
    graph = coo_matrix((lengths, tuple(zip(*legs, strict=True))), shape=(len(points), len(points)))
    _, before = dijkstra(graph, directed=False, indices=0, return_predecessors=True)
    way = [1]
    while way[-1] > 0:
        way.append(int(before[way[-1]]))
    if way[-1] < 0:
        raise NoPath("the roadmap does not join start and goal")
    return tuple(points[n] for n in reversed(way))
