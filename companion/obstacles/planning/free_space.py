"""Free distance around a place, by direction and along a path.

By direction it is the polar histogram of I. Ulrich and J. Borenstein, *VFH+: Reliable Obstacle Avoidance for
Fast Mobile Robots*, ICRA 1998, with distances in place of densities: an obstacle at distance d blocks the
directions within asin(clearance / d) of its own.
"""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Protocol

from companion.core.geo import Point
from companion.core.units import TAU, wrap_pi
from companion.obstacles.perception.looked_at import ChartedWater

SECTORS = 72
SECTOR_RAD = TAU / SECTORS
_TOO_NEAR_RAD = 1.4  # within the clearance: only courses that lead away are open
_COMES_NEARER = 0.8  # a path may pass an obstacle within the clearance unless it comes closer than this share


class Bounds(Protocol):
    """A region that the boat must stay within."""

    @property
    def is_active(self) -> bool:
        """Whether there is any limit."""

    def room_m(self, point: Point, course_rad: float, reach_m: float) -> float:
        """Free distance along a course, at most reach_m."""


class ChartedBounds(Bounds, ChartedWater, Protocol):
    """Bounds that may contain known water."""


class FreeSpace:
    """Directions from one place, SECTORS of them, clockwise from north."""

    def __init__(self, at: Point, obstacles: Sequence[Point], clearance_m: float, reach_m: float) -> None:
        """Obstacles farther than reach_m plus the clearance are ignored."""
        self._at = at
        self._bounds: Bounds | None = None
        self._inside_m = 0.0
        self._rooms_m = [reach_m] * SECTORS
        for obstacle in obstacles:
            self._shut(obstacle.north_m - at.north_m, obstacle.east_m - at.east_m, clearance_m, reach_m)

    def _shut(self, north_m: float, east_m: float, clearance_m: float, reach_m: float) -> None:
        distance = math.sqrt(north_m * north_m + east_m * east_m)
        if distance >= reach_m + clearance_m:
            return
        bearing = math.atan2(east_m, north_m)
        is_near = distance <= clearance_m
        half = _TOO_NEAR_RAD if is_near else math.asin(clearance_m / distance)
        first, last = math.ceil((bearing - half) / SECTOR_RAD), math.floor((bearing + half) / SECTOR_RAD)
        rooms = self._rooms_m
        for sector in range(first, last + 1):
            room = 0.0
            if not is_near:
                off = sector * SECTOR_RAD - bearing
                across = distance * math.sin(off)
                room = distance * math.cos(off) - math.sqrt(max(clearance_m**2 - across * across, 0.0))
            rooms[sector % SECTORS] = min(rooms[sector % SECTORS], room)

    def set_bounds(self, bounds: Bounds, inside_m: float) -> None:
        """Open courses must end inside_m within the bounds."""
        if bounds.is_active:
            self._bounds, self._inside_m = bounds, inside_m

    def room_m(self, course_rad: float) -> float:
        """Distance free of obstacles on a course."""
        return self._rooms_m[round(course_rad / SECTOR_RAD) % SECTORS]

    def first_open_rad(self, from_rad: float, side: int, need_m: float) -> float | None:
        """The first course that is open for need_m, turning from from_rad to starboard (side 1) or port (−1).

        None if it leaves the bounds: there is no way around on that side.
        """
        start, rooms = round(from_rad / SECTOR_RAD), self._rooms_m
        for step in range(SECTORS):
            sector = start + side * step
            if rooms[sector % SECTORS] >= need_m:
                course = wrap_pi(sector * SECTOR_RAD)
                return course if self._is_within(course, need_m) else None
        return None

    def _is_within(self, course_rad: float, need_m: float) -> bool:
        if self._bounds is None:
            return True
        need_m += self._inside_m
        return self._bounds.room_m(self._at, course_rad, need_m) >= need_m


def clear_m(way: Sequence[Point], obstacles: Sequence[Point], clearance_m: float, reach_m: float) -> float:
    """Distance along a path to the first obstacle within the clearance; infinite for none.

    way: two or more corners, the boat at the first. Obstacles beyond reach_m along it are ignored.
    """
    nearest, before = math.inf, 0.0
    for start, end in pairwise(way):
        north, east = end.north_m - start.north_m, end.east_m - start.east_m
        length = math.sqrt(north * north + east * east)
        if length <= 0.0:
            continue
        north, east = north / length, east / length
        length = min(length, reach_m - before)
        for obstacle in obstacles:
            to_n, to_e = obstacle.north_m - start.north_m, obstacle.east_m - start.east_m
            along = to_n * north + to_e * east
            if not -clearance_m < along < length + clearance_m:
                continue
            across = abs(to_e * north - to_n * east)
            if across >= clearance_m:
                continue
            away = math.sqrt(along * along + across * across)
            if before == 0.0 and away < clearance_m:
                if along > 0.0 and across < _COMES_NEARER * away:
                    nearest = 0.0
                continue
            enters = along - math.sqrt(clearance_m * clearance_m - across * across)
            if enters < length and before + max(enters, 0.0) < nearest and along > 0.0:
                nearest = before + max(enters, 0.0)
        before += length
        if before >= min(reach_m, nearest):
            break
    return nearest
