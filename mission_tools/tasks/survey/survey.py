"""A survey: parallel tracks that cover an area of water, a pass along its shore, and the transits that join
them.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from companion.core.geo import Point
from mission_tools.errors import NoRoute, UsageError
from mission_tools.maps.chart import Chart
from mission_tools.tasks.room import (
    QUADRANT_SEGMENTS,
    polygons,
    water_clear_of_shores,
    water_reached_from,
)
from mission_tools.tasks.survey.coverage import coverage, least_transits_m
from mission_tools.tasks.survey.settings import SurveySettings
from mission_tools.tasks.survey.shore_pass import CORNER_INSET, RING_ERROR, passes_along, water_within_pass
from mission_tools.tasks.survey.tracks import Tracks, fewest_turns_rad, lay_tracks, lines_across
from mission_tools.tasks.survey.turns import with_turns
from mission_tools.tasks.survey.visits import Visit, in_best_order, with_rings
from mission_tools.tasks.task_route import TaskLeg, TaskRoute, Transits, joined

Array = NDArray[np.float64]
LEAST_NOTED = 0.01  # of the water


@dataclass(frozen=True, slots=True)
class Survey:
    """A planned survey.

    route: its legs; tracks, shore passes and cross lines, and the transits between them. target: what it is
    asked to cover: the part of the area within half a footprint of the water that the boat can reach with its
    clearance and margin. coverage: the share of the target within half a footprint of the route. least_m: no
    route that sails the same tracks and passes is shorter than this.
    """

    route: TaskRoute
    target: BaseGeometry
    swath_m: float
    spacing_m: float
    course_rad: float
    tracks: int
    coverage: float
    least_m: float

    @property
    def length_ratio(self) -> float:
        """The route's length over least_m."""
        return self.route.length_m / self.least_m if self.least_m > 0.0 else 1.0


def survey(
    chart: Chart, start: Point | None, settings: SurveySettings, area: Polygon | MultiPolygon | None = None
) -> Survey:
    """Plan a survey of an area; of the whole water that the boat can reach, where that is None.

    start: where the boat is; None begins at the most convenient track. Of waters that are apart, the one with
    the start is surveyed, without a start the largest. area: in the chart's frame, x = east and y = north;
    land in it is left out. Raises UsageError: open water without an area, or far too many tracks. NoRoute: no
    water in the area is wide enough for the clearance. NoRouteError: the start is no place for a boat.
    """
    plan, swath_m = settings.plan, settings.swath_m
    if area is None and chart.is_open:
        raise UsageError("open water has no end: name an area to survey")
    reached = water_reached_from(water_clear_of_shores(chart, plan.clearance_m), start)
    wide = [reached]
    if plan.margin_m > 0.0:
        wide = polygons(MultiPolygon(water_clear_of_shores(chart, plan.required_m)).intersection(reached))
    water = wide if area is None else _inside(wide, area, swath_m)
    _check_water(water, settings)
    target = (
        MultiPolygon(wide).buffer(0.5 * swath_m, quad_segs=QUADRANT_SEGMENTS).intersection(chart.navigable)
    )
    if area is not None:
        target = target.intersection(area)
    rings: list[Array] = []
    inside: Sequence[Polygon] = polygons(target)
    if settings.shore_pass:
        within = water_within_pass(chart, water, target, swath_m)
        rings = passes_along(chart, within, plan.required_m, swath_m)
        inside = polygons(MultiPolygon(within).buffer(-(0.5 - RING_ERROR) * swath_m))
    course_rad = settings.angle_rad
    if course_rad is None:
        course_rad = fewest_turns_rad(inside or water)
    tracks = Tracks(course_rad, (), ())
    if inside:
        room = None if rings else MultiPolygon(water)
        tracks = lay_tracks(inside, course_rad, settings.track_spacing_m, swath_m, room)
    origin = None if start is None else np.array([start.east_m, start.north_m])
    end = origin if settings.is_return else None
    detail_m = 0.25 * swath_m
    radius_m = settings.turn_radius_m
    visits = in_best_order(tracks, reached, origin, end, detail_m, "track", radius_m)
    if rings:
        visits = with_rings(visits, rings, reached, origin, 0.5 * swath_m)
    ends = tracks.ends() if tracks.tracks else np.zeros((0, 2))
    least_m = sum(float(np.hypot(*np.diff(visit.points, axis=0).T).sum()) for visit in visits)
    least_m += least_transits_m(ends, [shapely.LineString(ring) for ring in rings], origin, 4.0 * swath_m)
    if settings.cross_spacing_m is not None:
        lines = lines_across(water, course_rad + 0.5 * math.pi, settings.cross_spacing_m)
        last = visits[-1].points[-1] if visits else origin
        visits += in_best_order(lines, reached, last, end, detail_m, "cross")
        least_m += sum(track.high_m - track.low_m for track in lines.tracks)
        least_m += least_transits_m(lines.ends(), [], None, swath_m)
    legs, notes = _joined_legs(chart, visits, start, MultiPolygon(wide), settings), []
    if settings.turn_radius_m > 0.0:
        legs, tighter = with_turns(legs, MultiPolygon(wide), settings.turn_radius_m)
        if tighter:
            notes.append(f"{tighter} turns are tighter than {settings.turn_radius_m:g} m for lack of room")
    notes += _left_out(chart, target, area, plan.required_m)
    route = joined(legs, notes)
    return Survey(
        route,
        target,
        swath_m,
        settings.track_spacing_m,
        course_rad,
        len(tracks.tracks),
        coverage(route.points, target, swath_m),
        least_m,
    )


def _check_water(water: Sequence[Polygon], settings: SurveySettings) -> None:
    """See that tracks may fit. Raises NoRoute: no water. UsageError: the tracks are farther apart than the
    area is across.
    """
    if not water:
        raise NoRoute(f"no water in the area keeps {settings.plan.required_m:g} m from every shore")
    west, south, east, north = MultiPolygon(water).bounds
    across_m, spacing_m = math.hypot(east - west, north - south), settings.track_spacing_m
    if spacing_m > across_m:
        raise UsageError(
            f"tracks {spacing_m:g} m apart, but the area is {across_m:.0f} m across: expected less"
        )


def _left_out(
    chart: Chart, target: BaseGeometry, area: Polygon | MultiPolygon | None, required_m: float
) -> list[str]:
    """What a person should know about water that the survey leaves out, if that is more than LEAST_NOTED."""
    wanted = chart.navigable if area is None else chart.navigable.intersection(area)
    share = 1.0 - target.area / wanted.area
    if share <= LEAST_NOTED:
        return []
    what = "water" if area is None else "water in the area"
    return [f"{share:.0%} of the {what} is out of reach with {required_m:g} m kept from every shore"]


def _inside(water: Sequence[Polygon], area: Polygon | MultiPolygon, swath_m: float) -> list[Polygon]:
    """The water from which the footprint reaches the edge of the area, but not much beyond."""
    inset = area.buffer(-CORNER_INSET * swath_m, join_style="mitre")
    inset = area if inset.is_empty else inset
    return [piece for part in water for piece in polygons(part.intersection(inset))]


def _joined_legs(
    chart: Chart, visits: Sequence[Visit], start: Point | None, wide: MultiPolygon, settings: SurveySettings
) -> list[TaskLeg]:
    """Visits and the transits between them: straight where that lies in the water, planned elsewhere."""
    transits = Transits(chart, settings.plan)
    shapely.prepare(wide)
    legs: list[TaskLeg] = []
    here = start
    for visit in visits:
        points = tuple(Point(float(north_m), float(east_m)) for east_m, north_m in visit.points)
        if here is not None and here != points[0]:
            straight = shapely.LineString([(here.east_m, here.north_m), visit.points[0]])
            way = (here, points[0]) if wide.covers(straight) else transits.route(here, points[0])
            legs.append(TaskLeg("transit", way))
        legs.append(TaskLeg(visit.kind, points))
        here = points[-1]
    if settings.is_return and start is not None and here is not None and here != start:
        legs.append(TaskLeg("transit", transits.route(start, here)[::-1]))
    return legs
