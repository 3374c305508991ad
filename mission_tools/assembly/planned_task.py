"""From the options of a task (a survey, a shore, a tour) to a route in legs."""

import cmath
import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal, NamedTuple, cast

import numpy as np
from shapely.geometry import MultiPolygon, Polygon

from companion.core.geo import LatLon, Point
from mission_tools.assembly.areas import FileAreas, load_fence
from mission_tools.assembly.plan_options import PlanOptions, flags
from mission_tools.errors import UsageError
from mission_tools.maps.chart import Chart
from mission_tools.maps.fenced import fence_area
from mission_tools.planning.planner import PlanSettings
from mission_tools.tasks.task_route import Stop, TaskRoute
from mission_tools.tasks.tour import tour
from mission_tools.wording import distance

if TYPE_CHECKING:
    from mission_tools.tasks.survey.survey import Survey

WHOLE_WATER = "all"
LUNAR_DAY_S = 89_428.0  # 24 h 50 min: two tides
_CURRENT_PLACES, _CURRENT_STEP_S = 500, 3600.0  # of its axis
_OF_SURVEYS = (
    "spacing_m",
    "footprint_m",
    "overlap",
    "angle_deg",
    "cross_m",
    "shore_passes",
    "turn_radius_m",
    "lead_m",
)
_OF_SHORES = ("distance_m", "shore_to", "first", "last")
_OF_TOURS = ("goal", "via", "any_order", "hold_s")


class SurveyArea(NamedTuple):
    """Where to survey, in the chart's frame; None for the whole water. notes: repairs in the area's file."""

    shape: Polygon | MultiPolygon | None
    notes: tuple[str, ...] = ()


def check_task(options: PlanOptions) -> None:
    """See that the options are those of one task. Raises UsageError: names the options."""
    given = options.given()
    tasks = [name for name in ("survey", "follow_shore_at") if name in given]
    if len(tasks) == 2:
        raise UsageError("--survey and --follow-shore are two tasks: plan one at a time")
    unfit: list[str] = []
    if "survey" not in given:
        unfit += [name for name in _OF_SURVEYS if name in given]
    if "follow_shore_at" not in given:
        unfit += [name for name in _OF_SHORES if name in given]
    if unfit:
        needs = "--survey" if unfit[0] in _OF_SURVEYS else "--follow-shore"
        raise UsageError(f"{', '.join(flags(unfit))}: only with {needs}")
    if options.at is not None and options.pattern is None:
        raise UsageError("--at: only with --pattern")
    of_tracks = [name for name in ("lead_m", "shore_passes", "cross_m") if name in given]
    if options.pattern is not None and of_tracks:
        raise UsageError(f"{', '.join(flags(of_tracks))}: not with --pattern, which has no tracks")
    if options.trigger is not None and not tasks:
        raise UsageError("--trigger: only with --survey or --follow-shore")
    of_tours = [name for name in _OF_TOURS if name in given]
    if tasks and of_tours:
        raise UsageError(f"{', '.join(flags(of_tours))}: not with {next(flags(tasks))}")
    if options.follow_shore_at is not None and options.is_return:
        raise UsageError("--return: not with --follow-shore")
    if options.follow_shore_at is not None and options.distance_m is None:
        raise UsageError("--follow-shore: expected --distance M as well")
    if "survey" in given and options.spacing_m is None and options.footprint_m is None:
        raise UsageError("--survey: expected --spacing M or --footprint M as well")


def task_route(
    chart: Chart,
    start: Point | None,
    stops: Sequence[Stop],
    options: PlanOptions,
    settings: PlanSettings,
    local: Callable[[str, LatLon], Point],
) -> TaskRoute | None:
    """The route of a task other than a survey; None where only a way from place to place is asked for.

    start: None only where the task finds its own. stops: where a tour leads. local: the place that an option
    names, in the chart's frame. Raises NoRouteError: no way leads there. UsageError: values that make no
    sense.
    """
    if options.follow_shore_at is not None:
        return _shore_of(chart, start, options, settings, local)
    assert start is not None  # noqa: S101  the caller refuses a tour without one
    if not options.is_task:
        return None
    return tour(chart, start, stops, settings, any_order=options.any_order, is_return=options.is_return)


def _shore_of(
    chart: Chart,
    start: Point | None,
    options: PlanOptions,
    settings: PlanSettings,
    local: Callable[[str, LatLon], Point],
) -> TaskRoute:
    """Along the shore that was named. Raises NoRouteError: too narrow, or no way leads there. UsageError:
    values that make no sense.
    """
    from mission_tools.tasks.shoreline import ShoreSettings, follow_shore  # noqa: PLC0415 - seldom needed

    assert options.follow_shore_at is not None  # noqa: S101  the caller's question
    assert options.distance_m is not None  # noqa: S101  checked by check_task
    side = cast(Literal["port", "starboard"], options.shore_to or "starboard")
    near = local("--follow-shore", options.follow_shore_at)
    ends = [
        None if place is None else local(name, place)
        for name, place in (("--first", options.first), ("--last", options.last))
    ]
    wanted = ShoreSettings(near, options.distance_m, settings, shore_to=side, first=ends[0], last=ends[1])
    return follow_shore(chart, start, wanted)


def survey_of(
    chart: Chart,
    start: Point | None,
    options: PlanOptions,
    settings: PlanSettings,
    area: SurveyArea,
    local: Callable[[str, LatLon], Point],
) -> "Survey":
    """The survey of an area. local: as for `task_route`. Raises NoRouteError: no water in it that is wide
    enough. UsageError: values that make no sense.
    """
    from mission_tools.tasks.survey.patterns import PatternName  # noqa: PLC0415 - seldom needed
    from mission_tools.tasks.survey.settings import SurveySettings  # noqa: PLC0415
    from mission_tools.tasks.survey.survey import survey  # noqa: PLC0415

    found = survey(
        chart,
        start,
        SurveySettings(
            options.spacing_m,
            options.footprint_m,
            options.overlap,
            angle_rad=_angle_rad(chart, options),
            plan=settings,
            shore_passes=options.shore_passes,
            cross_spacing_m=options.cross_m,
            turn_radius_m=_turn_radius_m(options),
            lead_m=options.lead_m or 0.0,
            pattern=cast(PatternName | None, options.pattern),
            datum=None if options.at is None else local("--at", options.at),
            has_gaps=options.fill_gaps is not None,
            is_return=options.is_return,
        ),
        area.shape,
    )
    route = TaskRoute(found.route.legs, (*area.notes, *found.route.notes, described(found)))
    return replace(found, route=route)


def _angle_rad(chart: Chart, options: PlanOptions) -> float | None:
    """The course of tracks; along the current: the axis on which it flows in the day after the departure, by
    the sum of the squares of its velocities as complex numbers (the principal axis of their scatter about
    zero). Raises UsageError: no current, or no departure where it needs one.
    """
    from mission_tools.assembly.planned_costs import current_of  # noqa: PLC0415 - seldom needed
    from mission_tools.costs.departure import Departure  # noqa: PLC0415
    from mission_tools.tasks.survey.coverage import sample_points  # noqa: PLC0415

    if options.angle_deg != "current":
        return None if options.angle_deg is None else math.radians(options.angle_deg)
    current = current_of(chart, options)
    begin_s = Departure.of(options.depart, current.times).begin_s
    east_m, north_m = sample_points(chart.navigable, _CURRENT_PLACES).T
    squares = 0j
    for time_s in begin_s + np.arange(0.0, LUNAR_DAY_S, _CURRENT_STEP_S):
        north_m_s, east_m_s = current.at(north_m, east_m, np.full_like(north_m, time_s))
        squares += complex(np.sum((north_m_s + 1j * east_m_s) ** 2))
    if abs(squares) == 0.0:
        raise UsageError("--angle current: add --current M/S,DEG or a file; in still water give degrees")
    return 0.5 * cmath.phase(squares) % math.pi


def _turn_radius_m(options: PlanOptions) -> float:
    """As given, else of the boat at the mission's speed; 0 without. Raises UsageError: no such boat."""
    from mission_tools.costs.boat import load_boat  # noqa: PLC0415 - seldom needed
    from mission_tools.tasks.survey.settings import turn_radius_m  # noqa: PLC0415

    if options.turn_radius_m is not None or options.boat is None:
        return options.turn_radius_m or 0.0
    boat = load_boat(options.boat)
    return turn_radius_m(boat, options.speed_m_s or boat.cruise_m_s)


def survey_area(chart: Chart, areas: FileAreas, name: str) -> SurveyArea:
    """The area inside a fence, `name` in messages. Raises MapError: no area, or far from the chart."""
    area = fence_area(chart, areas.fence, name)
    return SurveyArea(area if isinstance(area, Polygon | MultiPolygon) else MultiPolygon(), areas.notes)


def named_survey_area(chart: Chart, name: str) -> SurveyArea:
    """The area in a file. Raises MapError, PlanFileError: the file."""
    return SurveyArea(None) if name == WHOLE_WATER else survey_area(chart, load_fence(Path(name)), name)


def described(found: "Survey") -> str:
    """A survey in a line."""
    course_deg = math.degrees(found.course_rad) % 180.0
    return (
        f"survey: lines {distance(found.spacing_m)} apart, {found.tracks} tracks on {course_deg:.0f}°, "
        f"{100.0 * found.coverage:.1f} % of the area covered"
    )
