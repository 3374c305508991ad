"""The water that keeps a distance from every shore, as polygons that are never nearer than asked for.

GEOS draws the round corners of a buffer as chords and simplifies its input by up to a hundredth of the
distance, so a shore may come out nearer than asked. The polygons here are checked by the exact distance of
their outline, and shrunk until it holds.
"""

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from companion.core.geo import Point
from mission_tools.errors import NoRoute
from mission_tools.maps.chart import Chart

QUADRANT_SEGMENTS = (
    8  # of the round corners of the polygons: their chords are 0.5 % of the distance off the arc
)
_ATTEMPTS = 6
_ROUNDING = 1e-9


def water_clear_of_shores(chart: Chart, distance_m: float) -> list[Polygon]:
    """The pieces of navigable water that keep this distance from every shore, largest first."""
    pieces = chart.navigable
    asked_m = distance_m
    for _ in range(_ATTEMPTS if distance_m > 0.0 and not chart.shores.is_empty else 0):
        pieces = chart.navigable.buffer(-asked_m, quad_segs=QUADRANT_SEGMENTS)
        if pieces.is_empty:
            return []
        legs = _legs(pieces)
        near = legs[shapely.dwithin(chart.shores, legs, distance_m * (1.0 - _ROUNDING))]
        if len(near) == 0:
            break
        asked_m += 1.01 * (distance_m - float(shapely.distance(near, chart.shores).min()))
    return sorted(polygons(pieces), key=lambda piece: -piece.area)


def water_reached_from(pieces: list[Polygon], start: Point | None) -> Polygon:
    """The piece that a start is in or nearest to; without one the largest. Raises NoRoute: there is none."""
    if not pieces:
        raise NoRoute("no water here is wide enough for the clearance: choose a smaller one")
    if start is None:
        return pieces[0]
    at = shapely.Point(start.east_m, start.north_m)
    return min(pieces, key=at.distance)


def polygons(shape: BaseGeometry) -> list[Polygon]:
    """The polygons of a geometry, without its lines, points and empty parts."""
    parts = shapely.get_parts(shape)
    if any(part.geom_type == "GeometryCollection" for part in parts):
        parts = np.concatenate([shapely.get_parts(part) for part in parts])
    return [part for part in parts if isinstance(part, Polygon) and not part.is_empty]


def simplified(
    ring: NDArray[np.float64], shores: BaseGeometry, clearance_m: float, error_m: float
) -> NDArray[np.float64]:
    """A closed ring of (east, north) with fewer corners: no skipped corner is farther than error_m from the
    new leg.

    Corners are put back (as Douglas and Peucker do, the farthest first) until that holds and every new leg
    keeps clearance_m from the shores, as far as the ring itself does.
    """
    shapely.prepare(shores)
    count = len(ring) - 1
    kept = {0, int(np.argmax(np.hypot(*(ring[:-1] - ring[0]).T))), count}
    open_legs = list(zip(sorted(kept), sorted(kept)[1:], strict=False))
    while open_legs:
        open_legs = [(first, last) for first, last in open_legs if last - first > 1]
        if not open_legs:
            break
        legs = shapely.linestrings([[ring[first], ring[last]] for first, last in open_legs])
        is_near = shapely.dwithin(shores, legs, clearance_m * (1.0 - _ROUNDING))
        split: list[tuple[int, int]] = []
        for (first, last), leg, near in zip(open_legs, legs, is_near, strict=True):
            off_m = shapely.distance(leg, shapely.points(ring[first + 1 : last]))
            farthest = int(np.argmax(off_m))
            if off_m[farthest] <= error_m and not near:
                continue
            middle = first + 1 + (farthest if off_m[farthest] > 0.0 else (last - first) // 2 - 1)
            kept.add(middle)
            split += [(first, middle), (middle, last)]
        open_legs = split
    return ring[sorted(kept)]


def _legs(pieces: BaseGeometry) -> NDArray[np.object_]:
    """Every leg of the outlines."""
    found = []
    for ring in shapely.get_rings(polygons(pieces)):
        corners = shapely.get_coordinates(ring)
        found.append(np.stack((corners[:-1], corners[1:]), axis=1))
    legs: NDArray[np.object_] = shapely.linestrings(np.concatenate(found))
    return legs
