"""A mission with what it was planned from."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from companion.core.geo import Point
from mission_tools.assembly.timetable import Timetable
from mission_tools.maps import Chart
from mission_tools.mission.mission import Mission
from mission_tools.mission.trigger import Trigger
from mission_tools.planning.planner import Plan
from mission_tools.tasks.task_route import Parts, TaskRoute

if TYPE_CHECKING:
    from mission_tools.tasks.survey.survey import Survey


@dataclass(frozen=True, slots=True)
class PlannedMission:
    """A mission and where it comes from: a plan, a task's legs, or neither for a mission from a file.

    clearance_m: that was asked for; 0 for a mission from a file. notes: for the user. survey: what the task's
    legs cover, if it is a survey. margin_m: that a task keeps on top of the clearance. timetable: None where
    nobody asked for times. parts: of a split one. trigger: of the sensor along its tracks.
    """

    name: str
    mission: Mission
    chart: Chart
    plan: Plan | None = None
    task: TaskRoute | None = None
    clearance_m: float = 0.0
    notes: tuple[str, ...] = ()
    survey: "Survey | None" = None
    margin_m: float = 0.0
    timetable: Timetable | None = None
    parts: Parts = ()
    trigger: Trigger | None = None

    @property
    def points(self) -> tuple[Point, ...]:
        """Home and the mission's places in the chart's frame."""
        places = [*([self.mission.home] if self.mission.home else []), *self.mission.places]
        return tuple(self.chart.frame.to_local(place) for place in places)
