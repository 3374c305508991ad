"""Probabilistic roadmap: L. E. Kavraki, P. Svestka, J.-C. Latombe and M. H. Overmars, *Probabilistic
Roadmaps for Path Planning in High-Dimensional Configuration Spaces* (1996); found best for flooded
streets in reference [7].

OMPL's PRM grows by the wall clock in a thread of its own, so that a seed does not fix its path; this one is
plain.
"""

import heapq
import math
import random
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from benchmarks.peers.interface import Deadline, NoPath, Path, Sea
from companion.core.geo import Point, distance_m

SAMPLES = 1200
NEIGHBOURS = 29  # e (1 + 1/2) ln 1200: PRM*'s number (Karaman and Frazzoli, 2011)
_TRIES = 60  # per sample


@dataclass(frozen=True, slots=True)
class Roadmap:
    """Points on the water, the start first and the goal second, and the clear legs between near ones."""

    points: tuple[Point, ...]
    legs: dict[int, list[int]]


def build(sea: Sea, start: Point, goal: Point, seed: int, deadline: Deadline) -> Roadmap:
    """Even samples of the free water, each joined to its nearest neighbours that it sees."""
    draw = random.Random(seed)
    west, south, east, north = sea.bounds
    points = [start, goal]
    for _ in range(SAMPLES * _TRIES):
        if len(points) == SAMPLES + 2:
            break
        at = Point(draw.uniform(south, north), draw.uniform(west, east))
        if sea.is_free(at):
            points.append(at)
        deadline.check()
    count = min(NEIGHBOURS + 1, len(points))
    _, nearest = cKDTree(np.array(points)).query(np.array(points), k=count)
    legs: dict[int, list[int]] = {n: [] for n in range(len(points))}
    for here, row in enumerate(nearest.tolist()):
        deadline.check()
        for there in row:
            if here != there and there not in legs[here] and sea.is_clear(points[here], points[there]):
                legs[here].append(there)
                legs[there].append(here)
    return Roadmap(tuple(points), legs)


def prm(sea: Sea, start: Point, goal: Point, seed: int, deadline: Deadline) -> Path:
    """The shortest way over a roadmap."""
    roadmap = build(sea, start, goal, seed, deadline)
    return shortest(roadmap, lambda a, b: distance_m(roadmap.points[a], roadmap.points[b]))


def shortest(roadmap: Roadmap, length: Callable[[int, int], float]) -> Path:
    """Dijkstra's algorithm from the first point to the second.

    Raises:
        NoPath: the roadmap does not join them.
    """
    costs, parents, open_list = {0: 0.0}, {0: 0}, [(0.0, 0)]
    while open_list:
        cost, here = heapq.heappop(open_list)
        if here == 1:
            points = [roadmap.points[1]]
            while here:
                here = parents[here]
                points.append(roadmap.points[here])
            return tuple(reversed(points))
        if cost > costs[here]:
            continue
        for there in roadmap.legs[here]:
            tentative = cost + length(here, there)
            if tentative < costs.get(there, math.inf):
                costs[there], parents[there] = tentative, here
                heapq.heappush(open_list, (tentative, there))
    raise NoPath("the roadmap does not join start and goal")
