"""Areas of a fence as corners and shores that routes keep clear of.

Circles become polygons that keep them: inscribed to an inclusion circle, circumscribed about an exclusion
circle.
"""

import math
from collections.abc import Sequence
from itertools import pairwise

from companion.core.geo import Point
from companion.planning.areas import Area, Disc
from companion.planning.water import Shore

CIRCLE_ERROR_M = 0.1  # between a circle and its polygon; a tenth of the position's error
_CIRCLE_SIDES = (12, 96)


def corners_of(area: Area) -> tuple[Point, ...]:
    """Those of a polygon, or of one that keeps a circle."""
    if not isinstance(area, Disc):
        return area.vertices
    least, most = _CIRCLE_SIDES
    # The error of n sides is about radius · (π/n)² / 2
    sides = min(max(math.ceil(math.pi * math.sqrt(0.5 * area.radius_m / CIRCLE_ERROR_M)), least), most)
    radius_m = area.radius_m
    if not area.is_inclusion:
        radius_m /= math.cos(math.pi / sides)
    return tuple(area.centre.moved(math.tau * number / sides, radius_m) for number in range(sides))


def outside_of(corners: Sequence[Point], frame: tuple[float, float, float, float]) -> Shore:
    """A frame without the inside of a ring, as one ring: a slit joins it to the ring's northmost corner."""
    south_m, west_m, north_m, east_m = frame
    first = max(range(len(corners)), key=lambda number: corners[number].north_m)
    ring = [*corners[first:], *corners[: first + 1]]
    double_area = sum(a.east_m * b.north_m - b.east_m * a.north_m for a, b in pairwise(ring))
    if double_area > 0.0:
        ring.reverse()  # clockwise inside the counter-clockwise frame
    slit = Point(north_m, ring[0].east_m)
    frame_ring = [
        slit,
        Point(north_m, west_m),
        Point(south_m, west_m),
        Point(south_m, east_m),
        Point(north_m, east_m),
        slit,
    ]
    return Shore((*frame_ring, *ring))
