"""Fence and rally items: checked one by one on arrival, and as a whole at the end."""

import math
from collections.abc import Sequence

from companion.core.geo import LatLon, geodesic_m
from companion.core.units import e7_to_deg
from companion.geofence.fence import FenceArea, FenceCircle, FencePolygon
from companion.mavlink.dialect import constants, dialect
from companion.mavlink.items import ItemFault, MissionItem, MissionResult
from companion.services.missions.items import command_name, global_position

_POLYGONS = constants("MAV_CMD_NAV_FENCE_POLYGON_VERTEX", "INCLUSION", "EXCLUSION")
_CIRCLES = constants("MAV_CMD_NAV_FENCE_CIRCLE", "INCLUSION", "EXCLUSION")
_INCLUSIONS = (_POLYGONS[0], _CIRCLES[0])
_RETURN_POINT = dialect.MAV_CMD_NAV_FENCE_RETURN_POINT
_FEWEST_VERTICES = 3
_MOST_LAT_DEG = 85.0  # as far as the local frame is accurate
_MOST_EXTENT_M = 100_000.0


def check_fence_item(item: MissionItem) -> ItemFault | None:
    """Why this is not a fence item, or None."""
    count = item.param1
    if item.command in _POLYGONS:
        if not math.isfinite(count) or count != int(count) or count < _FEWEST_VERTICES:
            return ItemFault(MissionResult.INVALID_PARAM1, f"a polygon cannot have {count:g} vertices")
    elif item.command in _CIRCLES:
        if not 0.0 < item.param1 <= _MOST_EXTENT_M:
            text = f"radius {item.param1:g} m is not a radius of up to {_MOST_EXTENT_M / 1e3:.0f} km"
            return ItemFault(MissionResult.INVALID_PARAM1, text)
    elif item.command != _RETURN_POINT:
        text = f"{command_name(item.command)} is not a fence item"
        return ItemFault(MissionResult.UNSUPPORTED, text)
    if abs(e7_to_deg(item.x)) > _MOST_LAT_DEG:
        return ItemFault(
            MissionResult.INVALID_PARAM5_X, f"no fence beyond {_MOST_LAT_DEG:g} degrees of latitude"
        )
    return _fault_of(item)


def check_rally_item(item: MissionItem) -> ItemFault | None:
    """Why this is not a rally point, or None."""
    if item.command != dialect.MAV_CMD_NAV_RALLY_POINT:
        return ItemFault(MissionResult.UNSUPPORTED, f"{command_name(item.command)} is not a rally point")
    return _fault_of(item)


def check_fence(items: Sequence[MissionItem]) -> ItemFault | None:
    """Polygons must be complete, contiguous and of limited extent, with at most one return point."""
    seq = 0
    while seq < len(items):
        first = items[seq]
        vertices = int(first.param1) if first.command in _POLYGONS else 1
        for at in range(seq, seq + vertices):
            same = at < len(items) and items[at].command == first.command
            if not same or (vertices > 1 and items[at].param1 != first.param1):
                text = f"item {min(at, len(items) - 1)}: a polygon of {vertices} vertices breaks off"
                return ItemFault(MissionResult.INVALID_PARAM1, f"{text} after {at - seq}")
            if at > seq and (far_m := geodesic_m(_position(first), _position(items[at]))) > _MOST_EXTENT_M:
                text = f"item {at}: {far_m / 1e3:.0f} km from the first vertex; at most"
                return ItemFault(MissionResult.INVALID_PARAM5_X, f"{text} {_MOST_EXTENT_M / 1e3:.0f} km")
        seq += vertices
    returns = [seq for seq, item in enumerate(items) if item.command == _RETURN_POINT]
    if len(returns) > 1:
        return ItemFault(MissionResult.INVALID, f"item {returns[1]}: a second return point")
    return None


def fence_areas(items: Sequence[MissionItem]) -> list[FenceArea]:
    areas: list[FenceArea] = []
    seq = 0
    while seq < len(items):
        first = items[seq]
        is_inclusion = first.command in _INCLUSIONS
        vertices = int(first.param1) if first.command in _POLYGONS else 1
        if first.command in _POLYGONS:
            places = tuple([_position(item) for item in items[seq : seq + vertices]])
            areas.append(FencePolygon(places, is_inclusion))
        elif first.command in _CIRCLES:
            areas.append(FenceCircle(_position(first), first.param1, is_inclusion))
        seq += vertices
    return areas


def rally_points(items: Sequence[MissionItem]) -> list[LatLon]:
    return [_position(item) for item in items]


def _position(item: MissionItem) -> LatLon:
    return LatLon(e7_to_deg(item.x), e7_to_deg(item.y))


def _fault_of(item: MissionItem) -> ItemFault | None:
    position = global_position(item)
    return position if isinstance(position, ItemFault) else None
