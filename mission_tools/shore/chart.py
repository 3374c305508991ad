"""The map on board: what the page draws, and the shortest way by the water.

The page draws the same corners that a way is planned among. Pieces of water that overlap each other are not
joined: where two of them lie over each other a way does not lead.
"""

import threading
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import msgspec

from companion.core.geo import LatLon, LocalFrame, Point, distance_m, path_length_m
from companion.planning.visibility import NoWay, Routes
from companion.planning.water import Shore, Water
from mission_tools.errors import MapError
from mission_tools.geojson import KEPT_OUT, SOLID, collection, feature
from mission_tools.shore.chart_file import MapFile, read_map
from mission_tools.shore.fence_shores import allows, fence_shores
from mission_tools.shore.thinning import thinned
from mission_tools.station.messages import Place
from mission_tools.station.words import say

CLEARANCES_M: tuple[float, ...] = (4.0, 2.0, 1.0)
"""Kept from every shore, the largest that lets a way through: where there is room, acceptance radius of a
waypoint and margin of the fence (2 m each); the last is half a boat's length and its position's error."""
ROOM_M = 0.1  # beyond the clearance, for the rounding of a place on its way
WIDE_M = 50.0  # a basin less wide than this is for a model: the clearances are smaller in proportion
MOST_CORNERS = 5_000  # about 125 kB of GeoJSON
MOST_CHART_BYTES = 150_000
MOST_THINNING_M = 25.0
ASHORE_M = 10.0  # so far on land the boat may be by its receiver's error, or lie at a pier
_EMPTY = b'{"type":"FeatureCollection","name":"","features":[]}'


class Way(NamedTuple):
    """points: lon, lat in degrees, start and goal included. clearance_m: None without a map."""

    points: list[tuple[float, float]]
    length_m: float
    clearance_m: float | None


class Blocked(NamedTuple):
    """No way. nearest: the nearest water with a clearance, for a goal ashore."""

    reason: str
    nearest: Place | None = None


class WaterChart:
    """A map, or none: then every way is straight."""

    def __init__(self, path: Path | None) -> None:
        """Read the map; MapError names the file and what was expected."""
        self._bytes = _EMPTY
        self._lock = threading.Lock()
        self._frame: LocalFrame | None = None
        self._water = Water([], is_open=True)
        self._error_m = 0.0
        self._clearances_m = CLEARANCES_M
        self._fenced: tuple[object, Water] = (None, self._water)
        self._edge: list[Point] = []  # south-west and north-east of the map
        if path is None:
            return
        name, frame, shapes = read_map(path)
        shapes, self._error_m = thinned(shapes, MOST_CORNERS, MOST_THINNING_M)
        self._frame = frame
        self._bytes = _geojson(MapFile(name, frame, shapes))
        if len(self._bytes) > MOST_CHART_BYTES:
            raise MapError(
                f"{path}: {len(self._bytes) // 1000} kB for the page even without its details: "
                f"expected a map of at most {MOST_CHART_BYTES // 1000} kB; cut out what matters"
            )
        water = [Shore(ring) for s in shapes if s.kind == "water" for rings in s.polygons for ring in rings]
        land = [s for s in shapes if s.kind in SOLID or s.kind in KEPT_OUT]
        areas = [Shore(rings[0]) for shape in land for rings in shape.polygons]
        lines = [Shore((*line, *line[-2:0:-1])) for shape in land for line in shape.lines]
        self._water = Water(water, is_open=not water).with_shores([*areas, *lines])
        corners = [corner for shore in (*water, *areas, *lines) for corner in shore.corners]
        north, east = [at.north_m for at in corners], [at.east_m for at in corners]
        self._edge = [Point(min(north), min(east)), Point(max(north), max(east))]
        if water:
            room = min(max(north) - min(north), max(east) - min(east)) / WIDE_M
            self._clearances_m = tuple(clearance_m * min(room, 1.0) for clearance_m in CLEARANCES_M)

    def geojson(self) -> bytes:
        """A FeatureCollection, at most MOST_CHART_BYTES; properties: kind and name."""
        return self._bytes

    def way(self, start: Place, goal: Place, fence: Mapping[str, Any] | None = None) -> Way | Blocked:
        """The shortest way by the water inside a boat's fence, which is a FeatureCollection from the station.

        It may take a second on a large map: call it from a thread.
        """
        frame = self._frame or LocalFrame(LatLon(start.lat, start.lon))
        at = frame.to_local(LatLon(start.lat, start.lon))
        end = frame.to_local(LatLon(goal.lat, goal.lon))
        shores, areas = fence_shores(fence or {}, frame, [at, end, *self._edge])
        if not allows(areas, end):
            return Blocked(say("way.outside"))
        with self._lock:
            return self._planned(frame, self._with_fence(shores), at, end)

    def _with_fence(self, shores: list[Shore]) -> Water:
        """The water inside the fence; kept, with what its routes have found out, while that is the same."""
        if not shores:
            return self._water
        if self._fenced[0] != shores:
            self._fenced = (shores, self._water.with_shores(shores))
        return self._fenced[1]

    def _nearest(self, water: Water, goal: Point) -> Point | None:
        """The nearest water with the planner's clearance, or else with half of it."""
        for clearance_m in self._clearances_m[:2]:
            routes = water.routes(clearance_m + self._error_m + ROOM_M)
            if (near := next(routes.exits(goal, is_afloat=False), None)) is not None:
                return near
        return None

    def _planned(self, frame: LocalFrame, water: Water, start: Point, goal: Point) -> Way | Blocked:
        least_m = self._clearances_m[-1] + self._error_m
        least = water.routes(least_m)
        if not least.is_free(goal):
            near = self._nearest(water, goal)
            nearest = None
            if near is not None:
                lon, lat = _lon_lat(frame, near)
                nearest = Place(lat=lat, lon=lon)
            if not water.is_water(goal):
                return Blocked(say("way.ashore"), nearest)
            return Blocked(say("way.too_near", n=float(f"{least_m:.1g}")), nearest)
        if not water.is_water(start):
            afloat = next(least.exits(start, is_afloat=False), None)
            if afloat is None or distance_m(start, afloat) > ASHORE_M + least_m:
                return Blocked(say("way.boat_ashore"))
        for clearance_m in self._clearances_m:
            points = _points(water, clearance_m + self._error_m, start, goal)
            if points is not None:
                is_open = self._frame is None and water is self._water  # nothing is known to be clear of
                corners = [_lon_lat(frame, point) for point in points]
                return Way(corners, path_length_m(points), None if is_open else clearance_m)
        return Blocked(say("way.none"))


def _points(water: Water, clearance_m: float, start: Point, goal: Point) -> list[Point] | None:
    """A way with one clearance; a straight leg joins a start or goal that has less."""
    routes = water.routes(clearance_m)
    first = _with_clearance(routes, start, is_afloat=water.is_water(start))
    last = _with_clearance(routes, goal, is_afloat=True)
    if first is None or last is None:
        return None
    try:
        route = routes.route(first, last)
    except NoWay:
        return None
    before = [] if first == start else [start]
    after = [] if last == goal else [goal]
    return [*before, *route.points, *after]


def _with_clearance(routes: Routes, at: Point, *, is_afloat: bool) -> Point | None:
    return at if routes.is_free(at) else next(routes.exits(at, is_afloat=is_afloat), None)


def _lon_lat(frame: LocalFrame, point: Point) -> tuple[float, float]:
    place = frame.to_global(point)
    return round(place.lon_deg, 7), round(place.lat_deg, 7)


def _geojson(map_file: MapFile) -> bytes:
    features = []
    for shape in map_file.shapes:
        properties = {"kind": shape.kind, "name": shape.name}
        geometries: list[tuple[str, Any]] = []
        for rings in shape.polygons:
            outlines = rings if shape.kind == "water" else rings[:1]  # the inside of an obstacle is no water
            closed = [[*ring, ring[0]] for ring in outlines]
            coordinates = [[_lon_lat(map_file.frame, at) for at in ring] for ring in closed]
            geometries.append(("Polygon", coordinates))
        for line in shape.lines:
            places = [_lon_lat(map_file.frame, at) for at in line]
            geometries.append(("Point", places[0]) if len(places) == 1 else ("LineString", places))
        features += [feature(*geometry, **properties) for geometry in geometries]
    return msgspec.json.encode(collection(features, name=map_file.name))
