"""Water between shores, exactly: no raster, no buffer. Distances are those of straight segments.

A leg is clear where each of its points keeps the clearance from every shore. A shore may ask for a clearance
of its own. `Water.routes` gives the shortest routes that are clear.
"""

import math
from array import array
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from companion.core.geo import Point
from companion.planning import kernels, segments
from companion.planning.visibility import Routes

MIN_CLEARANCE_M = 1e-6
"""What a clearance of 0 means: a leg that touches a shore is not clear."""
SIDE_M = 1e-6  # how far beside a shore is looked for water
_EDGES_SEEN = 32  # of a ring; beside the longest of them is looked for water
_DOUBLED_M = 1e-9  # corners nearer than this to each other are one

_kernel = kernels.load("_segments", "segments")


class Shore(NamedTuple):
    """A closed ring of corners, the last joined to the first. clearance_m: its own; None: the route's."""

    corners: Sequence[Point]
    clearance_m: float | None = None


class Water:
    """Water bounded by shores.

    A point is in the water where it lies inside an odd number of rings, or an even one if `is_open`: outside
    every ring there is then open sea. Obstacles are added by `with_shores`; their inside is never water.
    """

    def __init__(self, shores: Sequence[Shore], *, is_open: bool = False) -> None:
        self._shores = tuple(cleaned for shore in shores if (cleaned := _cleaned(shore)).corners)
        self._inside = _Inside(_segments(self._shores), is_open=is_open)
        self._index = self._inside.shores
        self._rings: tuple[_Ring, ...] = tuple(
            _Ring(shore, self._water_side(shore.corners)) for shore in self._shores
        )
        self._routes: dict[float, Routes] = {}

    def with_shores(self, more: Sequence[Shore]) -> "Water":
        """This water with obstacles in it, which may overlap shores and each other."""
        new = [cleaned for shore in more if (cleaned := _cleaned(shore)).corners]
        if not new:
            return self
        water = object.__new__(Water)
        water._shores = self._shores
        water._inside = _Inside(
            self._inside.shores, (*self._inside.obstacles, *new), is_open=self._inside.is_open
        )
        water._rings = (*self._rings, *(_Ring(shore, -_turning(shore.corners)) for shore in new))
        water._index = _segments([ring.shore for ring in water._rings])
        water._routes = {}
        return water

    def is_water(self, at: Point) -> bool:
        """Whether a point is in the water, not on land, outside or in an obstacle."""
        return self._inside.is_water(at)

    def distance_m(self, at: Point) -> float:
        """Distance to the nearest shore; infinite in open water."""
        return self.leg_distance_m(at, at)

    def leg_distance_m(self, start: Point, end: Point) -> float:
        """Distance of a straight leg from the nearest shore, 0 where it meets one; infinite in open water."""
        if self._index is None:
            return math.inf
        return math.sqrt(self._index.distance2(start.east_m, start.north_m, end.east_m, end.north_m))

    def is_clear(self, start: Point, end: Point, clearance_m: float) -> bool:
        """Whether a straight leg keeps the clearance from every shore, or the one that a shore asks for."""
        return self.routes(clearance_m).is_clear(start, end)

    def routes(self, clearance_m: float) -> Routes:
        """The shortest routes of one clearance; what they find out is kept for the next query.

        Raises:
            ValueError: a clearance below 0, or none that is finite.
        """
        if not 0.0 <= clearance_m < math.inf:
            raise ValueError(f"clearance is {clearance_m} m: expected 0 or more")
        known = self._routes.get(clearance_m)
        if known is None:
            known = self._routes[clearance_m] = self._new_routes(clearance_m)
        return known

    def _new_routes(self, clearance_m: float) -> Routes:
        following, left, limit = array("q"), array("q"), array("d")
        for ring in self._rings:
            first, count = len(following), len(ring.shore.corners)
            own_m = clearance_m if ring.shore.clearance_m is None else ring.shore.clearance_m
            following.extend(range(first + 1, first + count))
            following.append(first)
            left.extend([ring.water_side] * count)
            limit.extend([max(own_m, MIN_CLEARANCE_M)] * count)
        return Routes(self._inside.is_water, self._index, following, left, limit)

    def _water_side(self, corners: Sequence[Point]) -> int:
        """1 where the water is on the left of a ring, −1 on its right, 0 on both sides."""
        few = range(0, len(corners), max(1, len(corners) // _EDGES_SEEN))
        _, a, b = max((math.dist(corners[i - 1], corners[i]), corners[i - 1], corners[i]) for i in few)
        length_m = math.dist(a, b)
        north, east = (b.north_m - a.north_m) / length_m * SIDE_M, (b.east_m - a.east_m) / length_m * SIDE_M
        middle = Point(0.5 * (a.north_m + b.north_m), 0.5 * (a.east_m + b.east_m))
        is_left = self.is_water(Point(middle.north_m + east, middle.east_m - north))
        is_right = self.is_water(Point(middle.north_m - east, middle.east_m + north))
        return int(is_left) - int(is_right)


class _Inside:
    """Where water is; apart from `Water`, so that this and its routes do not keep each other alive."""

    def __init__(
        self, shores: "segments.Segments | None", obstacles: tuple[Shore, ...] = (), *, is_open: bool
    ) -> None:
        self.shores = shores
        self.obstacles = obstacles
        self.is_open = is_open

    def is_water(self, at: Point) -> bool:
        is_inside = self.shores is not None and self.shores.is_inside(at.east_m, at.north_m)
        return is_inside != self.is_open and not any(
            _is_inside(shore.corners, at) for shore in self.obstacles
        )


class _Ring(NamedTuple):
    shore: Shore
    water_side: int


def _cleaned(shore: Shore) -> Shore:
    """Without doubled corners; a single point becomes a triangle round it."""
    corners: list[Point] = []
    last_north_m, last_east_m = shore.corners[-1] if shore.corners else (0.0, 0.0)
    for corner in shore.corners:
        north_m, east_m = corner
        if abs(north_m - last_north_m) > _DOUBLED_M or abs(east_m - last_east_m) > _DOUBLED_M:
            corners.append(corner)
            last_north_m, last_east_m = north_m, east_m
    if shore.corners and len(corners) < 2:
        corners = [shore.corners[0]]
        north_m, east_m = corners[0]
        corners = [
            Point(north_m + 2.0 * SIDE_M, east_m),
            Point(north_m - SIDE_M, east_m - 2.0 * SIDE_M),
            Point(north_m - SIDE_M, east_m + 2.0 * SIDE_M),
        ]
    return Shore(tuple(corners), shore.clearance_m)


def _segments(shores: Iterable[Shore]) -> "segments.Segments | None":
    ax, ay, bx, by = array("d"), array("d"), array("d"), array("d")
    for shore in shores:
        east = [corner.east_m for corner in shore.corners]
        north = [corner.north_m for corner in shore.corners]
        ax.extend(east)
        ay.extend(north)
        bx.extend(east[1:] + east[:1])
        by.extend(north[1:] + north[:1])
    return _kernel.Segments(ax, ay, bx, by) if ax else None


def _turning(corners: Sequence[Point]) -> int:
    """1 where a ring turns left (counter-clockwise), −1 right, 0 where it encloses nothing."""
    double_area = sum(
        a.east_m * b.north_m - b.east_m * a.north_m
        for a, b in zip(corners, (*corners[1:], corners[0]), strict=True)
    )
    return (double_area > 0.0) - (double_area < 0.0)


def _is_inside(corners: Sequence[Point], at: Point) -> bool:
    is_odd = False
    for a, b in zip(corners, (*corners[1:], corners[0]), strict=True):
        if (a.north_m > at.north_m) != (b.north_m > at.north_m):
            share = (at.north_m - a.north_m) / (b.north_m - a.north_m)
            is_odd ^= a.east_m + share * (b.east_m - a.east_m) > at.east_m
    return is_odd
