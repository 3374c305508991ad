"""Repairs shapes that are not valid: rings that cross or touch themselves, spikes, overlapping parts.

Where the readings of a broken line differ, the safe one is taken. Water becomes what is inside by the
even-odd rule; land becomes everything that its line encloses, and its convex hull where it crosses itself by
more than 1 % of its area, since the hull contains every order of the same corners. Each repair is a note with
its place and the area that changed. Shapes are in degrees, areas in notes in square metres.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LinearRing, MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from companion.core.geo import WGS84_A_M, WGS84_E2
from mission_tools.errors import MapError
from mission_tools.maps.chart import Area, area_of

THIN_M = 0.1  # half the width that a line or a spike of land gets
SHORT_SPIKE_M = 1.0  # a spike into the water that is shorter is a slip of the pen
LARGE_SHARE = 0.01
LEAST_WATER_M2 = 0.01
MOST_CROSSINGS = 1000  # of a line with itself; more take seconds to resolve
_SEGMENTS_AT_ONCE = 256


class Repaired(NamedTuple):
    """A valid shape, empty if nothing is left of it, and what was done to it."""

    shape: Area
    notes: tuple[str, ...] = ()


def repaired(shape: Area, where: str, *, is_land: bool) -> Repaired:
    """Make (multi)polygons valid; `where` begins notes. Raises MapError: a line crosses itself too often."""
    if shape.is_valid and not shape.is_empty:
        if is_land or square_metres(shape) > LEAST_WATER_M2:
            return Repaired(shape)
        return Repaired(MultiPolygon(), (f"{where}: encloses nothing: skipped",))
    polygons = list(shape.geoms) if isinstance(shape, MultiPolygon) else [shape]
    notes: list[str] = []
    parts = [_polygon(part, where, notes, is_land=is_land) for part in polygons]
    parts = [part for part in parts if not part.is_empty]
    if not parts:
        return Repaired(MultiPolygon(), (*notes, f"{where}: encloses nothing: skipped"))
    return Repaired(_joined(parts, where, notes, is_land=is_land), tuple(notes))


def thickened(shape: BaseGeometry) -> Area:
    """A line or a point as an area of 0.2 m, for things that are drawn without a width."""
    return area_of(shape.buffer(_degrees(THIN_M, shape), quad_segs=4))


def square_metres(shape: BaseGeometry) -> float:
    """The area of a shape in degrees, on the ellipsoid at its middle."""
    if shape.is_empty:
        return 0.0
    north_m, east_m = _metres_per_deg(shape.centroid.y)
    return float(shape.area) * north_m * east_m


def place_of(x: float, y: float) -> str:
    """A position for messages."""
    return f"lat {y:.7f}, lon {x:.7f}"


def _polygon(polygon: Polygon, where: str, notes: list[str], *, is_land: bool) -> Area:
    outer = _ring(polygon.exterior, where, notes, is_land=is_land)
    holes = [
        _ring(ring, f"{where}, hole {n}", notes, is_land=not is_land)
        for n, ring in enumerate(polygon.interiors, 1)
    ]
    for n, hole in enumerate(holes, 1):
        if not hole.is_empty and not outer.covers(hole):
            at = shapely.get_coordinates(hole.difference(outer))
            place = f" at {place_of(*at[0])}" if len(at) else ""
            notes.append(f"{where}, hole {n}: reaches beyond its outline{place}: cut off there")
    return area_of(outer.difference(shapely.union_all(holes)))


def _ring(ring: LinearRing, where: str, notes: list[str], *, is_land: bool) -> Area:
    """What a closed line encloses."""
    plain = Polygon(ring)
    if plain.is_valid:
        return plain
    reason, _, place = shapely.is_valid_reason(plain).rstrip("]").partition("[")
    if "elf-intersection" not in reason:
        return MultiPolygon()  # too few different corners to enclose anything
    at = place_of(*(float(number) for number in place.split()[:2]))
    crosses = f"{where}: its line crosses or touches itself at {at}"
    if _crosses_often(ring):
        raise MapError(f"{crosses}, and in more than {MOST_CROSSINGS} places: draw it anew")
    line = shapely.union_all(ring)
    faces = [face for face in shapely.get_parts(shapely.polygonize([line])) if face.area > 0.0]
    if not faces:
        return MultiPolygon()
    enclosed = area_of(shapely.union_all(faces))
    corners = shapely.get_coordinates(ring)
    sure = area_of(shapely.union_all([face for face in faces if _is_odd(corners, face)]))
    if is_land:
        minor = enclosed.area - max(face.area for face in shapely.get_parts(enclosed))
        found = enclosed if minor <= LARGE_SHARE * enclosed.area else area_of(enclosed.convex_hull)
        added = square_metres(found) - square_metres(sure)
        notes.append(f"{crosses}: repaired, {_amount(added)} of water taken as land")
        return found
    spikes = shapely.line_merge(line.difference(shapely.union_all(sure.boundary)))
    inward = [
        spike for spike in shapely.get_parts(spikes) if _metres(spike) > SHORT_SPIKE_M and sure.covers(spike)
    ]
    left_out = square_metres(enclosed) - square_metres(sure)
    notes.append(f"{crosses}: repaired, {_amount(left_out)} of water left out")
    for spike in inward:
        length_m = _metres(spike)
        notes.append(
            f"{where}: a spike of {length_m:.1f} m into the water at "
            f"{place_of(*spike.coords[0])}: kept as land of {2 * THIN_M:g} m width"
        )
    return area_of(sure.difference(shapely.union_all([thickened(spike) for spike in inward])))


def _crosses_often(ring: LinearRing) -> bool:
    """Whether there are more than MOST_CROSSINGS pairs of segments that meet and are no neighbours."""
    corners = shapely.get_coordinates(ring)
    segments = shapely.linestrings(np.stack((corners[:-1], corners[1:]), axis=1))
    tree, count = shapely.STRtree(segments), 0
    for begin in range(0, len(segments), _SEGMENTS_AT_ONCE):
        some = segments[begin : begin + _SEGMENTS_AT_ONCE]
        count += tree.query(some, "intersects").shape[1] - 3 * len(some)  # itself and its two neighbours
        if count > 2 * MOST_CROSSINGS:  # each pair counts twice
            return True
    return False


def _is_odd(corners: NDArray[np.float64], face: Polygon) -> bool:
    """Whether a closed line goes round a face an odd number of times; make_valid errs on retraced edges."""
    at = face.representative_point()
    (x1, y1), (x2, y2) = corners[:-1].T, corners[1:].T
    spans = (y1 > at.y) != (y2 > at.y)
    x = x1[spans] + (at.y - y1[spans]) / (y2[spans] - y1[spans]) * (x2[spans] - x1[spans])
    return bool(np.count_nonzero(x > at.x) % 2)


def _joined(parts: Sequence[Area], where: str, notes: list[str], *, is_land: bool) -> Area:
    """Parts of a multipolygon. One within another is the island that a missing hole stands for."""
    if len(parts) == 1:
        return parts[0]
    if is_land:
        return area_of(shapely.union_all(parts))
    tree = shapely.STRtree(parts)
    islands: list[Area] = []
    water: list[Area] = []
    for n, part in enumerate(parts):
        around = [m for m in tree.query(part, "covered_by").tolist() if m != n and parts[m].area > part.area]
        (islands if around else water).append(part)
        if around:
            at = place_of(*shapely.get_coordinates(part)[0])
            notes.append(
                f"{where}: part {n + 1} lies within part {around[0] + 1} at {at}: "
                f"{_amount(square_metres(part))} taken as an island"
            )
    return area_of(shapely.union_all(water).difference(shapely.union_all(islands)))


def _degrees(metres: float, near: BaseGeometry) -> float:
    """A length of at least so many metres in any direction."""
    _, south, _, north = near.bounds
    return metres / min(_metres_per_deg(min(max(abs(south), abs(north)), 89.0)))


def _metres(line: BaseGeometry) -> float:
    north_m, east_m = _metres_per_deg(line.centroid.y)
    return float(shapely.transform(line, lambda lon_lat: lon_lat * [east_m, north_m]).length)


def _metres_per_deg(lat_deg: float) -> tuple[float, float]:
    """Of latitude and of longitude (Snyder, equations 4-18 and 4-20)."""
    lat = math.radians(lat_deg)
    w = 1.0 - WGS84_E2 * math.sin(lat) ** 2
    per_rad = WGS84_A_M / math.sqrt(w)
    return math.radians(per_rad * (1.0 - WGS84_E2) / w), math.radians(per_rad * math.cos(lat))


def _amount(square: float) -> str:
    return "nothing" if square < 0.005 else f"{square:.2g} m²" if square < 10.0 else f"{square:.0f} m²"
