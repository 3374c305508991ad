"""GeoJSON (RFC 7946) maps: a FeatureCollection, a Feature or a geometry, in WGS 84 [longitude, latitude].

The property `kind` says what a feature is, or else its OpenStreetMap tags (`assemble.py`); without either it
is water, so a plain lake works as it is. Water without a kind within other water is refused: it may be an
island. A member `crs` is obeyed (`crs.py`).

| kind | shape | means |
|---|---|---|
| water | polygon | where the boat may be; rings inside are islands; several are joined |
| island, obstacle, pier, raft | polygon | cut out of the water |
| keep_out, swimming | polygon | water that the boat keeps out of |
| bridge | polygon, line | passed below, where it is higher than the boat |
| landmark | point | a name on the picture, nothing else |
"""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from companion.core.geo import LatLon
from mission_tools.errors import MapError
from mission_tools.geojson import MOST_LON_DEG, entries_of, labelled, position, simple_geometries
from mission_tools.maps.assemble import chart_of
from mission_tools.maps.chart import Chart
from mission_tools.maps.raw import RawFeature, RawMap, read_bytes
from mission_tools.maps.repair import place_of

Corners = list[tuple[float, float]]

_CROSSINGS = ("Self-intersection", "Ring Self-intersection")


def load_geojson(path: Path, origin: LatLon | None = None) -> Chart:
    """Read a map; without an origin the middle of its water becomes one. Raises MapError: cannot be read, is
    not GeoJSON, a shape cannot be used, or there is no water in it; one line that names the file, the feature
    and the place.
    """
    return parse_geojson(read_json(path), str(path), path.stem, origin)


def read_json(path: Path) -> object:
    """A file of JSON; a byte order mark is ignored. Raises MapError: cannot be read, or is not JSON."""
    try:
        return json.loads(read_bytes(path).decode("utf-8-sig"))
    except json.JSONDecodeError as error:
        raise MapError(f"{path}: line {error.lineno}: not JSON: {error.msg}") from None
    except MapError:
        raise
    except (ValueError, RecursionError):  # not UTF-8, a number of thousands of digits, or nested too deep
        raise MapError(f"{path}: not a JSON text file") from None


def parse_geojson(tree: object, source: str, name: str, origin: LatLon | None = None) -> Chart:
    """Build a chart from decoded JSON; `source` begins messages. Raises MapError: as `load_geojson`."""
    title = tree.get("name") if isinstance(tree, Mapping) else None
    raw = raw_map(feature_entries(tree, source), source, name, title if isinstance(title, str) else "")
    return chart_of(raw, origin)


def raw_map(entries: Sequence[object], source: str, fallback_name: str = "", title: str = "") -> RawMap:
    """A map's features as in the file. Raises MapError: names the feature and what is wrong with it."""
    notes: list[str] = []
    features: list[RawFeature] = []
    for number, entry in enumerate(entries, 1):
        where = f"{source}: feature {number}"
        if isinstance(entry, Mapping) and entry.get("geometry") is None:
            notes.append(f"{where}: no geometry: skipped")
            continue
        where, properties, geometry = labelled(entry, where)
        for part in simple_geometries(geometry, where):
            shape = _shape(part, where, notes)
            if shape is not None:
                features.append(RawFeature(where, properties, shape))
    return RawMap(source, fallback_name, tuple(features), title, tuple(notes))


def feature_entries(tree: object, source: str) -> list[Any]:
    """The features of whatever kind of GeoJSON this is, in WGS 84. Raises MapError: it is none."""
    if isinstance(tree, Mapping):
        features = tree.get("features")
        entries = features if isinstance(features, list) else []
        if any(isinstance(entry, Mapping) and entry.get("crs") for entry in entries):
            raise MapError(f"{source}: a feature has a crs of its own: expected one for the whole file")
        if tree.get("crs") is not None:
            from mission_tools.maps.crs import to_wgs84  # noqa: PLC0415 (PROJ takes 0.1 s to import)

            tree = to_wgs84(tree, source)
    return entries_of(tree, source)


def _shape(geometry: Mapping[str, Any], where: str, notes: list[str]) -> BaseGeometry | None:
    """A geometry as it is in the file, its rings closed; None with a note for an empty one."""
    kind, coordinates = geometry.get("type"), geometry.get("coordinates")
    if kind not in ("Polygon", "MultiPolygon", "Point", "MultiPoint", "LineString", "MultiLineString"):
        raise MapError(f"{where}: geometry is {kind!r}: expected Polygon or MultiPolygon")
    if not isinstance(coordinates, list) or not coordinates:
        notes.append(f"{where}: empty geometry: skipped")
        return None
    if kind == "Polygon":
        return _open_polygon(coordinates, where, notes)
    if kind == "MultiPolygon":
        parts = [_open_polygon(rings, f"{where}, part {n}", notes) for n, rings in enumerate(coordinates, 1)]
        return MultiPolygon([part for part in parts if part is not None])
    if kind == "Point":
        return shapely.Point(position(coordinates, where))
    lists = coordinates if kind == "MultiLineString" else [coordinates]
    if not all(isinstance(places, list) for places in lists):
        raise MapError(f"{where}: expected lists of positions, got {str(coordinates)[:60]}")
    lines = [[position(place, where) for place in places] for places in lists]
    if kind == "MultiPoint":
        return shapely.MultiPoint(lines[0])
    lines = [line for line in lines if len(line) > 1]
    return shapely.LineString(lines[0]) if len(lines) == 1 else shapely.MultiLineString(lines)


def _open_polygon(rings: object, where: str, notes: list[str]) -> Polygon | None:
    """A polygon that may be invalid; None with a note where it has no outline."""
    if not isinstance(rings, list):
        raise MapError(f"{where}: expected a list of rings, got {str(rings)[:60]}")
    if not rings:
        notes.append(f"{where}: empty geometry: skipped")
        return None
    closed = [_closed(ring, f"{where}, ring {n}", notes) for n, ring in enumerate(rings, 1)]
    outer, *holes = closed
    return None if outer is None else Polygon(outer, [hole for hole in holes if hole is not None])


def _closed(ring: object, where: str, notes: list[str]) -> Corners | None:
    if not isinstance(ring, list):
        raise MapError(f"{where}: expected a list of positions, got {str(ring)[:60]}")
    return closed_ring(_corners(ring, where), where, notes)


def closed_ring(corners: Corners, where: str, notes: list[str]) -> Corners | None:
    """The corners, closed if they were not; None with a note if they are too few for an area."""
    if corners and corners[0] != corners[-1]:
        notes.append(
            f"{where}: not closed: ends at {place_of(*corners[-1])}, began at {place_of(*corners[0])}: closed"
        )
        corners = [*corners, corners[0]]
    if len(corners) < 4:
        said = f"{len(corners)} positions: a closed ring has at least 4" if corners else "empty ring"
        notes.append(f"{where}: {said}: skipped")
        return None
    return corners


def _corners(ring: list[Any], where: str) -> Corners:
    """Longitude and latitude of each position."""
    try:
        array = np.array(ring)
    except ValueError:  # positions with and without altitude, or worse
        array = np.array(None)
    if array.ndim == 2 and array.shape[1] >= 2 and array.dtype.kind in "fi":
        flat = array[:, :2].astype(np.float64)
        if np.isfinite(flat).all() and (np.abs(flat) <= (MOST_LON_DEG, 90.0)).all():
            return list(map(tuple, flat.tolist()))
    return [position(corner, f"{where}, position {n}") for n, corner in enumerate(ring, 1)]


def polygon_parts(geometry: Mapping[str, Any], where: str) -> list[Polygon]:
    """The polygons of a Polygon or MultiPolygon, in degrees: x longitude, y latitude; nothing is repaired.
    Raises MapError: another geometry, or rings that are no polygon.
    """
    kind = geometry.get("type")
    if kind not in ("Polygon", "MultiPolygon"):
        raise MapError(f"{where}: geometry is {kind!r}: expected Polygon or MultiPolygon")
    faults: list[str] = []
    parts = list(shapely.get_parts(_shape(geometry, where, faults)))
    if faults:
        raise MapError(faults[0].removesuffix(": closed").removesuffix(": skipped"))
    for number, part in enumerate(parts, 1):
        _check_valid(part, where if kind == "Polygon" else f"{where}, part {number}")
    return parts


def _check_valid(shape: Polygon, where: str) -> None:
    if shape.is_valid:
        return
    reason, _, place = shapely.is_valid_reason(shape).rstrip("]").partition("[")
    said = "a ring crosses or touches itself" if reason in _CROSSINGS else reason.lower()
    lon_deg, lat_deg = (float(number) for number in place.split()[:2])
    raise MapError(f"{where}: not a valid polygon: {said} at {place_of(lon_deg, lat_deg)}")
