"""The path of an intent as a list of corners, its speed, and places along it."""

import math

from companion.config.boat_config import BoatConfig
from companion.core import intent as intents
from companion.core.geo import Point, bearing_rad, distance_m
from companion.core.state import NavState
from companion.guidance.line_of_sight import lookahead_m
from companion.guidance.speed_profile import braking_speed_m_s
from companion.obstacles.planning.clearance import ClearanceField

_STEP_RAD = 0.35  # between corners on a circle
_CLOSING = (0.5, 1.0, 2.0, 4.0)  # lookaheads


def way_ahead(intent: intents.Intent, nav: NavState, config: BoatConfig, reach_m: float) -> list[Point]:
    """Starts at the boat; a single corner for an intent without a destination."""
    here = nav.point
    if isinstance(intent, intents.FollowLeg):
        speed_m_s = math.hypot(nav.north_m_s, nav.east_m_s)
        return _leg(intent, here, lookahead_m(speed_m_s, config.speed.cruise_m_s, config.guidance))
    if isinstance(intent, intents.KeepStation):
        return [here, intent.point] if distance_m(here, intent.point) > 0.0 else [here]
    if isinstance(intent, intents.FollowCircle):
        return [here, *_arc(intent, here, reach_m)]
    if isinstance(intent, intents.HoldCourse):
        return [here, here.moved(intent.course_rad, reach_m)]
    if isinstance(intent, intents.HoldHeading | intents.HoldTurn):
        heading = intent.heading_rad if isinstance(intent, intents.HoldHeading) else nav.heading_rad
        if intent.speed_m_s < 0.0:
            heading += math.pi
        return [here, here.moved(heading, reach_m)] if intent.speed_m_s else [here]
    return [here]


def _leg(leg: intents.FollowLeg, here: Point, ahead_m: float) -> list[Point]:
    """Back to the line as line of sight leads there, along it, and on to the next leg.

    By y' = −v sin(atan(y / Δ)) (`guidance/line_of_sight.py`) an offset y is y exp(−x / Δ) after x.
    """
    way, line = [here], leg.line
    if line.length_m > 0.0:
        along, cross = line.along_and_cross_track_m(here)
        for share in _CLOSING:
            joins_m = along + share * ahead_m
            if 0.0 < joins_m < line.length_m:
                at = line.start.towards(line.end, joins_m / line.length_m)
                way.append(at.moved(line.course_rad + 0.5 * math.pi, cross * math.exp(-share)))
    way.append(leg.end)
    if leg.next_end is not None:
        way.append(leg.next_end)
    return way


def _arc(circle: intents.FollowCircle, here: Point, reach_m: float) -> list[Point]:
    side = 1.0 if circle.clockwise else -1.0
    first = bearing_rad(circle.centre, here) if here != circle.centre else 0.0
    count = max(1, math.ceil(min(reach_m / (_STEP_RAD * circle.radius_m), math.tau / _STEP_RAD)))
    return [
        circle.centre.moved(first + side * step * _STEP_RAD, circle.radius_m) for step in range(1, count + 1)
    ]


def requested_m_s(intent: intents.Intent, nav: NavState, config: BoatConfig) -> float:
    """The speed of an intent, 0 or more."""
    if isinstance(
        intent,
        intents.FollowLeg
        | intents.FollowCircle
        | intents.HoldCourse
        | intents.HoldHeading
        | intents.HoldTurn,
    ):
        return abs(intent.speed_m_s)
    if isinstance(intent, intents.KeepStation):
        away_m = distance_m(nav.point, intent.point)
        slow = config.guidance.min_speed_m_s
        return max(min(config.speed.cruise_m_s, braking_speed_m_s(away_m, 0.0, config.guidance)), slow)
    return config.speed.cruise_m_s


def places_on(way: list[Point], step_m: float, most: int) -> list[Point]:
    """Places on a path, one a step; its end once it is reached."""
    found: list[Point] = []
    leg, at_m = 0, 0.0
    while len(found) < most and leg + 1 < len(way):
        start, end = way[leg], way[leg + 1]
        length_m = distance_m(start, end)
        at_m += step_m
        while at_m > length_m and leg + 2 < len(way):
            at_m -= length_m
            leg += 1
            start, end = way[leg], way[leg + 1]
            length_m = distance_m(start, end)
        if at_m >= length_m and leg + 2 == len(way):
            break
        found.append(start.towards(end, at_m / length_m))
    found += [way[-1]] * (most - len(found))
    return found


def free_m(way: list[Point], field: ClearanceField, clear_m: float) -> float:
    """Distance along a path to the first place nearer than clear_m to something; infinite for none.

    What the boat is near already does not count, unless the path comes nearer.
    """
    step_m = 2.0 * field.cell_m
    clear_m = min(clear_m, field.distance_m(*way[0]) - 0.5 * field.cell_m)
    for number, at in enumerate(places_on(way, step_m, field.half)):
        if field.distance_m(*at) < clear_m:
            return number * step_m
    return math.inf


def is_same_goal(intent: intents.Intent, last: intents.Intent | None) -> bool:
    """Whether the detour still applies."""
    if isinstance(intent, intents.FollowLeg) and isinstance(last, intents.FollowLeg):
        return intent.end == last.end
    if isinstance(intent, intents.KeepStation) and isinstance(last, intents.KeepStation):
        return distance_m(intent.point, last.point) < 1.0
    return type(intent) is type(last)
