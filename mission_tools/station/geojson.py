"""What the page's chart shows of a boat: its lists of mission items as GeoJSON, and its track.

Features are in the order of the list. Properties: seq (of its first item), command, name, and radius_m where
there is one. A feature without a place (a command, or a place in a local frame) has a null geometry.
"""

import math
from collections.abc import Sequence
from typing import Any, Final

from companion.core.geo import LatLon, position_from_e7
from companion.mavlink.dialect import dialect
from companion.mavlink.items import GLOBAL_FRAMES, MissionItem
from mission_tools.geojson import FENCE_KINDS, collection, feature
from mission_tools.station.messages import Place

_INCLUSION: Final = dialect.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION
_EXCLUSION: Final = dialect.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION
_CIRCLE_IN: Final = dialect.MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION
_CIRCLE_OUT: Final = dialect.MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION
_LEAST_CORNERS: Final = 3
_WIDEST_M: Final = 1e6
_MOST_POINTS: Final = 2000  # of a track
_FIRST_STEP_M: Final = 1.0
_EARTH_M: Final = 6_371_000.0  # of a sphere
_NAMES: Final = {
    16: "waypoint", 17: "stay", 18: "circle", 19: "stay for a time", 20: "return", 93: "wait", 112: "delay",
    113: "distance", 115: "turn", 177: "jump", 178: "speed", 179: "home", 5000: "return point",
    5100: "rally point", **FENCE_KINDS,
}  # fmt: skip


def command_name(number: int) -> str:
    """In plain words, or MAVLink's name in lower case."""
    if number in _NAMES:
        return _NAMES[number]
    entry = dialect.enums["MAV_CMD"].get(number)
    if entry is None:
        return f"command {number}"
    name = str(entry.name).removeprefix("MAV_CMD_")
    return name.lower().replace("_", " ")


def mission_geojson(items: Sequence[MissionItem]) -> dict[str, Any]:
    """A point for each item; item 0 is home."""
    features = []
    for seq, item in enumerate(items):
        radius_m = item.param2 if item.command == dialect.MAV_CMD_NAV_WAYPOINT else item.param3
        name = "home" if seq == 0 else command_name(item.command)
        features.append(_point(seq, item, name, radius_m))
    return collection(features)


def rally_geojson(items: Sequence[MissionItem]) -> dict[str, Any]:
    """A point for each."""
    return collection([_point(seq, item, command_name(item.command)) for seq, item in enumerate(items)])


def fence_geojson(items: Sequence[MissionItem]) -> dict[str, Any]:
    """Polygons of consecutive corners, circles as points with a radius."""
    features: list[dict[str, Any]] = []
    at = 0
    while at < len(items):
        item = items[at]
        name = command_name(item.command)
        if item.command not in (_INCLUSION, _EXCLUSION):
            is_circle = item.command in (_CIRCLE_IN, _CIRCLE_OUT)
            features.append(_point(at, item, name, item.param1 if is_circle else 0.0))
            at += 1
            continue
        count = _corner_count(item)
        corners = [
            corner
            for one in items[at : at + count]
            if one.command == item.command and (corner := _lon_lat(one))
        ]
        kind = "Polygon" if len(corners) >= _LEAST_CORNERS else None
        features.append(feature(kind, [[*corners, *corners[:1]]], seq=at, command=item.command, name=name))
        at += count
    return collection(features)


def _corner_count(item: MissionItem) -> int:
    """param1 of a corner: how many the polygon has; at least this one."""
    return int(item.param1) if math.isfinite(item.param1) and item.param1 >= 1.0 else 1


def _lon_lat(item: MissionItem) -> list[float] | None:
    if item.frame not in GLOBAL_FRAMES:
        return None
    place: LatLon | None = position_from_e7(item.x, item.y)
    return None if place is None else [place.lon_deg, place.lat_deg]


def _point(seq: int, item: MissionItem, name: str, radius_m: float = 0.0) -> dict[str, Any]:
    at = _lon_lat(item)
    properties: dict[str, Any] = {"seq": seq, "command": item.command, "name": name}
    if math.isfinite(radius_m) and 0.0 < abs(radius_m) <= _WIDEST_M:
        properties["radius_m"] = abs(radius_m)
    return feature(None if at is None else "Point", at or (), **properties)


class BoatTrack:
    """Where a boat has been: points at least `step_m` apart.

    When full, every other point is dropped and the step doubled.
    """

    def __init__(self) -> None:
        self.points: list[tuple[float, float]] = []  # lon, lat
        self._step_m = _FIRST_STEP_M

    def add(self, place: Place) -> None:
        at = place.lon, place.lat
        if self.points and apart_m(self.points[-1], at) < self._step_m:
            return
        self.points.append(at)
        if len(self.points) > _MOST_POINTS:
            self.points = self.points[::2]
            self._step_m *= 2.0


def apart_m(a: tuple[float, float], b: tuple[float, float]) -> float:
    """Between places (lon, lat) close together, on a sphere."""
    east = math.radians(math.remainder(b[0] - a[0], 360.0)) * math.cos(math.radians(a[1]))
    return _EARTH_M * math.hypot(east, math.radians(b[1] - a[1]))
