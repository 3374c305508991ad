"""A mission from the lists that a vehicle holds: the inverse of `Mission.wire_lists`."""

from collections.abc import Mapping, Sequence

from companion.core.geo import LatLon
from companion.core.units import e7_to_deg
from mission_tools.mission.mission import (
    Command,
    Fence,
    FenceCircle,
    FencePolygon,
    Mission,
    MissionItem,
    MissionType,
    Rally,
)

_VERTICES = {
    Command.NAV_FENCE_POLYGON_VERTEX_INCLUSION: True,
    Command.NAV_FENCE_POLYGON_VERTEX_EXCLUSION: False,
}
_CIRCLES = {Command.NAV_FENCE_CIRCLE_INCLUSION: True, Command.NAV_FENCE_CIRCLE_EXCLUSION: False}
FENCE_COMMANDS = frozenset({*_VERTICES, *_CIRCLES, Command.NAV_FENCE_RETURN_POINT})


def mission_from(lists: Mapping[MissionType, Sequence[MissionItem]], *, home_first: bool) -> Mission:
    """The mission, fence and rally points of a vehicle. home_first: item 0 is home, as ArduPilot keeps it.

    Raises:
        ValueError: a fence that is none; names the item.
    """
    items = tuple(lists.get(MissionType.MISSION, ()))
    home, altitude_m = None, 0.0
    if home_first and items:
        first, *rest = items
        items = tuple(rest)
        if (first.x, first.y) != (0, 0):  # what a vehicle without a home has there
            home, altitude_m = _place(first), first.z
    return Mission(
        items,
        home,
        altitude_m,
        fence_from(lists.get(MissionType.FENCE, ())),
        tuple(Rally(_place(item), item.z) for item in lists.get(MissionType.RALLY, ())),
    )


def fence_from(items: Sequence[MissionItem]) -> Fence:
    """The fence of a list of items; every vertex carries its polygon's number of vertices.

    Raises:
        ValueError: names the item and what was expected there.
    """
    polygons: list[FencePolygon] = []
    circles: list[FenceCircle] = []
    return_point: MissionItem | None = None
    number = 0
    while number < len(items):
        item = items[number]
        where = f"fence, item {number}"
        if item.command in _VERTICES:
            count = int(item.params[0])
            group = items[number : number + count]
            if count < 3 or len(group) < count or {part.command for part in group} != {item.command}:
                raise ValueError(f"{where}: begins a polygon of {count} vertices that do not follow")
            corners = tuple(_place(part) for part in group)
            polygons.append(FencePolygon(corners, _VERTICES[Command(item.command)]))
            number += count
            continue
        if item.command in _CIRCLES:
            circles.append(FenceCircle(_place(item), item.params[0], _CIRCLES[Command(item.command)]))
        elif item.command == Command.NAV_FENCE_RETURN_POINT:
            return_point = item
        else:
            raise ValueError(f"{where}: MAV_CMD {item.command} is none of a fence")
        number += 1
    back, altitude_m = (None, 0.0) if return_point is None else (_place(return_point), return_point.z)
    return Fence(tuple(polygons), tuple(circles), back, altitude_m)


def _place(item: MissionItem) -> LatLon:
    return LatLon(e7_to_deg(item.x), e7_to_deg(item.y))
