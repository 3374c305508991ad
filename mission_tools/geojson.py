"""GeoJSON (RFC 7946), read and written the same way by planner, station and page; without numpy and shapely.

What a feature of a map is, says its property `kind`, or else its OpenStreetMap tags.
"""

import sys
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final, Literal, get_args

from mission_tools.errors import MapError

Kind = Literal["water", "island", "obstacle", "pier", "raft", "keep_out", "swimming", "bridge", "landmark"]

KINDS: Final[tuple[str, ...]] = get_args(Kind)
KEPT_OUT: Final = frozenset({"keep_out", "swimming"})
SOLID: Final = frozenset({"island", "obstacle", "pier", "raft"})
FENCE_KINDS: Final[Mapping[object, str]] = {
    5001: "inclusion",
    5002: "exclusion",
    5003: "inclusion",
    5004: "exclusion",
}
"""The property `kind` of a fence's area, by MAV_CMD_NAV_FENCE_…"""
MOST_LON_DEG: Final = 360.0

# https://wiki.openstreetmap.org/wiki/Map_features; land first: an island in a lake may carry the lake's tags
_LAND: Final = {
    "place": ("island", "islet", "archipelago"),
    "natural": (
        *("land", "coastline", "beach", "sand", "shingle", "rock", "bare_rock", "stone", "scree", "reef"),
        *("shoal", "wetland", "mud", "wood", "tree_group", "scrub", "heath", "grassland", "fell", "cliff"),
    ),
}
_STRUCTURES: Final = {
    "man_made": ("pier", "breakwater", "groyne", "jetty", "dyke", "embankment", "bridge", "quay"),
    "waterway": ("dam", "weir", "lock_gate"),
}
_WATER: Final = {
    "natural": ("water", "bay", "strait"),
    "place": ("sea", "ocean"),
    "waterway": ("riverbank", "river", "canal", "dock", "fairway", "stream", "ditch", "drain"),
    "landuse": ("reservoir", "basin", "salt_pond"),
}


def feature(geometry: str | None, coordinates: Sequence[Any] = (), /, **properties: object) -> dict[str, Any]:
    """A feature to write; without a geometry it has no place."""
    shape = None if geometry is None else {"type": geometry, "coordinates": coordinates}
    return {"type": "Feature", "properties": properties, "geometry": shape}


def collection(features: Sequence[Mapping[str, Any]], **members: object) -> dict[str, Any]:
    """A FeatureCollection to write."""
    return {"type": "FeatureCollection", **members, "features": features}


def entries_of(tree: object, source: str) -> list[Any]:
    """The features of any kind of GeoJSON; `source` begins error messages. Raises MapError: it is none."""
    if isinstance(tree, Mapping):
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
    """A feature's name for messages, its properties and its geometry. Raises MapError: it has no geometry."""
    if not isinstance(entry, Mapping) or not isinstance(entry.get("geometry"), Mapping):
        raise MapError(f"{where}: no geometry: expected a Feature with a Polygon or a Point")
    properties = entry.get("properties")
    properties = properties if isinstance(properties, Mapping) else {}
    name = properties.get("name")
    return f'{where} "{name}"' if isinstance(name, str) and name else where, properties, entry["geometry"]


def simple_geometries(geometry: Mapping[str, Any], where: str) -> Iterator[Mapping[str, Any]]:
    """The geometries of a collection, or the single one. Raises MapError: something else in it."""
    if geometry.get("type") != "GeometryCollection":
        yield geometry
        return
    members = geometry.get("geometries")
    for member in members if isinstance(members, list) else []:
        if not isinstance(member, Mapping):
            raise MapError(
                f"{where}: a GeometryCollection with {str(member)[:40]} in it: expected geometries"
            )
        if member.get("type") != "GeometryCollection":  # RFC 7946, 3.1.8: none within another
            yield member


def position(value: object, where: str, most_lat_deg: float = 90.0) -> tuple[float, float]:
    """Longitude and latitude in degrees; longitudes beyond ±180° are the antimeridian's other side. Raises
    MapError: not two numbers, or not on Earth, or beyond a latitude.
    """
    numbers = value if isinstance(value, list) else []
    if len(numbers) < 2 or not all(map(_is_finite, numbers[:2])):
        raise MapError(f"{where}: expected [longitude, latitude], got {str(value)[:60]}")
    lon_deg, lat_deg = float(numbers[0]), float(numbers[1])
    if abs(lat_deg) > most_lat_deg or abs(lon_deg) > MOST_LON_DEG:
        swapped = abs(lat_deg) <= 180.0 and abs(lon_deg) <= most_lat_deg
        hint = "longitude and latitude look swapped: " if swapped else ""
        raise MapError(
            f"{where}: [{lon_deg:g}, {lat_deg:g}] is out of range: {hint}expected [longitude, latitude]"
        )
    return lon_deg, lat_deg


def _is_finite(value: object) -> bool:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return abs(value) <= sys.float_info.max  # an integer of thousands of digits is not


def tagged_kind(properties: Mapping[str, Any]) -> Kind | None:
    """What the tags of OpenStreetMap say; None where they say nothing that is known here."""
    if _has(properties, _LAND):
        return "island"
    if _has(properties, _STRUCTURES):
        return "pier"
    if properties.get("building") not in (None, "no"):
        return "obstacle"
    return "water" if _has(properties, _WATER) else None


def _has(properties: Mapping[str, Any], tags: Mapping[str, Sequence[str]]) -> bool:
    return any(properties.get(key) in values for key, values in tags.items())
