"""The path of an intent as a list of corners."""

import math

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point, bearing_rad, distance_m
from companion.core.intent import (
    FollowCircle,
    FollowLeg,
    HoldCourse,
    HoldHeading,
    HoldTurn,
    Intent,
    KeepStation,
)
from companion.core.state import NavState

_STEP_RAD = 0.35  # between corners on a circle


def way_ahead(intent: Intent, nav: NavState, config: BoatConfig, reach_m: float) -> list[Point]:
    """Starts at the boat; a single corner for an intent without a destination."""
    here = nav.point
    if isinstance(intent, FollowLeg):
        return _leg(intent, here, config.guidance.lookahead_m)
    if isinstance(intent, KeepStation):
        return [here, intent.point] if distance_m(here, intent.point) > 0.0 else [here]
    if isinstance(intent, FollowCircle):
        return [here, *_arc(intent, here, reach_m)]
    if isinstance(intent, HoldCourse):
        return [here, _beyond(here, intent.course_rad, reach_m)]
    if isinstance(intent, HoldHeading | HoldTurn):
        heading = intent.heading_rad if isinstance(intent, HoldHeading) else nav.heading_rad
        if intent.speed_m_s < 0.0:
            heading += math.pi
        return [here, _beyond(here, heading, reach_m)] if intent.speed_m_s else [here]
    return [here]


def _leg(leg: FollowLeg, here: Point, lookahead_m: float) -> list[Point]:
    """Back to the line, along it, and on to the next leg."""
    way = [here]
    line = leg.line
    if line.length_m > 0.0:
        along, cross = line.along_and_cross_track_m(here)
        joins = along + min(lookahead_m, 2.0 * abs(cross))
        if 0.0 < joins < line.length_m:
            share = joins / line.length_m
            way.append(
                Point(
                    line.start.north_m + share * (line.end.north_m - line.start.north_m),
                    line.start.east_m + share * (line.end.east_m - line.start.east_m),
                )
            )
    way.append(leg.end)
    if leg.next_end is not None:
        way.append(leg.next_end)
    return way


def _arc(circle: FollowCircle, here: Point, reach_m: float) -> list[Point]:
    side = 1.0 if circle.clockwise else -1.0
    first = bearing_rad(circle.centre, here) if here != circle.centre else 0.0
    count = max(1, math.ceil(min(reach_m / (_STEP_RAD * circle.radius_m), math.tau / _STEP_RAD)))
    return [
        _beyond(circle.centre, first + side * step * _STEP_RAD, circle.radius_m)
        for step in range(1, count + 1)
    ]


def _beyond(start: Point, course_rad: float, way_m: float) -> Point:
    return Point(start.north_m + way_m * math.cos(course_rad), start.east_m + way_m * math.sin(course_rad))
