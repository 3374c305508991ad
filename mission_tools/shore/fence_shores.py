"""The fence of a boat, as the page has it in GeoJSON, as shores that a way keeps clear of."""

from collections.abc import Mapping, Sequence
from typing import Any, Final

from companion.core.geo import LatLon, LocalFrame, Point
from companion.planning.area_shores import corners_of, outside_of
from companion.planning.areas import Area, Disc, Ring
from companion.planning.water import Shore
from mission_tools.geojson import FENCE_KINDS

_AROUND_M: Final = 1_000.0  # what is outside an inclusion area reaches so far beyond every place in use


def fence_shores(
    fence: Mapping[str, Any], frame: LocalFrame, places: Sequence[Point]
) -> tuple[list[Shore], list[Area]]:
    """Shores whose inside the boat must not enter, and the areas.

    fence: from the station (polygons, and points with radius_m). places: start, goal and the map's corners.
    """
    features = fence.get("features") or []
    areas = [area for feature in features if (area := _area(feature, frame)) is not None]
    if not areas:
        return [], []
    box = (
        min(*(area.south_m for area in areas), *(at.north_m for at in places)) - _AROUND_M,
        min(*(area.west_m for area in areas), *(at.east_m for at in places)) - _AROUND_M,
        max(*(area.north_m for area in areas), *(at.north_m for at in places)) + _AROUND_M,
        max(*(area.east_m for area in areas), *(at.east_m for at in places)) + _AROUND_M,
    )
    shores = [
        outside_of(corners_of(area), box) if area.is_inclusion else Shore(corners_of(area)) for area in areas
    ]
    return shores, areas


def allows(areas: Sequence[Area], at: Point) -> bool:
    """Whether a place is inside every inclusion area and outside every exclusion area."""
    return all(area.contains(at.north_m, at.east_m) == area.is_inclusion for area in areas)


def _area(feature: Mapping[str, Any], frame: LocalFrame) -> Area | None:
    geometry, properties = feature.get("geometry"), feature.get("properties") or {}
    kind = FENCE_KINDS.get(properties.get("command"))
    if geometry is None or kind is None:
        return None
    is_inclusion = kind == "inclusion"
    if geometry["type"] == "Polygon":
        ring = [frame.to_local(LatLon(lat, lon)) for lon, lat in geometry["coordinates"][0][:-1]]
        return Ring(ring, is_inclusion) if len(ring) >= 3 else None
    radius_m = properties.get("radius_m", 0.0)
    lon, lat = geometry["coordinates"]
    return Disc(frame.to_local(LatLon(lat, lon)), radius_m, is_inclusion) if radius_m > 0.0 else None
