"""A smooth path over ground: nodes with course and speed limit, in sailing order.

Along-track distances count from the first node. Before the first and beyond the last node the path is
straight.
"""

import math
from bisect import bisect_right
from collections.abc import Sequence
from itertools import pairwise
from typing import Final, NamedTuple

from companion.core.geo import Point

_SLACK_M: Final = 1e-6  # rounding


class Node(NamedTuple):
    """course_rad: of the path at the node, not wrapped: continuous from node to node."""

    north_m: float
    east_m: float
    course_rad: float
    speed_m_s: float


class Path:
    """At least two nodes. Between nodes the path is straight, and course and squared speed are linear; a
    straight stretch needs only its end nodes.
    """

    def __init__(self, nodes: Sequence[Node]) -> None:
        if len(nodes) < 2:
            raise ValueError(f"a path of {len(nodes)} nodes")
        self.nodes = nodes
        self._along_m, sum_m = [0.0], 0.0
        # along-track distance, start, difference to the end, and length
        self._stretches: list[tuple[float, float, float, float, float, float]] = []
        for one, other in pairwise(nodes):
            north, east = other.north_m - one.north_m, other.east_m - one.east_m
            start_m, sum_m = sum_m, sum_m + math.hypot(north, east)
            self._stretches.append((start_m, one.north_m, one.east_m, north, east, sum_m - start_m))
            self._along_m.append(sum_m)

    @property
    def length_m(self) -> float:
        """From the first node to the last."""
        return self._along_m[-1]

    def along_m(self, node: int) -> float:
        """Along-track distance of a node."""
        return self._along_m[node]

    def locate(self, at: Point, from_m: float, to_m: float) -> tuple[float, float]:
        """Along-track distance of the nearest place from from_m to to_m, and the distance to its right."""
        along_m, stretches = self._along_m, self._stretches
        last = len(stretches) - 1
        first = max(min(bisect_right(along_m, from_m) - 1, last), 0)
        best, found = math.inf, (0.0, 0.0)
        n = first - 1
        while n < last:
            n += 1
            start_m, north_m, east_m, north, east, length = stretches[n]
            if n > first and start_m > to_m:
                break
            off_n, off_e = at.north_m - north_m, at.east_m - east_m
            if length <= 0.0:
                continue
            if 0 < n < last:  # if farther away than the best place, so is all within the difference
                beyond_m = start_m + math.hypot(off_n, off_e) - best - _SLACK_M
                if beyond_m > start_m + length:
                    n = max(bisect_right(along_m, beyond_m, n, last) - 2, n)
                    continue
            along = (off_n * north + off_e * east) / length
            low = from_m - start_m if n == first and n > 0 else 0.0
            high = min(to_m - start_m, length)
            if n == 0:
                low = -math.inf
            if n == last and to_m >= along_m[n + 1]:
                high = math.inf
            along = min(max(along, low), high)
            far_n, far_e = off_n - along / length * north, off_e - along / length * east
            away = math.hypot(far_n, far_e)
            if away < best - 1e-9:
                best = away
                cross = (off_e * north - off_n * east) / length
                found = (start_m + along, math.copysign(away, cross))
        return found

    def course_rad(self, along_m: float) -> float:
        """Direction of the path at an along-track distance. Not wrapped."""
        n, share = self._between(along_m)
        one, other = self.nodes[n], self.nodes[n + 1]
        return one.course_rad + share * (other.course_rad - one.course_rad)

    def speed_m_s(self, along_m: float) -> float:
        """Limit of the speed over ground at an along-track distance."""
        n, share = self._between(along_m)
        one, other = self.nodes[n].speed_m_s, self.nodes[n + 1].speed_m_s
        return math.sqrt(one * one + share * (other * other - one * one))

    def point(self, along_m: float) -> Point:
        """The place at an along-track distance."""
        n, share = self._between(along_m)
        one, other = self.nodes[n], self.nodes[n + 1]
        return Point(one.north_m, one.east_m).towards(Point(other.north_m, other.east_m), share)

    def _between(self, along_m: float) -> tuple[int, float]:
        """The node before an along-track distance, and the share of the way to the next, 0 to 1."""
        n = max(min(bisect_right(self._along_m, along_m) - 1, len(self._along_m) - 2), 0)
        length = self._along_m[n + 1] - self._along_m[n]
        if length <= 0.0:
            return n, 1.0
        return n, min(max((along_m - self._along_m[n]) / length, 0.0), 1.0)
