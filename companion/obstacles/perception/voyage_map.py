"""Map of the voyage: what the boat has seen, by place, for as long as it is armed.

A sparse occupancy grid (S. Thrun, W. Burgard, D. Fox, *Probabilistic Robotics*, 2005, chapter 9) with cells
of one margin. The local grid (`occupancy.py`) is a finer window of it around the boat, and is given back what
comes near again and it does not hold, so that the rangers confirm or refute it.
"""

import math
from collections.abc import Sequence
from typing import Final

from companion.core.geo import Point, distance_m
from companion.obstacles.perception.occupancy import LASTING, Occupancy
from companion.planning.segments import point_distance2

MAX_CELLS: Final = 4000  # 4 km of shore in cells of 1 m
_STRAIGHT: Final = 0.3  # cells: places within it lie on one line
_APPROACH: Final = 0.95  # of its nearer end's distance: a way that comes no nearer leads along or away

Key = tuple[int, int]
Stretch = tuple[Point, Point]


class VoyageMap:
    """version: changes with what was seen. has_barred_a_way: the chart that a way was planned by lacks it."""

    def __init__(self) -> None:
        self.version = 0
        self.has_barred_a_way = False
        self._cell_m = 1.0
        self._seen: dict[Key, Point] = {}
        self._updated_s = -math.inf
        self._stretches: tuple[int, list[Stretch]] = (0, [])

    def clear(self) -> None:
        """Forget all: another voyage begins, or the local frame has moved."""
        self._seen.clear()
        self.has_barred_a_way = False
        self.version += 1

    def update(
        self,
        grid: Occupancy,
        cell_m: float,
        movers: Sequence[Point],
        here: Point,
        reach_m: float,
        now_s: float,
    ) -> None:
        """Take what the local grid is sure of, and give back what it forgot within reach_m."""
        if cell_m != self._cell_m:
            self.clear()
            self._cell_m = cell_m
        known = {self._key(at) for at in grid.obstacles()}
        hits: dict[Key, list[Point]] = {}
        refuted = set()
        for cell in grid.seen_since(self._updated_s):
            if cell.evidence < 0.0:
                refuted.add(self._key(cell.at))
            elif cell.evidence >= LASTING and all(distance_m(cell.at, one) > 2.0 * cell_m for one in movers):
                hits.setdefault(self._key(cell.at), []).append(cell.at)
        self._updated_s = now_s
        for key in refuted - known:
            if self._seen.pop(key, None) is not None:
                self.version += 1
        for key, places in hits.items():
            self._add(key, _middle(places))
        for key, at in self._seen.items():
            if key not in known and distance_m(at, here) < reach_m and grid.evidence_at(at) is None:
                grid.restore(at, now_s)

    def is_near(self, at: Point, within_m: float) -> bool:
        """Whether something was seen within this distance of a place."""
        return self.nearest(at, within_m) is not None

    def nearest(self, at: Point, within_m: float) -> Point | None:
        """What was seen nearest to a place, if it is within this distance; nothing is near to NaN."""
        if not self._seen or not math.isfinite(at.north_m + at.east_m):
            return None
        reach, (row, column) = math.ceil(within_m / self._cell_m), self._key(at)
        rows, columns = range(row - reach, row + reach + 1), range(column - reach, column + reach + 1)
        near = [one for r in rows for c in columns if (one := self._seen.get((r, c))) is not None]
        nearest = min(near, key=lambda one: distance_m(at, one), default=None)
        return nearest if nearest is not None and distance_m(at, nearest) < within_m else None

    def bars(self, start: Point, end: Point, clearance_m: float, ends: Sequence[Point]) -> bool:
        """Whether a straight way comes nearer than this to what was seen, and nearer than these ends of the
        whole way, which may be as near as they are.
        """
        if clearance_m <= 0.0:
            return False
        south_m, north_m = sorted((start.north_m, end.north_m))
        west_m, east_m = sorted((start.east_m, end.east_m))
        near = [
            at
            for at in self._seen.values()
            if south_m - clearance_m < at.north_m < north_m + clearance_m
            and west_m - clearance_m < at.east_m < east_m + clearance_m
        ]
        ends_m = min((distance_m(at, place) for at in near for place in ends), default=math.inf)
        least_m = min(clearance_m, _APPROACH * ends_m)
        return any(point_distance2(*at, *start, *end) < least_m * least_m for at in near)

    def stretches(self) -> list[Stretch]:
        """What was seen as straight stretches, which join neighbouring cells."""
        if self._stretches[0] != self.version:
            self._stretches = self.version, _joined(self._seen, _STRAIGHT * self._cell_m)
        return self._stretches[1]

    def _key(self, at: Point) -> Key:
        return math.floor(at.north_m / self._cell_m), math.floor(at.east_m / self._cell_m)

    def _add(self, key: Key, at: Point) -> None:
        if key not in self._seen:
            self.version += 1
            if len(self._seen) >= MAX_CELLS:
                del self._seen[next(iter(self._seen))]
        self._seen[key] = at


def _middle(places: Sequence[Point]) -> Point:
    return Point(
        sum(at.north_m for at in places) / len(places), sum(at.east_m for at in places) / len(places)
    )


def _joined(seen: dict[Key, Point], tolerance_m: float) -> list[Stretch]:
    """Chains of neighbouring cells, each joined at both ends to the chains that it meets."""
    stretches: list[Stretch] = []
    left = dict(seen)
    while left:
        key = next(iter(left))
        del left[key]
        before = [seen[one] for one in _beside(key) if one in seen and one not in left]
        chain = [*_nearest(seen[key], before), seen[key]]
        while onward := [one for one in _beside(key) if one in left]:
            key = min(onward, key=lambda one: distance_m(chain[-1], seen[one]))
            del left[key]
            chain.append(seen[key])
        chain += _nearest(
            chain[-1], [seen[one] for one in _beside(key) if one in seen and seen[one] not in chain[-3:]]
        )
        stretches += _straightened(chain, tolerance_m)
    return stretches


def _beside(key: Key) -> list[Key]:
    return [(key[0] + row, key[1] + column) for row in (-1, 0, 1) for column in (-1, 0, 1) if row or column]


def _nearest(at: Point, places: Sequence[Point]) -> list[Point]:
    """The nearest of the places, if there is any."""
    return [min(places, key=lambda place: distance_m(at, place))] if places else []


def _straightened(chain: Sequence[Point], tolerance_m: float) -> list[Stretch]:
    """A chain as few stretches, none of its places farther from them than the tolerance."""
    stretches = []
    first, last = 0, 1
    while last < len(chain):
        start, end = chain[first], chain[last]
        if any(point_distance2(*at, *start, *end) > tolerance_m**2 for at in chain[first + 1 : last]):
            stretches.append((chain[first], chain[last - 1]))
            first = last - 1
        else:
            last += 1
    stretches.append((chain[first], chain[-1]))
    return stretches
