"""A piece of water in a local frame: where a boat may be, and what the things in it are called.

Shapes are shapely's, with x = east and y = north in metres of the chart's frame.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import shapely
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from companion.core.geo import LatLon, LocalFrame, Point, longitude_difference_deg
from mission_tools.errors import MapError
from mission_tools.geojson import KEPT_OUT, SOLID, Kind

Area: TypeAlias = Polygon | MultiPolygon

DEPTH = "depth_m"
"""Property of a feature: the least depth of its area."""
HEIGHT = "height_m"
"""Property of a bridge: what it leaves above the water."""
SPEED_LIMIT = "max_speed_m_s"
"""Property of a feature: the highest speed over ground in its area."""
CLEARANCE = "clearance_m"
"""Property of a feature: the clearance to keep from it, in place of the route's."""
PROPERTIES = frozenset({DEPTH, HEIGHT, SPEED_LIMIT, CLEARANCE})
REACH_DEG = 2.0  # of a great circle to north and east of a chart's origin; nothing farther belongs to it
OPEN_WATER_HALF_SIDE_M = 500_000.0  # twice REACH_DEG: beyond any route


@dataclass(frozen=True, slots=True)
class Feature:
    """Something on the chart that has a name. A landmark is a point and only for pictures; boats pass below a
    bridge (`passable.py`).

    properties: everything that the file says about it.
    """

    name: str
    kind: Kind
    shape: BaseGeometry
    properties: Mapping[str, Any] = field(default_factory=dict, compare=False)

    @property
    def described(self) -> str:
        """The kind and, if it has one, the name, for messages."""
        return f'{self.kind} "{self.name}"' if self.name else f"an area of {self.kind} without a name"


@dataclass(frozen=True, slots=True, eq=False)
class Chart:
    """Water, with islands and obstacles cut out, and the areas in it to keep out of.

    navigable: water less keep_out. shores: the outline of navigable, which a boat keeps clear of.
    is_open: there is no shore at all; water is then a large square that stands for the sea.
    notes: what was repaired or skipped when the map was read, a line each.
    """

    name: str
    frame: LocalFrame
    water: Area
    keep_out: Area
    features: tuple[Feature, ...]
    is_open: bool
    navigable: Area
    shores: BaseGeometry
    notes: tuple[str, ...] = ()

    def reaches(self, place: LatLon) -> bool:
        """Whether a place may belong to this chart."""
        origin = self.frame.origin
        east_deg = longitude_difference_deg(place.lon_deg, origin.lon_deg)
        east_deg *= math.cos(math.radians(place.lat_deg))
        return max(abs(place.lat_deg - origin.lat_deg), abs(east_deg)) <= REACH_DEG

    def clearance_m(self, point: Point) -> float:
        """Distance from a point in navigable water to the nearest thing that is not; 0 anywhere else."""
        at = shapely.Point(point.east_m, point.north_m)
        if not self.navigable.contains(at):
            return 0.0
        return math.inf if self.shores.is_empty else float(self.shores.distance(at))

    def is_clear(self, start: Point, end: Point, clearance_m: float) -> bool:
        """Whether the straight leg between two navigable points keeps this clear of every shore."""
        leg = shapely.LineString([(start.east_m, start.north_m), (end.east_m, end.north_m)])
        return not shapely.dwithin(self.shores, leg, clearance_m)

    def leg_clearance_m(self, start: Point, end: Point) -> float:
        """Distance from a straight leg to the nearest shore; infinite in open water."""
        leg = shapely.LineString([(start.east_m, start.north_m), (end.east_m, end.north_m)])
        return math.inf if self.shores.is_empty else float(self.shores.distance(leg))

    def nearest_feature(self, point: Point) -> str:
        """What a boat on navigable water is nearest to, for messages: “Alder Island”, “the shore”."""
        at = shapely.Point(point.east_m, point.north_m)
        solid = [feature for feature in self.features if feature.kind in KEPT_OUT | SOLID]
        nearest = min(solid, key=lambda feature: feature.shape.distance(at), default=None)
        if nearest is None or nearest.shape.distance(at) > self.shores.distance(at) + 1e-6:
            return "the shore"
        return nearest.name

    def obstruction(self, point: Point) -> str | None:
        """Where a point is if not on navigable water, for messages: “on Alder Island”; None if it is."""
        at = shapely.Point(point.east_m, point.north_m)
        if self.navigable.contains(at):
            return None
        for feature in self.features:
            if feature.kind in KEPT_OUT | SOLID and feature.shape.intersects(at):
                return f"{'in' if feature.kind in KEPT_OUT else 'on'} {feature.name}"
        return "on land" if self.water.envelope.contains(at) else "outside the map"


def property_number(feature: Feature, key: str) -> float | None:
    """A number that the map says about a feature; None if it says none. Raises MapError: it says something
    else; names the feature.
    """
    value: Any = feature.properties.get(key)
    if value is None:
        return None
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise MapError(f"{feature.described}: {key} is {value!r}: expected a number")
    return number


def build_chart(
    name: str,
    frame: LocalFrame,
    water: Area | None,
    features: Iterable[Feature],
    notes: Iterable[str] = (),
) -> Chart:
    """Cut solid features out of the water (None: open water), collect those to keep out of. Raises MapError:
    nothing navigable is left.
    """
    features = tuple(features)
    half = OPEN_WATER_HALF_SIDE_M
    whole = shapely.box(-half, -half, half, half) if water is None else water
    solid = shapely.union_all([feature.shape for feature in features if feature.kind in SOLID])
    kept_out = area_of(shapely.union_all([feature.shape for feature in features if feature.kind in KEPT_OUT]))
    cut = area_of(whole.difference(solid))
    navigable = area_of(cut.difference(kept_out))
    if navigable.is_empty:
        raise MapError(f"{name}: no water is left between its islands, obstacles and keep-out areas")
    shores = navigable.boundary
    if water is None:  # the square's sides are not shores
        shores = shores.difference(whole.boundary)
    shapely.prepare(shores)
    shapely.prepare(navigable)
    return Chart(name, frame, cut, kept_out, features, water is None, navigable, shores, tuple(notes))


def area_of(shape: BaseGeometry) -> Area:
    """The polygons of a geometry; lines and points that an overlay left behind are dropped."""
    if isinstance(shape, Polygon | MultiPolygon):
        return shape
    flat = shapely.get_parts(shapely.get_parts(shape))
    parts = [part for part in flat if isinstance(part, Polygon)]
    return MultiPolygon(parts)
