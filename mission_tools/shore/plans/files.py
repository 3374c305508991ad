"""The planner's input: fence, rally points and survey area as GeoJSON, open water, a mission as text."""

from collections.abc import Mapping, Sequence
from typing import Any, Final

import msgspec

from companion.mavlink.items import GLOBAL_FRAMES, MissionItem
from mission_tools.geojson import FENCE_KINDS, collection, feature
from mission_tools.mission.wpl_text import line, text_of

_RALLY_POINT: Final = 5100


def fence_file(fence: Mapping[str, Any] | None) -> bytes | None:
    """The boat's fence (`station/geojson.py`) as `--fence` reads it; None without an area in it."""
    features = []
    for one in (fence or {}).get("features", ()):
        geometry, told = one["geometry"], one["properties"]
        is_area = geometry is not None and (geometry["type"] == "Polygon" or told.get("radius_m", 0.0) > 0.0)
        kind = FENCE_KINDS.get(told["command"])
        if kind is not None and is_area:
            radius = {"radius_m": told["radius_m"]} if "radius_m" in told else {}
            features.append(feature(*_shape(geometry), kind=kind, **radius))
    return _encoded(features)


def rally_file(rally: Mapping[str, Any] | None) -> bytes | None:
    """The boat's rally points as `--rally` reads them; None without one."""
    points = [
        feature(*_shape(one["geometry"]), kind="rally")
        for one in (rally or {}).get("features", ())
        if one["properties"]["command"] == _RALLY_POINT and one["geometry"] is not None
    ]
    return _encoded(points)


def area_file(corners: Sequence[tuple[float, float]]) -> bytes:
    """A survey's area as a GeoJSON file."""
    found = _encoded([feature("Polygon", [[*corners, corners[0]]], kind="inclusion")])
    assert found is not None  # noqa: S101 (it has a feature)
    return found


def open_water_file(lat_deg: float, lon_deg: float) -> bytes:
    """A scenario without a map, around a place."""
    return f'title = "Open water"\n[origin]\nlat_deg = {lat_deg:.7f}\nlon_deg = {lon_deg:.7f}\n'.encode()


def mission_text(items: Sequence[MissionItem]) -> bytes:
    """A mission as QGC WPL 110, home in its first row."""
    rows = []
    for seq, item in enumerate(items):
        frame = 0 if seq == 0 else item.frame  # home is absolute in ArduPilot's files
        params = (item.param1, item.param2, item.param3, item.param4)
        place = (item.x, item.y, item.z)
        rows.append(
            line(seq, frame, item.command, params, place, item.frame in GLOBAL_FRAMES, item.autocontinue)
        )
    return text_of(rows).encode("ascii")


def _shape(geometry: Mapping[str, Any]) -> tuple[str, Sequence[Any]]:
    return geometry["type"], geometry["coordinates"]


def _encoded(features: list[dict[str, Any]]) -> bytes | None:
    return msgspec.json.encode(collection(features)) if features else None
