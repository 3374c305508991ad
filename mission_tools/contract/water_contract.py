"""The water contract: from one map the mission, its fence and its rally points, which go up together."""

from dataclasses import dataclass, replace

import shapely
from shapely.geometry import Polygon

from mission_tools.assembly.planned_mission import PlannedMission
from mission_tools.contract.fence_of_water import fence_of_water
from mission_tools.contract.rally_points import rally_points
from mission_tools.costs.boat import load_boat
from mission_tools.errors import UsageError
from mission_tools.maps.chart import Chart
from mission_tools.mission.mission import Fence
from mission_tools.wording import counted, distance


@dataclass(frozen=True, slots=True)
class Capacity:
    """How much the boat holds, and how far inside its fence it stops; by default this project's boat."""

    fence_margin_m: float = 2.0
    fence_items: int = 1000
    rally_items: int = 250


def capacity_of(boat: str | None) -> Capacity:
    """Of a boat's TOML; None: this project's boat."""
    if boat is None:
        return Capacity()
    known = load_boat(boat)
    return Capacity(known.fence_margin_m, known.most_fence_items, known.most_rally_items)


def with_contract(
    planned: PlannedMission, capacity: Capacity, *, with_fence: bool = True, with_rally: bool = True
) -> PlannedMission:
    """The mission with a fence and rally points from its own chart, and a note about them.

    Raises:
        UsageError: a mission from a file, which has no chart.
        NoRoute: no fence of so few corners holds the route.
    """
    if planned.plan is None and planned.task is None:
        raise UsageError(
            f"{planned.name} is a mission without a map: --fence FILE and --rally FILE go with it"
        )
    mission, notes = planned.mission, list[str]()
    route, clearance_m = planned.points, planned.clearance_m
    lines = None
    if with_fence:
        fence, near_m = fence_of_water(
            planned.chart, route, clearance_m, capacity.fence_margin_m, capacity.fence_items
        )
        mission = replace(mission, fence=fence)
        lines = fence_lines(planned.chart, fence)
        corners = sum(len(polygon.corners) for polygon in fence.polygons)
        said = f"fence: {counted(len(fence.polygons), 'polygon')}, {counted(corners, 'corner')}"
        notes.append(f"{said}, {distance(near_m)} from the route at least")
        if near_m < capacity.fence_margin_m:
            notes.append(
                f"the boat stops {distance(capacity.fence_margin_m)} inside its fence, more than the route "
                "has: plan with more --clearance"
            )
    if with_rally:
        rally = rally_points(planned.chart, route, clearance_m, capacity.rally_items, lines)
        mission = replace(mission, rally=rally)
        notes.append(f"{counted(len(rally), 'rally point')}")
    return replace(planned, mission=mission, notes=(*planned.notes, *notes))


def fence_lines(chart: Chart, fence: Fence) -> shapely.MultiLineString:
    """The lines of a fence's polygons in the chart's frame."""
    rings = []
    for polygon in fence.polygons:
        places = map(chart.frame.to_local, polygon.corners)
        rings.append(Polygon([(at.east_m, at.north_m) for at in places]).exterior)
    return shapely.multilinestrings(rings)
