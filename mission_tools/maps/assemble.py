"""From the features of a map file to a chart: one set of rules for every format.

Shapes are made continuous across the antimeridian and valid (`repair.py`), classified, projected
(`projection.py`) and joined. What says of itself that it is solid is never dropped, also as a point or a
line; whatever else is no polygon is skipped with a note. A feature is what its property `kind` says, or
else its OpenStreetMap tags, or else water, so that a plain lake works as it is; but a shape within
another's water is then ambiguous, most likely an island.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple, cast

import shapely
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from companion.core.geo import LatLon, LocalFrame
from mission_tools.errors import MapError
from mission_tools.geojson import KEPT_OUT, KINDS, SOLID, Kind, tagged_kind
from mission_tools.maps.chart import PROPERTIES, Area, Chart, Feature, area_of, build_chart
from mission_tools.maps.projection import (
    continuous,
    densified,
    is_near_antimeridian,
    to_local,
    wrapped_lon_deg,
)
from mission_tools.maps.raw import RawFeature, RawMap
from mission_tools.maps.repair import repaired, thickened

MAX_DISTANCE_FROM_ORIGIN_M = 100_000.0
MAX_LAT_DEG = 85.0  # as far as the local frame is accurate
MAX_EXTENT_DEG = 9.0  # of the water, of a great circle: 1000 km
AROUND_DEG = 0.2  # of the water: what lies farther off is not on the chart
MOST_NOTES = 12  # lines for a person; more are counted
MOST_FEATURES = 200_000
INSIDE_SHARE = 0.5  # of a shape's area: a bay that is drawn as a piece of its own overlaps its lake by less
_TOLD = ("place", "natural", "man_made", "waterway", "building")  # whose unknown values are asked about


class Classified(NamedTuple):
    """A map's features in degrees, continuous and valid. Longitudes may be beyond ±180°."""

    features: tuple[Feature, ...]
    notes: tuple[str, ...]


class _Piece(NamedTuple):
    where: str
    feature: Feature
    is_said: bool  # the file says what it is


def chart_of(raw: RawMap, origin: LatLon | None = None) -> Chart:
    """The chart of a map; without an origin the middle of its water becomes one. Raises MapError: no water in
    it, an island that does not say so, or a map too large or too near a pole; names the file and, where there
    is one, the feature.
    """
    classified_map = classified(raw)
    features, notes = classified_map
    water = _union([feature.shape for feature in features if feature.kind == "water"])
    if water is None or water.is_empty:
        skipped = (
            f" ({'; '.join(note.removeprefix(raw.source + ': ') for note in notes[:2])})" if notes else ""
        )
        raise MapError(
            f"{raw.source}: no water in it: expected a polygon with the property kind = water, or none"
            + skipped
        )
    west, south, east, north = water.bounds
    if max(-south, north) > MAX_LAT_DEG:
        raise MapError(
            f"{raw.source}: reaches beyond {MAX_LAT_DEG:g}° of latitude: too near a pole to plan on"
        )
    widest = 1.0 if south < 0.0 < north else math.cos(math.radians(min(abs(south), abs(north))))
    if max(north - south, (east - west) * widest) > MAX_EXTENT_DEG:
        raise MapError(
            f"{raw.source}: its water spans {west:g} to {east:g} east and {south:g} to {north:g} north: "
            f"more than {MAX_EXTENT_DEG:g}°; cut out what matters"
        )
    frame = LocalFrame(origin or LatLon(0.5 * (south + north), wrapped_lon_deg(0.5 * (west + east))))
    local = _projected(water, raw, frame)
    if local.distance(shapely.Point(0.0, 0.0)) > MAX_DISTANCE_FROM_ORIGIN_M:
        raise MapError(
            f"{raw.source}: lies more than {MAX_DISTANCE_FROM_ORIGIN_M / 1000:.0f} km from the origin "
            f"{frame.origin.lat_deg:.4f}, {frame.origin.lon_deg:.4f}: GeoJSON wants [longitude, latitude]"
        )
    near = shapely.box(west - AROUND_DEG, south - AROUND_DEG, east + AROUND_DEG, north + AROUND_DEG)
    named = [
        replace(f, shape=_projected(_clipped(f.shape, near), raw, frame))
        for f in features
        if (f.name or PROPERTIES & f.properties.keys()) and f.shape.intersects(near)
    ]
    first = next((f.name for f in features if f.kind == "water" and f.name), raw.fallback_name)
    try:
        return build_chart(raw.title or first, frame, cast(Area, local), named, notes)
    except (MapError, shapely.GEOSException) as error:
        raise MapError(f"{raw.source}: {error}") from None


def classified(raw: RawMap) -> Classified:
    """What each feature is, repaired where that is needed. Raises MapError: a kind that does not exist, tags
    that say neither water nor land, or a possible island.
    """
    if len(raw.features) > MOST_FEATURES:
        raise MapError(
            f"{raw.source}: {len(raw.features)} features: at most {MOST_FEATURES}; cut out what matters"
        )
    notes = list(raw.notes)
    pieces: list[_Piece] = []
    for feature in _all_continuous(raw.features):
        piece = _piece(feature, raw, notes)
        if piece is not None:
            pieces.append(piece)
    features = _with_islands(pieces, raw, notes)
    if len(notes) > MOST_NOTES:
        notes[MOST_NOTES:] = [f"{raw.source}: {len(notes) - MOST_NOTES} more repaired or skipped"]
    return Classified(tuple(features), tuple(notes))


def _all_continuous(features: Sequence[RawFeature]) -> Sequence[RawFeature]:
    if not any(is_near_antimeridian(feature.shape) for feature in features if not feature.shape.is_empty):
        return features
    areas = [feature.shape for feature in features if isinstance(feature.shape, Polygon | MultiPolygon)]
    near = next((float(shapely.get_coordinates(area)[0, 0]) for area in areas if not area.is_empty), 180.0)
    return [
        feature if feature.shape.is_empty else feature._replace(shape=continuous(feature.shape, near))
        for feature in features
    ]


def _piece(raw_feature: RawFeature, raw: RawMap, notes: list[str]) -> _Piece | None:
    """One feature; None and a note for what is skipped."""
    where, properties, shape = raw_feature
    if shape.is_empty:
        notes.append(f"{where}: no geometry: skipped")
        return None
    is_area = isinstance(shape, Polygon | MultiPolygon)
    kind, is_said = _kind_of(properties, where, is_asked=is_area and raw.unlabelled != "skipped")
    if not is_said and raw.unlabelled == "skipped":
        return None
    name = properties.get("name")
    name = name if isinstance(name, str) else ""
    if kind == "landmark":
        return _Piece(where, Feature(name, kind, shape.centroid, properties), is_said)
    if not is_area:
        return _drawn_without_width(raw_feature, kind, name, notes)
    fixed = repaired(cast(Area, shape), where, is_land=kind != "water")
    notes.extend(fixed.notes)
    if fixed.shape.is_empty:
        return None
    return _Piece(where, Feature(name or _default_name(kind), kind, fixed.shape, properties), is_said)


def _drawn_without_width(raw_feature: RawFeature, kind: Kind, name: str, notes: list[str]) -> _Piece | None:
    """A point or a line: solid if it says so, else skipped."""
    where, properties, shape = raw_feature
    if kind not in SOLID | KEPT_OUT | {"bridge"}:
        notes.append(f"{where}: a {shape.geom_type}, which encloses no water: skipped")
        return None
    area = area_of(thickened(shape))
    return _Piece(where, Feature(name or _default_name(kind), kind, area, properties), True)


def _default_name(kind: Kind) -> str:
    return "" if kind == "water" else kind.replace("_", "-")


def _with_islands(pieces: Sequence[_Piece], raw: RawMap, notes: list[str]) -> list[Feature]:
    """Features, unlabelled ones within other water asked about or taken as land."""
    water = [(n, piece) for n, piece in enumerate(pieces) if piece.feature.kind == "water"]
    features = [piece.feature for piece in pieces]
    for inner, outer in _nested([piece for _, piece in water]):
        where, other = water[inner][1].where, water[outer][1].where.rpartition(": ")[2]
        if raw.nested == "asked about":
            raise MapError(
                f"{where}: lies within {other} and does not say what it is: "
                f"add the property kind, such as island (land in it) or water (to be sailed over)"
            )
        n, piece = water[inner]
        features[n] = replace(piece.feature, kind="island", name=piece.feature.name or "island")
        notes.append(f"{where}: lies within {other}: taken as an island")
    return features


def _union(shapes: Sequence[BaseGeometry]) -> Area | None:
    if not shapes:
        return None
    return area_of(shapes[0] if len(shapes) == 1 else shapely.union_all(shapes))


def _clipped(shape: BaseGeometry, near: BaseGeometry) -> BaseGeometry:
    """What of a shape lies near the water; a mainland may reach far beyond the frame."""
    if near.covers(shape):
        return shape
    clipped = shapely.intersection(shape, near)
    return area_of(clipped) if isinstance(shape, Polygon | MultiPolygon) else clipped


def _projected(shape: BaseGeometry, raw: RawMap, frame: LocalFrame) -> BaseGeometry:
    """A valid shape in the frame; corners a nanometre apart may change sides when they are projected."""
    local = to_local(densified(shape, raw.edges), frame.origin)
    return local if local.is_valid else area_of(shapely.make_valid(local))


def _kind_of(properties: Mapping[str, Any], where: str, *, is_asked: bool) -> tuple[Kind, bool]:
    """The kind of a feature, and whether the file says so: False for water by default. Raises MapError: a
    kind that does not exist, or tags that say neither water nor land.
    """
    if "kind" in properties:
        kind = properties["kind"]
        if kind not in KINDS:
            raise MapError(f"{where}: kind {kind!r} is none of {', '.join(KINDS)}")
        return kind, True
    tagged = tagged_kind(properties)
    if tagged is not None:
        return tagged, True
    said = next((f"{key}={properties[key]}" for key in _TOLD if properties.get(key)), None)
    if said is not None and is_asked:
        raise MapError(
            f"{where}: {said} says neither water nor land here: "
            f"add the property kind, one of {', '.join(KINDS)}"
        )
    return "water", False


def _nested(water: Sequence[_Piece]) -> list[tuple[int, int]]:
    """Water by default that lies in other water, as indices of the inner piece and the one around it: taken
    as water, an island would be sailed over.
    """
    if len(water) < 2 or all(piece.is_said for piece in water):
        return []
    shapes = [piece.feature.shape for piece in water]
    tree = shapely.STRtree(shapes)
    found: list[tuple[int, int]] = []
    for inner, shape in enumerate(shapes):
        if water[inner].is_said:
            continue
        for outer in sorted(tree.query(shape, "intersects").tolist()):
            around = shapes[outer]
            if around.area > shape.area and shape.intersection(around).area > INSIDE_SHARE * shape.area:
                found.append((inner, outer))
                break
    return found
