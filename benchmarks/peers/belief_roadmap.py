"""Belief roadmap: S. Prentice and N. Roy, *The Belief Roadmap: Efficient Planning in Belief Space by
Factoring the Covariance* (IJRR 2009), the method of the paper's reference [5].

The position's variance is carried along a roadmap by a Kalman filter: it grows with the way sailed, and
falls where there is GNSS. Near a shore there is none (trees, walls, the pool's edge). A leg is allowed if
the clearance is kept by twice the standard deviation more; of the ways that are, the shortest is taken.
Labels of length and variance that another label beats in both are dropped.
"""

import heapq
import itertools
import math
from collections.abc import Iterator

from benchmarks.peers.interface import Deadline, NoPath, Path, Sea
from benchmarks.peers.roadmap import build
from companion.core.geo import Point, distance_m

SHADOW_CLEARANCES = 2.0  # as near to a shore as this there is no GNSS
GROWTH = 0.001  # of variance, clearance² for each clearance sailed: dead reckoning off by 3 % after one
GNSS_SHARE = 0.1  # standard deviation of a fix, in clearances
DEVIATIONS = 2.0
ALIKE = 1.1  # variances by less than this factor apart count as equal
_STEPS = 8  # samples of a leg


def belief_roadmap(sea: Sea, start: Point, goal: Point, seed: int, deadline: Deadline) -> Path:
    """The shortest way whose growing uncertainty keeps off the shores."""
    roadmap = build(sea, start, goal, seed, deadline)
    points, filters = roadmap.points, _Filter(sea, roadmap.points)
    number = itertools.count()
    labels = [(distance_m(start, goal), next(number), 0.0, filters.fix, 0)]
    parents: dict[int, tuple[int, int]] = {0: (-1, 0)}  # by label: the label before and the point
    kept: dict[int, list[tuple[float, float]]] = {}
    while labels:
        deadline.check()
        _, label, length_m, variance, here = heapq.heappop(labels)
        if here == 1:
            return tuple(points[n] for n in _way(parents, label))
        if any(other_m <= length_m and known <= variance * ALIKE for other_m, known in kept.get(here, ())):
            continue
        kept.setdefault(here, []).append((length_m, variance))
        for there in roadmap.legs[here]:
            after = filters.after_leg(here, there, variance)
            if after is None:
                continue
            so_far_m = length_m + distance_m(points[here], points[there])
            ahead_m = so_far_m + distance_m(points[there], goal)
            name = next(number)
            parents[name] = label, there
            heapq.heappush(labels, (ahead_m, name, so_far_m, after, there))
    raise NoPath("no way over the roadmap keeps the clearance with the uncertainty of the position")


def _way(parents: dict[int, tuple[int, int]], label: int) -> list[int]:
    way = []
    while label >= 0:
        label, point = parents[label]
        way.append(point)
    return way[::-1]


class _Filter:
    """The variance along a leg, and whether the leg keeps off the shores with it."""

    def __init__(self, sea: Sea, points: Path) -> None:
        self._sea, self._points = sea, points
        self._unit_m = max(sea.clearance_m, 1e-3)
        self.fix = (GNSS_SHARE * self._unit_m) ** 2
        self._legs: dict[tuple[int, int], tuple[float, tuple[bool, ...]]] = {}

    def after_leg(self, here: int, there: int, variance: float) -> float | None:
        """The variance at the end; None where the leg is too near to a shore for it."""
        a, b = self._points[here], self._points[there]
        if (here, there) not in self._legs:
            self._legs[here, there] = self._sea.water.leg_distance_m(a, b), tuple(self._shadows(a, b))
        distance, shadows = self._legs[here, there]
        step_m, worst = distance_m(a, b) / _STEPS, variance
        for in_shadow in shadows:
            variance += GROWTH * self._unit_m * step_m
            worst = max(worst, variance)
            if not in_shadow:
                variance = variance * self.fix / (variance + self.fix)
        is_end = here == 0 or there == 1  # start and goal may lie at the clearance itself
        if not is_end and distance < self._sea.clearance_m + DEVIATIONS * math.sqrt(worst):
            return None
        return variance

    def _shadows(self, a: Point, b: Point) -> Iterator[bool]:
        for k in range(1, _STEPS + 1):
            share = k / _STEPS
            at = Point(a.north_m + share * (b.north_m - a.north_m), a.east_m + share * (b.east_m - a.east_m))
            yield self._sea.water.distance_m(at) < SHADOW_CLEARANCES * self._unit_m
