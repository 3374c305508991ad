"""Missions for lockstep runs: read from a file, or planned on the scenario's own chart."""

from pathlib import Path

from companion.mavlink.items import MissionItem
from mission_tools.errors import UsageError
from mission_tools.mission import Mission, MissionType
from mission_tools.plan_file import load_mission
from mission_tools.planning import Plan, PlanSettings, plan
from mission_tools.route import mission_along
from sitl.scenario import Scenario


def read_mission(path: Path) -> Mission:
    """A QGroundControl .plan or a .waypoints file.

    Raises:
        PlanFileError: it cannot be used; names file and item.
    """
    return load_mission(path)


def plan_mission(scenario: Scenario) -> tuple[Mission, Plan]:
    """A* from where the boat lies to the scenario's goal.

    Raises:
        UsageError: the scenario names no goal.
        NoRouteError: its family says what is in the way.
    """
    route = scenario.route
    if route.goal is None:
        raise UsageError(f"{scenario.title} names no goal to plan to: expected --mission FILE or route.goal")
    settings = PlanSettings.from_route(route)
    planned = plan(scenario.chart, scenario.start, route.goal, settings, route.via)
    return mission_along([scenario.frame.to_global(point) for point in planned.points]), planned


def wire_items(mission: Mission) -> list[MissionItem]:
    """The mission as the boat receives it, home first."""
    return [
        MissionItem(
            frame=item.frame,
            command=item.command,
            autocontinue=int(item.autocontinue),
            param1=item.params[0],
            param2=item.params[1],
            param3=item.params[2],
            param4=item.params[3],
            x=item.x,
            y=item.y,
            z=item.z,
        )
        for item in mission.wire_lists(home_first=True)[MissionType.MISSION]
    ]
