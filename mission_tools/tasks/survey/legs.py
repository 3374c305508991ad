"""The legs of a survey: visits, clear of what is small, their leads, and the transits between them."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon

from companion.core.geo import Point, distance_m
from mission_tools.maps.chart import Chart
from mission_tools.tasks.survey.postman import Visit
from mission_tools.tasks.survey.settings import SurveySettings
from mission_tools.tasks.task_route import TaskLeg, Transits, joined

Array = NDArray[np.float64]
LEAD_ERROR_M = 0.01  # as fine as positions go over the wire
DETAIL_M = 0.1  # of the way round something: nearer waypoints are one


def joined_legs(
    chart: Chart,
    visits: Sequence[Visit],
    start: Point | None,
    waters: tuple[MultiPolygon, MultiPolygon],
    settings: SurveySettings,
) -> tuple[Sequence[TaskLeg], int]:
    """Visits and the transits between them: straight where that lies in the water, planned elsewhere.

    waters: where the boat may sail, and what of the visits it sails round. Returns the legs, and how many
    ends of tracks have less water ahead than the lead.
    """
    transits, (wide, rafts) = Transits(chart, settings.plan), waters
    shapely.prepare(wide)
    legs: list[TaskLeg] = []
    here, short = start, 0
    for visit in visits:
        points = _clear_points(chart, visit.points, rafts, transits, settings.plan.clearance_m)
        if not points:
            continue
        lead_in, lead_out = points[0], points[-1]
        if settings.lead_m and len(visit.points) == 2 and points[0] != points[-1]:
            lead_in, lead_out = (
                _led(ahead, end, wide, settings.lead_m) for ahead, end in (points[1::-1], points[-2:])
            )
            short += sum(
                distance_m(lead, end) < settings.lead_m - LEAD_ERROR_M
                for lead, end in ((lead_in, points[0]), (lead_out, points[-1]))
            )
        if here is not None and here != lead_in:
            straight = shapely.LineString([(at.east_m, at.north_m) for at in (here, lead_in)])
            way = (here, lead_in) if wide.covers(straight) else transits.route(here, lead_in)
            legs.append(TaskLeg("transit", way))
        legs.append(TaskLeg("transit", (lead_in, points[0])))
        legs.append(TaskLeg(visit.kind, points))
        legs.append(TaskLeg("transit", (points[-1], lead_out)))
        here = lead_out
    if settings.is_return and start is not None and here is not None and here != start:
        legs.append(TaskLeg("transit", transits.route(start, here)[::-1]))
    return joined(legs).legs, short


def _led(inner: Point, end: Point, water: MultiPolygon, lead_m: float) -> Point:
    """Straight on past the end of a track, so far as there is water."""
    share = lead_m / max(distance_m(inner, end), 1e-9)
    ahead = end.towards(inner, -share)
    line = shapely.LineString([(end.east_m, end.north_m), (ahead.east_m, ahead.north_m)])
    if water.covers(line):
        return ahead
    parts = shapely.get_parts(line.intersection(water))
    at = shapely.Point(line.coords[0])
    reach_m = max((part.length for part in parts if part.distance(at) < LEAD_ERROR_M), default=0.0)
    return _point(shapely.get_coordinates(line.interpolate(reach_m))[0]) if reach_m > LEAD_ERROR_M else end


def _clear_points(
    chart: Chart, xy: Array, rafts: MultiPolygon, transits: Transits, clearance_m: float
) -> tuple[Point, ...]:
    """A visit's points, where a leg comes too near to a shore with the way round; without what lies there."""
    legs = shapely.linestrings(np.stack((xy[:-1], xy[1:]), axis=1)) if len(xy) > 1 else shapely.points(xy)
    is_near = shapely.dwithin(chart.shores, legs, clearance_m * (1.0 - 1e-6)) | shapely.intersects(
        rafts, legs
    )
    if not is_near.any():
        return tuple(map(_point, xy))
    found: list[Point] = []
    for leg, near in zip(legs, is_near, strict=True):
        parts = shapely.get_parts(leg.difference(rafts)) if near else np.array([leg])
        begin = shapely.get_point(leg, 0) if len(xy) > 1 else leg
        for part in sorted(parts[~shapely.is_empty(parts)], key=begin.distance):
            places = [_point(at) for at in shapely.get_coordinates(part)]
            if found and found[-1] != places[0]:
                early_m = distance_m(found[-1], places[0])
                if len(found) > 1:
                    found.append(_early(found.pop(), found[-1], early_m))
                places = [_early(places[0], places[-1], early_m), places[-1]]
                found += transits.route(found[-1], places[0])[1:]
            found = found or places[:1]
            is_whole = near and len(parts) == 1
            found += transits.route(places[0], places[-1])[1:] if is_whole else places[1:]
    apart = [at for before, at in pairwise(found[:-1]) if distance_m(before, at) > DETAIL_M]
    return (*found[:1], *apart, *found[1:][-1:])


def _early(end: Point, other: Point, early_m: float) -> Point:
    """Before the end of a leg by so much, or by half of the leg: a boat under way turns only so sharply."""
    share = min(0.5, early_m / max(distance_m(end, other), 1e-9))
    return end.towards(other, share)


def _point(xy: Array) -> Point:
    return Point(float(xy[1]), float(xy[0]))
