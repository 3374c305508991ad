"""A survey: passes along the shores of an area, parallel tracks over the rest, and transits between."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

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
from mission_tools.tasks.survey.coverage import coverage
from mission_tools.tasks.survey.legs import joined_legs
from mission_tools.tasks.survey.patterns import pattern
from mission_tools.tasks.survey.postman import Pass, with_spikes
from mission_tools.tasks.survey.settings import SurveySettings
from mission_tools.tasks.survey.shore_pass import passes_along
from mission_tools.tasks.survey.tracks import Tracks, fewest_turns_rad, lay_tracks, lines_across, together
from mission_tools.tasks.survey.turns import with_turns
from mission_tools.tasks.survey.visits import in_best_order
from mission_tools.tasks.task_route import TaskRoute, joined

Array = NDArray[np.float64]
LEAST_COVERED = 0.995  # the smallest places may be left out
MUCH_LONGER = 1.01  # lengths of routes in a good order differ so much by chance
LEAST_NOTED = 0.01  # of the water
CORNER_INSET = 0.5 * math.sqrt(0.5)  # of the footprint: so near to an edge, its square corners are covered


@dataclass(frozen=True, slots=True)
class Survey:
    """A planned survey.

    route: its legs; tracks, shore passes and cross lines, and the transits between them. target: what it is
    asked to cover: the part of the area within half a footprint of the water that the boat can reach with its
    clearance and margin. coverage: the share of the target within half a footprint of the route.
    """

    route: TaskRoute
    target: BaseGeometry
    swath_m: float
    spacing_m: float
    course_rad: float
    tracks: int
    coverage: float

    @property
    def plain_m(self) -> float:
        """The length of parallel lines alone, without passes and transits: the area over the spacing."""
        return float(self.target.area) / self.spacing_m


def survey(
    chart: Chart, start: Point | None, settings: SurveySettings, area: Polygon | MultiPolygon | None = None
) -> Survey:
    """Plan a survey of an area; of the whole water that the boat can reach, where that is None.

    Of the numbers of passes along the shores that the settings leave open, the one with the shortest route is
    taken among those that cover LEAST_COVERED of the target. Fewer are tried while that is not much longer.

    start: where the boat is; None begins at the most convenient track. Of waters that are apart, the one with
    the start is surveyed, without a start the largest. area: in the chart's frame, x = east and y = north;
    land in it is left out. Raises UsageError: open water without an area, or far too many tracks. NoRoute: no
    water in the area is wide enough for the clearance. NoRouteError: the start is no place for a boat.
    """
    tried, room = list[Survey](), _room(chart, start, settings, area)
    for passes in settings.pass_choices:
        tried.append(_survey(chart, start, replace(settings, shore_passes=passes), room))
        if tried[-1].route.length_m > MUCH_LONGER * tried[0].route.length_m:
            break
    least = min(LEAST_COVERED, max(one.coverage for one in tried))
    return min(
        (one for one in tried if one.coverage >= least), key=lambda one: (one.route.length_m, one.tracks)
    )


class _Room(NamedTuple):
    """reached: water with the clearance. wide: of it, that with the margin too. water: of that, what is to be
    covered, the rafts in it not cut out. target: as of `Survey`. notes: what is out of reach.
    """

    reached: Polygon
    wide: MultiPolygon
    rafts: MultiPolygon
    water: list[Polygon]
    target: BaseGeometry
    notes: list[str]


def _room(
    chart: Chart, start: Point | None, settings: SurveySettings, area: Polygon | MultiPolygon | None
) -> _Room:
    plan, swath_m = settings.plan, settings.swath_m
    if area is None and chart.is_open:
        raise UsageError("open water has no end: name an area to survey")
    reached = water_reached_from(water_clear_of_shores(chart, plan.clearance_m), start)
    wide = [reached]
    if plan.margin_m > 0.0:
        wide = polygons(MultiPolygon(water_clear_of_shores(chart, plan.required_m)).intersection(reached))
    open_water, rafts = _without_rafts(wide, swath_m)
    inset_m = 0.0 if settings.has_gaps else CORNER_INSET * swath_m
    water = open_water if area is None else _inside(open_water, area, inset_m)
    _check_water(water, settings)
    target = (
        MultiPolygon(wide).buffer(0.5 * swath_m, quad_segs=QUADRANT_SEGMENTS).intersection(chart.navigable)
    )
    if area is not None:
        target = target.intersection(area)
    notes = _left_out(chart, target, area, plan.required_m)
    return _Room(reached, MultiPolygon(wide), rafts, water, target, notes)


def _survey(chart: Chart, start: Point | None, settings: SurveySettings, room: _Room) -> Survey:
    reached, water, target, swath_m = room.reached, room.water, room.target, settings.swath_m
    rings: list[Array] = []
    inside: Sequence[Polygon] = water
    if settings.shore_passes:
        rings, inside = passes_along(chart, water, target.union(room.rafts), settings)
    passes = [Pass(ring) for ring in rings]
    if passes:
        inside = with_spikes(passes, inside, reached, swath_m)
    course_rad = settings.angle_rad
    if course_rad is None:
        course_rad = 0.0 if settings.pattern else fewest_turns_rad(inside or water)
    tracks = _tracks(inside, course_rad, MultiPolygon(water), settings)
    origin = None if start is None else np.array([start.east_m, start.north_m])
    end = origin if settings.is_return else None
    detail_m = 0.25 * swath_m
    radius_m = settings.turn_radius_m
    visits = in_best_order(tracks, reached, origin, end, detail_m, "track", radius_m, passes, settings.gap_m)
    if settings.pattern:
        datum = None
        if settings.datum is not None:
            datum = np.array([settings.datum.east_m, settings.datum.north_m])
        visits = pattern(settings.pattern, datum, course_rad, settings.track_spacing_m, water)
    if settings.cross_spacing_m is not None:
        lines = lines_across(water, course_rad + 0.5 * math.pi, settings.cross_spacing_m)
        last = visits[-1].points[-1] if visits else origin
        visits += in_best_order(lines, reached, last, end, detail_m, "cross")
    legs, short = joined_legs(chart, visits, start, (room.wide, room.rafts), settings)
    notes = (
        [f"{short} ends of tracks have no {settings.lead_m:g} m of water to lead in or out"] if short else []
    )
    if settings.turn_radius_m > 0.0:
        legs, tighter = with_turns(legs, room.wide, settings.turn_radius_m)
        if tighter:
            notes.append(f"{tighter} turns are tighter than {settings.turn_radius_m:g} m for lack of room")
    route = joined(legs, [*notes, *room.notes])
    return Survey(
        route,
        target,
        swath_m,
        settings.track_spacing_m,
        course_rad,
        sum(leg.kind == "track" for leg in legs) if settings.pattern else len(tracks.tracks),
        coverage(route.points, target, swath_m),
    )


def _check_water(water: Sequence[Polygon], settings: SurveySettings) -> None:
    """See that tracks may fit. Raises NoRoute: no water. UsageError: the area is narrower than their gap."""
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


def _tracks(
    inside: Sequence[Polygon], course_rad: float, room: MultiPolygon, settings: SurveySettings
) -> Tracks:
    if not inside or settings.pattern:
        return Tracks(course_rad, (), ())
    groups = [[gap] for gap in inside] if settings.has_gaps else [inside]
    spacing_m, swath_m = settings.track_spacing_m, settings.swath_m
    return together([lay_tracks(group, course_rad, spacing_m, swath_m, room) for group in groups])


def _inside(water: Sequence[Polygon], area: Polygon | MultiPolygon, inset_m: float) -> list[Polygon]:
    """The water from which the footprint reaches the edge of the area, but not much beyond."""
    inset = area.buffer(-inset_m, join_style="mitre")
    inset = area if inset.is_empty else inset
    return [piece for part in water for piece in polygons(part.intersection(inset))]


def _without_rafts(water: Sequence[Polygon], swath_m: float) -> tuple[list[Polygon], MultiPolygon]:
    """The water with the islands that are no wider than a footprint, clearance included; and those.

    Lines lead round them and still see both sides. A pass round one of width w is longer than what tracks
    save by it by more than 2 w, and the way round it is at most (π/2 - 1) w longer than straight on.
    """
    found, rafts = list[Polygon](), list[Polygon]()
    for piece in water:
        holes = [Polygon(ring) for ring in piece.interiors]
        small = [2.0 * shapely.minimum_bounding_radius(hole) <= swath_m for hole in holes]
        rafts += [hole for hole, is_small in zip(holes, small, strict=True) if is_small]
        found.append(
            Polygon(
                piece.exterior,
                [hole.exterior for hole, is_small in zip(holes, small, strict=True) if not is_small],
            )
        )
    return found, MultiPolygon(rafts)
