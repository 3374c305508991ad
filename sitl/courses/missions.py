"""Missions for lockstep runs: read from a file, or planned on the scenario's own chart."""

from collections.abc import Sequence

import shapely

from companion.core.geo import Point
from companion.mavlink.items import MissionItem
from mission_tools.errors import UsageError
from mission_tools.mission.mission import Fence, FencePolygon, Mission, MissionType
from mission_tools.mission.mission import MissionItem as PlannedItem
from mission_tools.mission.route import mission_along
from mission_tools.planning.planner import Plan, PlanSettings, plan
from sitl.courses.courses import COURSES, STATION, course_mission, station_mission
from sitl.world.scenario import Scenario


def plan_mission(scenario: Scenario) -> tuple[Mission, Plan]:
    """A* from where the boat lies to the scenario's goal.

    Raises UsageError: the scenario names no goal; NoRouteError: its family says what is in the way.
    """
    route = scenario.route
    if route.goal is None:
        raise UsageError(f"{scenario.title} names no goal to plan to: expected --mission FILE or route.goal")
    settings = PlanSettings.from_route(route)
    planned = plan(scenario.chart, scenario.start, route.goal, settings, route.via)
    return mission_along([scenario.frame.to_global(point) for point in planned.points]), planned


def course_names() -> tuple[str, ...]:
    """The courses that `lay_out` knows."""
    return (*COURSES, STATION)


def lay_out(course: str, scenario: Scenario) -> Mission:
    """A course from where the boat lies. Raises UsageError: no such course."""
    if course not in course_names():
        raise UsageError(f"no course {course!r}: expected {', '.join(course_names())}")
    if course == STATION:
        return station_mission(scenario.frame, scenario.start)
    return course_mission(course, scenario.frame, scenario.start)


def fence_along(scenario: Scenario) -> list[MissionItem]:
    """The outline of the scenario's water as a fence, islands and areas to keep out of as exclusions.

    Open water has no outer line. Of waters that are apart it is the one that the boat lies in: a boat must
    be inside of every inclusion.
    """
    polygons = []
    start = shapely.Point(scenario.start.east_m, scenario.start.north_m)
    waters = shapely.get_parts(scenario.chart.navigable)
    for area in [] if not len(waters) else [min(waters, key=start.distance)]:
        for number, ring in enumerate(shapely.get_rings(area)):
            if number == 0 and scenario.chart.is_open:
                continue
            corners = shapely.get_coordinates(ring)[:-1].tolist()
            places = tuple(scenario.frame.to_global(Point(north_m, east_m)) for east_m, north_m in corners)
            polygons.append(FencePolygon(places, inclusion=number == 0))
    return _on_the_wire(Fence(tuple(polygons)).items())


def wire_items(mission: Mission) -> list[MissionItem]:
    """The mission as the boat receives it, home first."""
    return _on_the_wire(mission.wire_lists(home_first=True)[MissionType.MISSION])


def wire_fence(mission: Mission, scenario: Scenario, *, has_outline: bool) -> list[MissionItem]:
    """The outline of the scenario's water as the fence, else the mission's own fence, if it has one."""
    return fence_along(scenario) if has_outline else _on_the_wire(mission.fence.items())


def _on_the_wire(items: Sequence[PlannedItem]) -> list[MissionItem]:
    return [
        MissionItem(
            item.frame, item.command, 0, int(item.autocontinue), *item.params, x=item.x, y=item.y, z=item.z
        )
        for item in items
    ]
