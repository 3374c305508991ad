"""The map file of the chart: GeoJSON as the planner takes it, bounded in size, depth and detail.

The property `kind` says what a feature is, or else its OpenStreetMap tags; a polygon without either is water.
Polygons whose tags are not known to mean water are land: a way never leads over them.
"""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import msgspec

from companion.core.geo import LatLon, LocalFrame, Point
from companion.core.status_text import one_line
from mission_tools.errors import MapError
from mission_tools.geojson import KINDS, entries_of, labelled, position, simple_geometries, tagged_kind

MOST_BYTES = 4_000_000
MOST_FEATURES = 2_000
MOST_POSITIONS = 50_000
MOST_NAME = 60  # characters
MOST_EXTENT_M = 100_000.0  # from the middle; beyond it the local frame is no longer exact
MOST_LAT_DEG = 85.0  # likewise
_TELLING_TAGS = ("natural", "place", "waterway", "landuse", "man_made", "building")
_WGS84 = ("CRS84", "4326")


class Shape(NamedTuple):
    """A feature. rings: of each polygon; the first is its outline, the others are holes, none is closed.

    lines, places: of what is drawn without an area.
    """

    kind: str
    name: str
    polygons: tuple[tuple[tuple[Point, ...], ...], ...]
    lines: tuple[tuple[Point, ...], ...]


class MapFile(NamedTuple):
    """What a file holds, in metres of a frame at its middle."""

    name: str
    frame: LocalFrame
    shapes: tuple[Shape, ...]


class _Raw(NamedTuple):
    kind: str
    name: str
    polygons: list[list[list[LatLon]]]
    lines: list[list[LatLon]]


def read_map(path: Path) -> MapFile:
    """Read a map; MapError names the file and what was expected."""
    tree = _decoded(path)
    raws: list[_Raw] = []
    count = 0
    for number, entry in enumerate(_features(tree, path), 1):
        if isinstance(entry, Mapping) and entry.get("geometry") is None:
            continue
        raw = _raw(entry, f"{path}: feature {number}")
        count += sum(len(ring) for rings in raw.polygons for ring in rings) + sum(map(len, raw.lines))
        if count > MOST_POSITIONS:
            raise MapError(f"{path}: more than {MOST_POSITIONS} positions: cut out what matters")
        raws.append(raw)
    if not any(raw.polygons for raw in raws if raw.kind != "landmark"):
        raise MapError(f"{path}: no water and no land in it: expected polygons with the property kind")
    frame = LocalFrame(_middle(raws))
    shapes = tuple(_local(raw, frame, path) for raw in raws)
    title = _clean(tree.get("name"))
    return MapFile(title or next((r.name for r in raws if r.kind == "water" and r.name), ""), frame, shapes)


def _decoded(path: Path) -> Mapping[str, Any]:
    try:
        if not path.is_file():
            raise MapError(f"{path}: no such file: expected a GeoJSON map")
        with path.open("rb") as file:
            data = file.read(MOST_BYTES + 1)
    except OSError as error:
        raise MapError(f"{path}: cannot be read: {error.strerror}") from None
    if len(data) > MOST_BYTES:
        raise MapError(f"{path}: more than {MOST_BYTES // 1_000_000} MB: cut out what matters")
    try:
        tree = msgspec.json.decode(data.removeprefix(b"\xef\xbb\xbf"))
    except (ValueError, RecursionError):  # msgspec's own errors are ValueErrors
        raise MapError(f"{path}: not JSON: expected a GeoJSON map") from None
    if not isinstance(tree, Mapping):
        raise MapError(f"{path}: not GeoJSON: expected a FeatureCollection, a Feature or a Polygon")
    return tree


def _features(tree: Mapping[str, Any], path: Path) -> Sequence[object]:
    crs = tree.get("crs")
    if crs is not None and not any(name in str(crs)[:400] for name in _WGS84):
        raise MapError(f"{path}: member crs: expected WGS 84 degrees (CRS84)")
    features = entries_of(tree, str(path))
    if len(features) > MOST_FEATURES:
        raise MapError(f"{path}: {len(features)} features: at most {MOST_FEATURES}; cut out what matters")
    return features


def _raw(entry: object, where: str) -> _Raw:
    _, properties, whole = labelled(entry, where)
    raw = _Raw(_kind(properties, where), _clean(properties.get("name")), [], [])
    for geometry in simple_geometries(whole, where):
        kind, coordinates = geometry.get("type"), geometry.get("coordinates")
        if kind == "Polygon":
            raw.polygons.append(_rings(coordinates, where))
        elif kind == "MultiPolygon":
            raw.polygons.extend(_rings(rings, where) for rings in _list(coordinates, where))
        elif kind == "Point":
            raw.lines.append([_position(coordinates, where)])
        elif kind in ("LineString", "MultiPoint"):
            line = [_position(place, where) for place in _list(coordinates, where)]
            raw.lines.extend([line] if kind == "LineString" else [[place] for place in line])
        elif kind == "MultiLineString":
            raw.lines.extend(
                [_position(place, where) for place in _list(line, where)]
                for line in _list(coordinates, where)
            )
        else:
            raise MapError(f"{where}: geometry is {str(kind)[:40]!r}: expected Polygon or MultiPolygon")
    raw.polygons[:] = [rings for rings in raw.polygons if rings]
    raw.lines[:] = [line for line in raw.lines if line]
    return raw


def _kind(properties: Mapping[str, Any], where: str) -> str:
    if "kind" in properties:
        kind = properties["kind"]
        if not isinstance(kind, str) or kind not in KINDS:
            raise MapError(f"{where}: kind {str(kind)[:40]!r}: expected one of {', '.join(KINDS)}")
        return kind
    is_unknown = any(properties.get(key) for key in _TELLING_TAGS)
    return tagged_kind(properties) or ("obstacle" if is_unknown else "water")


def _rings(rings: object, where: str) -> list[list[LatLon]]:
    """Open rings; those with fewer than three corners are left out, with the holes if it is the outline."""
    kept: list[list[LatLon]] = []
    for number, ring in enumerate(_list(rings, where)):
        corners = [_position(place, where) for place in _list(ring, where)]
        if len(corners) > 1 and corners[0] == corners[-1]:
            corners.pop()
        if len(corners) >= 3:
            kept.append(corners)
        elif number == 0:
            return []
    return kept


def _list(value: object, where: str) -> list[Any]:
    if not isinstance(value, list):
        raise MapError(f"{where}: expected a list of positions, got {str(value)[:40]}")
    return value


def _position(value: object, where: str) -> LatLon:
    lon_deg, lat_deg = position(value, where, MOST_LAT_DEG)
    return LatLon(lat_deg, math.remainder(lon_deg, 360.0))


def _middle(raws: Sequence[_Raw]) -> LatLon:
    """Of the water, or of the rest in open water, as a first corner sees it: also across the antimeridian."""
    areas = [raw for raw in raws if raw.kind == "water" and raw.polygons] or raws
    corners = [corner for raw in areas for rings in raw.polygons for corner in rings[0]]
    frame = LocalFrame(corners[0])
    points = [frame.to_local(corner) for corner in corners]
    north = [point.north_m for point in points]
    east = [point.east_m for point in points]
    middle = Point(0.5 * (min(north) + max(north)), 0.5 * (min(east) + max(east)))
    if max(map(abs, (*north, *east))) > 2.0 * MOST_EXTENT_M:
        return corners[0]  # refused afterwards
    return frame.to_global(middle)


def _local(raw: _Raw, frame: LocalFrame, path: Path) -> Shape:
    def point(place: LatLon) -> Point:
        at = frame.to_local(place)
        if not max(abs(at.north_m), abs(at.east_m)) <= MOST_EXTENT_M:
            raise MapError(
                f"{path}: reaches {place.lat_deg:.4f}, {place.lon_deg:.4f}: expected a map within "
                f"{MOST_EXTENT_M / 1000.0:.0f} km of its middle; cut out what matters"
            )
        return at

    return Shape(
        raw.kind,
        raw.name,
        tuple(tuple(tuple(map(point, ring)) for ring in rings) for rings in raw.polygons),
        tuple(tuple(map(point, line)) for line in raw.lines),
    )


def _clean(name: object) -> str:
    """A name that can be shown."""
    text = name if isinstance(name, str) else ""
    return one_line(text[: 4 * MOST_NAME]).strip()[:MOST_NAME]
