"""A `.plan` or QGC WPL 110 file as a map: its fence is the water's edge, as the vehicle has it."""

from dataclasses import replace
from itertools import groupby
from pathlib import Path

from companion.core.geo import LatLon, LocalFrame
from companion.core.units import e7_to_deg
from mission_tools.errors import MapError, PlanFileError
from mission_tools.maps.chart import Chart, build_chart
from mission_tools.maps.fenced import fenced
from mission_tools.mission.mission import Command, Fence, FenceCircle, FencePolygon, Mission, MissionItem
from mission_tools.mission.plan_file import load_mission

_INCLUSIONS = {Command.NAV_FENCE_POLYGON_VERTEX_INCLUSION, Command.NAV_FENCE_CIRCLE_INCLUSION}
_CORNERS = {Command.NAV_FENCE_POLYGON_VERTEX_INCLUSION, Command.NAV_FENCE_POLYGON_VERTEX_EXCLUSION}
_CIRCLES = {Command.NAV_FENCE_CIRCLE_INCLUSION, Command.NAV_FENCE_CIRCLE_EXCLUSION}


def load_mission_map(path: Path, origin: LatLon | None = None) -> Chart:
    """The water inside a mission file's fence, or around its exclusions.

    Raises:
        MapError: the file cannot be read, or has no fence.
    """
    try:
        mission = load_mission(path)
        fence = mission.fence if mission.fence != Fence() else _fence_of_items(mission)
    except (PlanFileError, ValueError) as error:
        raise MapError(str(error)) from None
    places = [corner for polygon in fence.polygons for corner in polygon.corners]
    places += [circle.centre for circle in fence.circles]
    if not places:
        raise MapError(f"{path}: a mission without a fence says nothing about where the water is")
    chart = build_chart(path.stem, LocalFrame(origin or places[0]), None, ())
    return replace(fenced(chart, fence, str(path)), name=path.stem)


def _fence_of_items(mission: Mission) -> Fence:
    """The fence in a WPL file of fence items: each corner carries its polygon's count."""
    polygons: list[FencePolygon] = []
    circles: list[FenceCircle] = []
    for (command, count), group in groupby(mission.items, key=lambda item: (item.command, item.params[0])):
        items = list(group)
        is_inclusion = command in _INCLUSIONS
        if command in _CIRCLES:
            circles += [FenceCircle(_place(item), item.params[0], is_inclusion) for item in items]
        elif command in _CORNERS:
            size = int(count) if 3 <= count <= len(items) else len(items)
            polygons += [
                FencePolygon(tuple(map(_place, items[n : n + size])), is_inclusion)
                for n in range(0, len(items), size)
            ]
    return Fence(tuple(polygons), tuple(circles))


def _place(item: MissionItem) -> LatLon:
    return LatLon(e7_to_deg(item.x), e7_to_deg(item.y))
