"""Follows the mission legs: a smooth path, and line of sight along it.

The path is computed when a leg begins, as far ahead as the boat may have to brake, and again when the current
changes. A fillet under way is completed.
"""

import math
from typing import NamedTuple

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point, distance_m
from companion.core.intent import FollowLeg
from companion.core.state import NavState
from companion.guidance.fillet import Fillet
from companion.guidance.line_of_sight import desired_course_rad, lookahead_m
from companion.guidance.smoothing import Corner, SmoothPath, smooth

GLIMPSE_S = 0.1  # preview time of course and speed
MOTOR_S = 0.15  # lag from command to thrust, as in estimation/yaw_model.py
NEW_CURRENT_SHARE = 0.25  # of min_speed_m_s: change of the current that triggers a new path
LOST_RADII = 1.5  # of a waypoint: farther off, the fillet onto a leg is abandoned
REACH_BRAKINGS = 4.0  # length of the path beyond the leg, in braking distances
_SAME_M = 1e-3


class Guide(NamedTuple):
    """Direction of the path, course and speed over ground, and those GLIMPSE_S later; the course's change is
    that of MOTOR_S later.

    stops: the path stops where the leg ends, to end there or to turn on the spot.
    """

    tangent_rad: float
    course_rad: float
    speed_m_s: float
    later_course_rad: float
    later_speed_m_s: float
    stops: bool


class _Plan(NamedTuple):
    """A path with its places and the current that it was computed for.

    at: index of the leg's start; 1 if the path includes the fillet onto it.
    """

    smooth: SmoothPath
    places: tuple[Point, ...]
    at: int
    current_north_m_s: float
    current_east_m_s: float


class PathFollowing:
    """Keeps the path of the present leg."""

    def __init__(self) -> None:
        self._leg: FollowLeg | None = None
        self._plan: _Plan | None = None
        self._correction_rad: float | None = None
        self._corrected_s = 0.0

    def forget(self) -> None:
        self._leg = self._plan = self._correction_rad = None

    def update(self, leg: FollowLeg, nav: NavState, config: BoatConfig) -> Guide:
        """Course and speed for the present position."""
        plan, here = self._plan, nav.point
        if plan is None or self._leg is None:
            plan = _planned(leg, None, {}, nav, config)
        elif leg is not self._leg:
            if leg.start not in (self._leg.start, self._leg.end):
                self._correction_rad = None
            plan = _next_plan(plan, self._leg, leg, nav, config)
        along, cross = _located(plan, here)
        if _is_outdated(plan, along, cross, leg, nav, config):
            plan = _planned(leg, None, {}, nav, config)
            along, cross = _located(plan, here)
        self._leg, self._plan = leg, plan
        stops = plan.smooth.path.speed_m_s(plan.smooth.exits_m[plan.at + 1]) <= 0.0
        correction = self._correct(plan.smooth.path.course_rad(along), cross, nav, config)
        return _guide(plan.smooth, along, correction, leg, nav, config, stops=stops)

    def _correct(self, tangent_rad: float, cross_m: float, nav: NavState, config: BoatConfig) -> float:
        """Change of course towards the path, without the noise of the fixes.

        It is smoothed with the time constant of the heading loop, which could not follow faster. Cross-track
        errors are predicted for as much longer.
        """
        cross_m_s = nav.east_m_s * math.cos(tangent_rad) - nav.north_m_s * math.sin(tangent_rad)
        ground = math.hypot(nav.north_m_s, nav.east_m_s)
        ahead = lookahead_m(ground, config.speed.cruise_m_s, config.guidance, nav.restraint)
        smooth_s = config.handling.yaw_time_s
        response_s = config.handling.yaw_time_s + smooth_s
        wanted = desired_course_rad(0.0, cross_m, cross_m_s, ahead, response_s)
        share = 1.0 - math.exp(-max(nav.time_s - self._corrected_s, 0.0) / smooth_s)
        before = wanted if self._correction_rad is None else self._correction_rad
        self._corrected_s = nav.time_s
        self._correction_rad = before + share * (wanted - before)
        return self._correction_rad


def _guide(
    smoothed: SmoothPath,
    along_m: float,
    correction_rad: float,
    leg: FollowLeg,
    nav: NavState,
    config: BoatConfig,
    *,
    stops: bool,
) -> Guide:
    """Line of sight about the course where the boat will be after the response time of hull and heading loop.

    The yaw rate is fed forward, and by MOTOR_S earlier, because the motors lag; the course leads by as much
    less. The speed is the path's limit at the place reached after the response time of the speed.
    """
    path, handling, setting = smoothed.path, config.handling, config.guidance
    ground = math.hypot(nav.north_m_s, nav.east_m_s)
    tangent = path.course_rad(along_m)
    turned = along_m + handling.slip_m + max(handling.yaw_time_s - MOTOR_S, 0.0) * ground
    fed = turned + MOTOR_S * ground
    slowed = along_m + handling.surge_time_s * ground
    step = GLIMPSE_S * ground
    least = min(leg.speed_m_s, setting.min_speed_m_s)
    now, later = (
        max(min(path.speed_m_s(along_m + off), path.speed_m_s(slowed + off)), least) for off in (0.0, step)
    )
    course = path.course_rad(turned) + correction_rad
    later_course = course + path.course_rad(fed + step) - path.course_rad(fed)
    return Guide(tangent, course, now, later_course, later, stops)


def _located(plan: _Plan, here: Point) -> tuple[float, float]:
    """Position along the leg and the fillets at its ends."""
    smoothed, at = plan.smooth, plan.at
    low = -math.inf if at == 0 else smoothed.entries_m[at]
    return smoothed.path.locate(here, low, smoothed.exits_m[at + 1])


def _is_outdated(
    plan: _Plan, along_m: float, cross_m: float, leg: FollowLeg, nav: NavState, config: BoatConfig
) -> bool:
    """Whether the rest of the leg needs another path."""
    radius_m = leg.radius_m or config.guidance.waypoint_radius_m
    if plan.at == 1 and along_m <= plan.smooth.exits_m[1]:
        return abs(cross_m) > LOST_RADII * radius_m
    if along_m >= plan.smooth.entries_m[plan.at + 1] - radius_m:
        return False
    north_m_s, east_m_s = plan.current_north_m_s, plan.current_east_m_s
    changed = abs(nav.current_north_m_s - north_m_s) + abs(nav.current_east_m_s - east_m_s)
    return changed > NEW_CURRENT_SHARE * config.guidance.min_speed_m_s


def _next_plan(plan: _Plan, last: FollowLeg, leg: FollowLeg, nav: NavState, config: BoatConfig) -> _Plan:
    """The plan for a new leg; a fillet under way is kept."""
    places, at = plan.places, plan.at
    along_m, _ = _located(plan, nav.point)
    if (leg.start, leg.end) == (last.start, last.end):
        begun = at + 1 if along_m >= plan.smooth.entries_m[at + 1] else at
        before = places[0] if at == 1 else None
    elif leg.start == last.end and places[at + 2 : at + 3] == (leg.end,):
        begun, before = at + 1, places[at]
    else:
        return _planned(leg, None, {}, nav, config)
    corners = {places[n - 1 : n + 2] for n in range(1, begun + 1)}
    kept = {corner: fillet for corner, fillet in plan.smooth.fillets.items() if corner in corners}
    return _planned(leg, before, kept, nav, config)


def _planned(
    leg: FollowLeg, before: Point | None, kept: dict[Corner, Fillet], nav: NavState, config: BoatConfig
) -> _Plan:
    """The path for a leg. before: start of the previous leg if the fillet onto this one is under way."""
    places = [leg.start if leg.line.length_m > _SAME_M else nav.point]
    reach_m = REACH_BRAKINGS * leg.speed_m_s * leg.speed_m_s / (2.0 * config.guidance.accel_m_s2)
    onward = () if leg.next_end is None else (leg.next_end, *leg.onward)
    for place in (leg.end, *onward):
        step_m = distance_m(places[-1], place)
        if step_m > _SAME_M:
            if len(places) > 1:
                reach_m -= step_m
            places.append(place)
        if reach_m <= 0.0:
            break
    if len(places) == 1:  # the boat is at the end: any direction
        c, s = math.cos(nav.heading_rad), math.sin(nav.heading_rad)
        places.append(Point(places[0].north_m + c, places[0].east_m + s))
    radius_m = leg.radius_m or config.guidance.waypoint_radius_m
    current_m_s = (nav.current_north_m_s, nav.current_east_m_s)
    if before is not None:
        with_it = (before, *places)
        smoothed = smooth(with_it, radius_m, leg.speed_m_s, current_m_s, config, kept)
        if len(smoothed.marks_m) > 2:
            return _Plan(smoothed, with_it, 1, *current_m_s)
    smoothed = smooth(places, radius_m, leg.speed_m_s, current_m_s, config, kept)
    return _Plan(smoothed, tuple(places), 0, *current_m_s)
