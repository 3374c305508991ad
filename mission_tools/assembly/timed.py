"""Times of a mission that is as it is: from a file, of a task, or planned without a current."""

from dataclasses import replace

from mission_tools.assembly.plan_options import PlanOptions
from mission_tools.assembly.planned_costs import current_of, travel_of
from mission_tools.assembly.planned_mission import PlannedMission
from mission_tools.assembly.timetable import fixed_route
from mission_tools.costs.departure import Departure


def timed(planned: PlannedMission, options: PlanOptions) -> PlannedMission:
    """The mission with a timetable, if times are asked for and it has none. Raises NoRoute: a leg that cannot
    be sailed against the current. UsageError: a departure that does not go with it.
    """
    mission, points = planned.mission, planned.points
    is_asked = options.current is not None or options.depart is not None
    if planned.timetable is not None or not is_asked or mission.home is None or len(points) < 2:
        return planned
    current = current_of(planned.chart, options)
    departure = Departure.of(options.depart, current.times)
    asked = replace(options, speed_m_s=mission.speed_m_s, open_water_m=None)
    travel = travel_of(planned.chart, points, asked, current)
    holds_s = [item.hold_s for item in mission.items if item.place is not None]
    table = fixed_route(travel, points, departure, (0.0, *holds_s))
    return replace(planned, timetable=table, notes=(*planned.notes, *table.notes(current.times)))
