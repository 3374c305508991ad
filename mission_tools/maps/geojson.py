"""GeoJSON (RFC 7946) maps: a FeatureCollection, a Feature or a geometry, in WGS 84 [longitude, latitude].

The property `kind` says what a feature is, or else its OpenStreetMap tags (`kinds.py`); without either it is
water, so a plain lake works as it is. Water without a kind within other water is refused: it may be an
island. A member `crs` is obeyed (`crs.py`).

| kind | shape | means |
|---|---|---|
| water | polygon | where the boat may be; rings inside are islands; several are joined |
| island, obstacle, pier, raft | polygon | cut out of the water |
| keep_out, swimming | polygon | water that the boat keeps out of |
| landmark | point | a name on the picture, nothing else |
"""

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, cast

import shapely
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from companion.core.geo import LatLon, LocalFrame
from mission_tools.errors import MapError
from mission_tools.maps.chart import Area, Chart, Feature, Kind, build_chart
from mission_tools.maps.crs import to_wgs84
from mission_tools.maps.kinds import kind_of, raise_if_ambiguous
from mission_tools.maps.projection import to_local

_CROSSINGS = ("Self-intersection", "Ring Self-intersection")
MAX_DISTANCE_FROM_ORIGIN_M = 100_000.0


def load_geojson(path: Path, origin: LatLon | None = None) -> Chart:
    """Read a map; without an origin the middle of its water becomes one.

    Raises:
        MapError: cannot be read, is not GeoJSON, a shape is not valid, or there is no water in it; one line
            that names the file, the feature and the place.
    """
    return parse_geojson(read_json(path), str(path), path.stem, origin)


def read_json(path: Path) -> object:
    """What is in a file of JSON.

    Raises:
        MapError: cannot be read, or is not JSON.
    """
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise MapError(f"{path}: cannot be read: {error.strerror}") from None
    except json.JSONDecodeError as error:
        raise MapError(f"{path}: line {error.lineno}: not JSON: {error.msg}") from None
    except (ValueError, RecursionError):  # not UTF-8, a number of thousands of digits, or nested too deep
        raise MapError(f"{path}: not a JSON text file") from None


def parse_geojson(tree: object, source: str, name: str, origin: LatLon | None = None) -> Chart:
    """Build a chart from decoded JSON; `source` stands before every error message.

    Raises:
        MapError: as `load_geojson`.
    """
    features = map_features(feature_entries(tree, source), source)
    water = _area([feature for feature in features if feature.kind == "water"])
    if water is None:
        raise MapError(
            f"{source}: no water in it: expected a polygon with the property kind = water, or none"
        )
    west, south, east, north = water.bounds
    frame = LocalFrame(origin or LatLon(0.5 * (south + north), 0.5 * (west + east)))
    local = to_local(water, frame.origin)
    if local.distance(shapely.Point(0.0, 0.0)) > MAX_DISTANCE_FROM_ORIGIN_M:
        raise MapError(
            f"{source}: lies more than {MAX_DISTANCE_FROM_ORIGIN_M / 1000:.0f} km from the origin "
            f"{frame.origin.lat_deg:.4f}, {frame.origin.lon_deg:.4f}: GeoJSON wants [longitude, latitude]"
        )
    named = [
        Feature(feature.name, feature.kind, to_local(feature.shape, frame.origin))
        for feature in features
        if feature.name
    ]
    title = tree.get("name") if isinstance(tree, Mapping) else None
    first = next((feature.name for feature in features if feature.kind == "water" and feature.name), name)
    try:
        return build_chart(title if isinstance(title, str) else first, frame, cast(Area, local), named)
    except MapError as error:
        raise MapError(f"{source}: {error}") from None


def map_features(entries: Sequence[object], source: str) -> list[Feature]:
    """The features of a map, in degrees: x longitude, y latitude.

    Raises:
        MapError: names the feature and what is wrong with it.
    """
    features: list[Feature] = []
    water: list[tuple[str, BaseGeometry, bool]] = []
    for number, entry in enumerate(entries, 1):
        where, properties, geometry = labelled(entry, f"{source}: feature {number}")
        kind, is_said = kind_of(properties, where)
        feature = _feature(kind, properties, geometry, where)
        features.append(feature)
        if kind == "water":
            water.append((where, feature.shape, is_said))
    raise_if_ambiguous(water)
    return features


def _area(features: Sequence[Feature]) -> BaseGeometry | None:
    return shapely.union_all([feature.shape for feature in features]) if features else None


def feature_entries(tree: object, source: str) -> list[Mapping[str, Any]]:
    """The features of whatever kind of GeoJSON this is.

    Raises:
        MapError: it is none.
    """
    if isinstance(tree, Mapping):
        tree = to_wgs84(tree, source)
        kind = tree.get("type")
        if kind == "FeatureCollection" and isinstance(tree.get("features"), list):
            return list(tree["features"])
        if kind == "Feature":
            return [tree]
        if kind in ("Polygon", "MultiPolygon"):
            return [{"type": "Feature", "properties": {}, "geometry": tree}]
        if kind == "GeometryCollection":
            raise MapError(f"{source}: a GeometryCollection: expected Polygon or MultiPolygon features")
    raise MapError(f"{source}: not GeoJSON: expected a FeatureCollection, a Feature or a Polygon")


def labelled(entry: object, where: str) -> tuple[str, Mapping[str, Any], Mapping[str, Any]]:
    """A feature's name for messages, its properties and its geometry.

    Raises:
        MapError: it has no geometry.
    """
    if not isinstance(entry, Mapping) or not isinstance(entry.get("geometry"), Mapping):
        raise MapError(f"{where}: no geometry: expected a Feature with a Polygon or a Point")
    properties = entry.get("properties")
    properties = properties if isinstance(properties, Mapping) else {}
    name = properties.get("name")
    return f'{where} "{name}"' if isinstance(name, str) and name else where, properties, entry["geometry"]


def _feature(kind: Kind, properties: Mapping[str, Any], geometry: Mapping[str, Any], where: str) -> Feature:
    given = properties.get("name")
    name = given if isinstance(given, str) else ""
    if kind == "landmark":
        return Feature(name, kind, _landmark(geometry, where))
    shape = _polygons(geometry, where)
    return Feature(name or ("" if kind == "water" else kind.replace("_", "-")), kind, shape)


def _landmark(geometry: Mapping[str, Any], where: str) -> BaseGeometry:
    if geometry.get("type") != "Point":
        raise MapError(f"{where}: a landmark is a Point, not {geometry.get('type')!r}")
    return shapely.Point(position(geometry.get("coordinates"), where))


def polygon_parts(geometry: Mapping[str, Any], where: str) -> list[Polygon]:
    """The polygons of a Polygon or MultiPolygon, in degrees: x longitude, y latitude.

    Raises:
        MapError: another geometry, or rings that are no polygon.
    """
    kind, coordinates = geometry.get("type"), geometry.get("coordinates")
    if kind not in ("Polygon", "MultiPolygon"):
        raise MapError(f"{where}: geometry is {kind!r}: expected Polygon or MultiPolygon")
    if not isinstance(coordinates, list) or not coordinates:
        raise MapError(f"{where}: empty geometry")
    if kind == "Polygon":
        return [_polygon(coordinates, where)]
    return [_polygon(rings, f"{where}, part {n}") for n, rings in enumerate(coordinates, 1)]


def _polygons(geometry: Mapping[str, Any], where: str) -> Area:
    parts = polygon_parts(geometry, where)
    if geometry["type"] == "Polygon":
        return parts[0]
    shape = MultiPolygon(parts)
    _checked(shape, where)
    return shape


def _polygon(rings: object, where: str) -> Polygon:
    if not isinstance(rings, list) or not rings:
        raise MapError(f"{where}: empty geometry")
    outer, *holes = (_ring(ring, f"{where}, ring {n}") for n, ring in enumerate(rings, 1))
    shape = Polygon(outer, holes)
    _checked(shape, where)
    return shape


def _ring(ring: object, where: str) -> list[tuple[float, float]]:
    if not isinstance(ring, list) or not ring:
        raise MapError(f"{where}: empty ring")
    corners = [position(corner, f"{where}, position {n}") for n, corner in enumerate(ring, 1)]
    if len(corners) < 4:
        raise MapError(f"{where}: {len(corners)} positions: a closed ring has at least 4")
    if corners[0] != corners[-1]:
        raise MapError(f"{where}: not closed: ends at {_at(*corners[-1])}, began at {_at(*corners[0])}")
    return corners


def position(value: object, where: str) -> tuple[float, float]:
    """Longitude and latitude in degrees.

    Raises:
        MapError: not two numbers, or not on Earth.
    """
    numbers = value if isinstance(value, list) else []
    if len(numbers) < 2 or not all(
        isinstance(n, int | float) and not isinstance(n, bool) and math.isfinite(n) for n in numbers[:2]
    ):
        raise MapError(f"{where}: expected [longitude, latitude], got {str(value)[:60]}")
    lon_deg, lat_deg = float(numbers[0]), float(numbers[1])
    if abs(lat_deg) > 90.0 or abs(lon_deg) > 180.0:
        swapped = abs(lat_deg) <= 180.0 and abs(lon_deg) <= 90.0
        hint = "longitude and latitude look swapped: " if swapped else ""
        raise MapError(
            f"{where}: [{lon_deg:g}, {lat_deg:g}] is out of range: {hint}expected [longitude, latitude]"
        )
    return lon_deg, lat_deg


def _checked(shape: Area, where: str) -> None:
    if shape.is_valid:
        return
    reason, _, place = shapely.is_valid_reason(shape).rstrip("]").partition("[")
    said = "a ring crosses or touches itself" if reason in _CROSSINGS else reason.lower()
    lon_deg, lat_deg = (float(number) for number in place.split()[:2])
    raise MapError(f"{where}: not a valid polygon: {said} at {_at(lon_deg, lat_deg)}")


def _at(lon_deg: float, lat_deg: float) -> str:
    return f"lat {lat_deg:.7f}, lon {lon_deg:.7f}"
