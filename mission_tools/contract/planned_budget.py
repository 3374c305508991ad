"""The budget of a planned mission."""

from mission_tools.assembly.planned_mission import PlannedMission
from mission_tools.contract.budget import Budget, budget_of, ways_home_m
from mission_tools.costs.boat import Boat, load_boat
from mission_tools.costs.current import STILL_WATER, Current
from mission_tools.costs.current_source import open_current
from mission_tools.errors import UsageError
from mission_tools.planning.planner import PlanSettings
from mission_tools.tasks.transits import Transits


def planned_budget(planned: PlannedMission, boat: Boat | str, current: Current | str | None = None) -> Budget:
    """What a mission costs a boat. boat: its TOML or an emulated boat's name. current: also as in --current.

    Raises:
        MapError: the current's file.
        UsageError: no such boat, or nowhere to go.
        NoRoute: a leg that cannot be sailed against the current.
    """
    boat = load_boat(boat) if isinstance(boat, str) else boat
    if isinstance(current, str):
        current = open_current(current, planned.chart.frame)
    points, mission = planned.points, planned.mission
    if mission.home is None or len(points) < 2:
        raise UsageError("--boat: a budget needs a home and a waypoint")
    holds_s = [item.hold_s for item in mission.items if item.place is not None]
    settings = PlanSettings(clearance_m=planned.clearance_m)
    (back_m,) = Transits(planned.chart, settings).lengths_m(points[-1], [points[0]])
    ways_m = ways_home_m(planned.chart, points, planned.clearance_m, back_m)
    return budget_of(points, holds_s, ways_m, boat, mission.speed_m_s, current or STILL_WATER)
