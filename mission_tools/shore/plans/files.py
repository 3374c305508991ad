"""The planner's input: fence, rally points and survey area as GeoJSON, open water, a mission as text."""

from collections.abc import Mapping, Sequence
from typing import Any, Final

import msgspec

from companion.core.units import e7_to_deg
from companion.mavlink.items import GLOBAL_FRAMES, MissionItem

_KINDS: Final = {
    5001: "inclusion",
    5002: "exclusion",
    5003: "inclusion",
    5004: "exclusion",
}  # MAV_CMD_NAV_FENCE_…
_RALLY_POINT: Final = 5100


def fence_file(fence: Mapping[str, Any] | None) -> bytes | None:
    """The boat's fence (`station/geojson.py`) as `--fence` reads it; None without an area in it."""
    features = []
    for feature in (fence or {}).get("features", ()):
        geometry, told = feature["geometry"], feature["properties"]
        kind = _KINDS.get(told["command"])
        is_area = geometry is not None and (geometry["type"] == "Polygon" or told.get("radius_m", 0.0) > 0.0)
        if kind is not None and is_area:
            radius = {"radius_m": told["radius_m"]} if "radius_m" in told else {}
            features.append(_feature({"kind": kind, **radius}, geometry))
    return _collection(features)


def rally_file(rally: Mapping[str, Any] | None) -> bytes | None:
    """The boat's rally points as `--rally` reads them; None without one."""
    points = [
        _feature({"kind": "rally"}, feature["geometry"])
        for feature in (rally or {}).get("features", ())
        if feature["properties"]["command"] == _RALLY_POINT and feature["geometry"] is not None
    ]
    return _collection(points)


def area_file(corners: Sequence[tuple[float, float]]) -> bytes:
    """A survey's area as a GeoJSON file."""
    geometry = {"type": "Polygon", "coordinates": [[*corners, corners[0]]]}
    found = _collection([_feature({"kind": "inclusion"}, geometry)])
    assert found is not None  # noqa: S101 (it has a feature)
    return found


def open_water_file(lat_deg: float, lon_deg: float) -> bytes:
    """A scenario without a map, around a place."""
    return f'title = "Open water"\n[origin]\nlat_deg = {lat_deg:.7f}\nlon_deg = {lon_deg:.7f}\n'.encode()


def mission_text(items: Sequence[MissionItem]) -> bytes:
    """A mission as QGC WPL 110 (MAVLink guide, "File formats"), home in its first row."""
    rows = ["QGC WPL 110", *(_row(seq, item) for seq, item in enumerate(items))]
    return ("\n".join(rows) + "\n").encode("ascii")


def _row(seq: int, item: MissionItem) -> str:
    frame = 0 if seq == 0 else item.frame  # home is absolute in ArduPilot's files
    is_global = item.frame in GLOBAL_FRAMES
    place = [f"{e7_to_deg(value):.7f}" if is_global else value for value in (item.x, item.y)]
    params = (item.param1, item.param2, item.param3, item.param4)
    fields = (seq, int(seq == 0), frame, item.command, *params, *place, item.z, item.autocontinue)
    return "\t".join(map(str, fields))


def _feature(properties: dict[str, Any], geometry: Mapping[str, Any]) -> dict[str, Any]:
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def _collection(features: list[dict[str, Any]]) -> bytes | None:
    return msgspec.json.encode({"type": "FeatureCollection", "features": features}) if features else None
