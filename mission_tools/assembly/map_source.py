"""A route planned on a map, as a mission."""

from dataclasses import replace
from typing import TYPE_CHECKING

import shapely

from companion.core.geo import LatLon, Point, distance_m
from mission_tools.assembly.areas import NO_AREAS, Areas
from mission_tools.assembly.plan_options import PlanOptions
from mission_tools.assembly.planned_mission import PlannedMission
from mission_tools.assembly.planned_task import (
    SurveyArea,
    check_task,
    named_survey_area,
    survey_of,
    task_route,
)
from mission_tools.assembly.zone_speeds import mission_in_zones
from mission_tools.costs.travel import speed_zones
from mission_tools.errors import NoRoute, NoRouteError, UsageError
from mission_tools.maps import Chart, Source
from mission_tools.maps.fenced import fenced
from mission_tools.maps.passable import BoatSize, bars, limit_m, passable
from mission_tools.mission.mission import Fence
from mission_tools.mission.route import mission_along
from mission_tools.mission.trigger import parse_trigger
from mission_tools.planning.planner import PlanSettings, plan
from mission_tools.tasks.task_route import Stop, TaskRoute, mission_of

if TYPE_CHECKING:
    from mission_tools.tasks.survey.survey import Survey

MOST_MARGIN_M = 0.6  # deviation from the plan at corners and by GNSS error
MARGIN_SHARE = 0.15  # of the clearance, where that is small


class MapSource:
    """A map on which a route is planned. area: to survey, instead of a file that the options name."""

    def __init__(
        self,
        text: str,
        source: Source,
        options: PlanOptions,
        areas: Areas = NO_AREAS,
        area: SurveyArea | None = None,
    ) -> None:
        self._survey_area = area
        self._text, self._source = text, source
        self._chart = within(passable(source.chart, _size(options)), areas)
        self._notes = tuple(dict.fromkeys((*self._chart.notes, *areas.notes)))
        self._areas = areas
        # The shortest tour that comes home is the one to cut; a shore is followed all round as it is
        is_closed = options.is_return or (options.split and options.follow_shore_at is None)
        self._wishes = options = replace(options, is_return=is_closed)
        self._settings = PlanSettings.from_route(
            source.route,
            clearance_m=options.clearance_m,
            cell_m=options.cell_m,
            heuristic=options.heuristic,
            smooth=options.smooth,
        )
        if source.route.margin_m is None:
            margin_m = min(MOST_MARGIN_M, MARGIN_SHARE * self._settings.clearance_m)
            self._settings = replace(self._settings, margin_m=margin_m)
        self._named_start = self._local("--start-at", options.start_at) if options.start_at else None
        self._usual_start = source.route.start
        check_task(options)
        self._trigger = None if options.trigger is None else parse_trigger(options.trigger)
        options.check_costs()
        self._stops = self._stops_of(text, source)

    @property
    def wants_position(self) -> bool:
        """Whether the route starts at the boat: no start is given."""
        return self._named_start is None

    @property
    def needs_position(self) -> bool:
        """Whether there is no start but the boat's position."""
        return self._named_start is None and self._usual_start is None

    def prepare(self, here: LatLon | None = None) -> PlannedMission:
        """Plan a route; `here` is where the boat is, used where no start was named. Raises NoRouteError:
        there is none; says what is in the way. UsageError: no start.
        """
        try:
            return self._planned(here)
        except NoRoute as error:
            raise NoRoute(self._what_bars(here) or str(error)) from None

    def _what_bars(self, here: LatLon | None) -> str:
        """What is not deep or high enough for the boat; "" if that is not what is in the way."""
        wishes = self._wishes
        for size_m, enough, over, options in (
            (wishes.draught_m, "deep enough for --draught", "over", replace(wishes, draught_m=None)),
            (
                wishes.air_draught_m,
                "high enough for --air-draught",
                "below",
                replace(wishes, air_draught_m=None),
            ),
        ):
            if size_m is None:
                continue
            try:
                free = MapSource(self._text, self._source, options, self._areas, self._survey_area).prepare(
                    here
                )
            except NoRouteError:
                continue
            way = shapely.LineString([(at.east_m, at.north_m) for at in free.points])
            found = [
                f"{feature.described} ({limit_m(feature):g} m)"
                for feature in self._source.chart.features
                if bars(feature, _size(wishes)) and feature.shape.intersects(way)
            ]
            what = ", ".join(found[:2]) or "what is less"
            return f"no way is {enough} {size_m:g}; without it the route leads {over} {what}"
        return ""

    def _planned(self, here: LatLon | None) -> PlannedMission:
        start = self._named_start or self._start_of(here)
        chart, speed_m_s, clearance_m = self._chart, self._wishes.speed_m_s, self._settings.clearance_m
        survey: Survey | None = None
        task: TaskRoute | None
        if self._wishes.survey is not None:
            area = self._survey_area or named_survey_area(chart, self._wishes.survey)
            survey = survey_of(chart, start, self._wishes, self._settings, area, self._local)
            task = survey.route
        else:
            task = task_route(chart, start, self._stops, self._wishes, self._settings, self._local)
        if task is not None:
            mission = self._areas.over(mission_of(task, chart.frame, speed_m_s, self._trigger))
            notes = (*self._notes, *task.notes)
            margin_m = self._settings.margin_m
            return PlannedMission(
                chart.name,
                mission,
                chart,
                None,
                task,
                clearance_m,
                notes,
                survey,
                margin_m,
                trigger=self._trigger,
            )
        assert start is not None  # noqa: S101  _start_of raises before
        *via, goal = (stop.place for stop in self._stops)
        found = plan(chart, start, goal, self._settings, via)
        timetable = None
        if self._wishes.has_costs:
            from mission_tools.assembly.planned_costs import cheapest  # noqa: PLC0415 - scipy, seldom needed

            found, timetable = cheapest(chart, found, (start, *via, goal), self._wishes)
        places = [chart.frame.to_global(point) for point in found.points]
        zones = speed_zones(chart)
        slowed = mission_in_zones(chart.frame, found.points, zones, speed_m_s) if zones else None
        mission = self._areas.over(slowed or mission_along(places, speed_m_s))
        notes = (*self._notes, *found.notes)
        return PlannedMission(
            chart.name, mission, chart, found, None, clearance_m, notes, timetable=timetable
        )

    def _stops_of(self, text: str, source: Source) -> list[Stop]:
        """Where the route leads, the goal last. Raises UsageError: nowhere."""
        options, route = self._wishes, source.route
        if options.starts_anywhere:
            return []
        hold_s = options.hold_s or 0.0
        stops = [
            Stop(
                self._local("--via", via.place), hold_s if via.hold_s is None else via.hold_s, f"via {number}"
            )
            for number, via in enumerate(options.via, start=1)
        ]
        if not options.via and not options.goal:  # points in between belong to the scenario's own goal
            stops = [Stop(place) for place in route.via]
        goal = self._local("--goal", options.goal) if options.goal else route.goal
        if goal is not None:
            stops.append(Stop(goal, hold_s, "goal"))
        if not stops:
            cases = f", or --case with one of {', '.join(source.cases)}" if source.cases else ""
            raise UsageError(f"{text} names no goal: add --goal LAT,LON{cases}")
        return stops

    def _start_of(self, here: LatLon | None) -> Point | None:
        """The boat's position, or the scenario's start if that is unknown or within the clearance.

        None where the task finds a start of its own. Raises UsageError: neither is known.
        """
        usual = self._usual_start
        if here is None:
            if usual is None and not self._wishes.starts_anywhere:
                asking = "mission-upload without --dry-run asks the boat"
                raise UsageError(f"no start: add --start-at LAT,LON ({asking})")
            return usual
        at = self._local("the boat", here)
        # A boat that still lies at the scenario's start may seem to lie ashore there, by its receiver's error
        is_there = usual is not None and distance_m(at, usual) <= self._settings.clearance_m
        return usual if usual is not None and is_there else at

    def _local(self, what: str, place: LatLon) -> Point:
        """A place in the chart's frame. Raises UsageError: so far away that the frame does not reach it."""
        if not self._chart.reaches(place):
            origin = self._chart.frame.origin
            said = (
                f"{what}: {place.lat_deg:.6f},{place.lon_deg:.6f} is nowhere near {self._chart.name} "
                f"at {origin.lat_deg:.6f},{origin.lon_deg:.6f}"
            )
            if abs(place.lon_deg) <= 90.0 and self._chart.reaches(LatLon(place.lon_deg, place.lat_deg)):
                said += ": latitude and longitude look swapped, here or in the map; expected LAT,LON"
            raise UsageError(said)
        return self._chart.frame.to_local(place)


def _size(options: PlanOptions) -> BoatSize:
    return BoatSize(options.draught_m, options.air_draught_m)


def within(chart: Chart, areas: Areas) -> Chart:
    """The chart restricted by the fence, if there is one."""
    if areas.fence is None or areas.fence == Fence():
        return chart
    return fenced(chart, areas.fence, areas.fence_name)
