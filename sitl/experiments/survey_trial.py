"""A survey planned on the scenario's map and sailed in lockstep: what was really covered."""

from collections.abc import Callable
from dataclasses import dataclass

import shapely
from shapely.geometry import MultiPolygon, Polygon

from companion.core.geo import Point
from mission_tools.tasks.survey.coverage import coverage
from mission_tools.tasks.survey.settings import SurveySettings
from mission_tools.tasks.survey.survey import Survey, survey
from mission_tools.tasks.task_route import mission_of
from sitl.courses.missions import wire_items
from sitl.run.mission_run import MissionRun, Result
from sitl.run.station_commands import RunError
from sitl.world.scenario import Scenario

THINNED_M = 0.05  # how far a thinned track may leave the true one


@dataclass(frozen=True, slots=True)
class SailedSurvey:
    """A survey, the figures of its run, the boat's true track, and the share of the target it covered."""

    planned: Survey
    result: Result
    track: tuple[Point, ...]
    coverage: float


def sail_survey(
    scenario: Scenario,
    settings: SurveySettings,
    area: Polygon | MultiPolygon | None = None,
    tell: Callable[[float, int], None] | None = None,
) -> SailedSurvey:
    """Plan from where the boat lies, sail, and measure the true track.

    Raises:
        NoRouteError: no water to survey.
        RunError: the boat refused the mission, or did not complete it.
    """
    planned = survey(scenario.chart, scenario.start, settings, area)
    mission_run = MissionRun(scenario, wire_items(mission_of(planned.route, scenario.frame)))
    result = mission_run.run(tell=tell)
    if not result.completed:
        raise RunError(f"the survey was not completed: {mission_run.ending()}")
    line = shapely.LineString([(point.east_m, point.north_m) for point in mission_run.recorder.track()])
    thinned = shapely.get_coordinates(line.simplify(THINNED_M, preserve_topology=False)).tolist()
    track = tuple(Point(north_m, east_m) for east_m, north_m in thinned)
    return SailedSurvey(planned, result, track, coverage(track, planned.target, planned.swath_m))
