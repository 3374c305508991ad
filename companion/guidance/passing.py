"""Letting what moves pass: the course and speed that keep clear of it, as near as can be to those asked for.

Each candidate course and speed is tried for the distance at the closest point of approach over the next
seconds: the velocity obstacle of P. Fiorini and Z. Shiller, *Motion Planning in Dynamic Environments Using
Velocity Obstacles*, International Journal of Robotics Research 17(7), 1998. Turning to starboard is cheaper
than to port, as the collision regulations want it of vessels that meet; slowing down costs little, so that
what crosses is let pass and what goes ahead, slower, is followed until there is room beside it.
"""

import math
from typing import NamedTuple

from companion.geo import Point
from companion.guidance.scene import Scene
from companion.sensors.track import Track
from companion.units import wrap_pi

HORIZON_S = 10.0
_TURNS_RAD = (0.0, 0.35, 0.7, 1.05, 1.4, -0.35, -0.7, -1.05, -1.4)
_PACES = (1.0, 0.5, 0.0)
_PORT_COST = 0.5
_SLOW_COST = 0.6
_NEAR_COST = 6.0  # for passing at no distance at all: more than any turn
_HABIT = 0.4  # a change of mind must be worth so much
_SURE_SIGMAS = 1.0


class Passing(NamedTuple):
    """A turn off the course asked for, positive to starboard, and a share of the speed."""

    turn_rad: float
    pace: float


STRAIGHT_ON = Passing(0.0, 1.0)


def choose_passing(scene: Scene, course_rad: float, speed_m_s: float, last: Passing) -> Passing:
    """How to let pass what moves; STRAIGHT_ON where nothing that moves comes near."""
    if _nearness(scene, course_rad, speed_m_s) <= 0.0 and last == STRAIGHT_ON:
        return STRAIGHT_ON
    best, least = STRAIGHT_ON, math.inf
    for turn in _TURNS_RAD:
        course = wrap_pi(course_rad + turn)
        if turn and scene.water.room_m(course) < scene.margin_m:
            continue
        for pace in _PACES:
            if turn and not pace:
                continue
            cost = abs(turn) + (_PORT_COST if turn < 0.0 else 0.0) + _SLOW_COST * (1.0 - pace)
            cost += _NEAR_COST * _nearness(scene, course, pace * speed_m_s)
            if last == (turn, pace):
                cost -= _HABIT
            if cost < least:
                best, least = Passing(turn, pace), cost
    return best


def _nearness(scene: Scene, course_rad: float, speed_m_s: float) -> float:
    """How much too near the nearest mover comes: 0 not at all, 1 as near as can be."""
    north_m_s, east_m_s = speed_m_s * math.cos(course_rad), speed_m_s * math.sin(course_rad)
    worst = 0.0
    for mover in scene.movers:
        room_m = clearance_m(mover, scene)
        worst = max(worst, 1.0 - _closest_m(mover, scene, north_m_s, east_m_s) / room_m)
    return worst


def clearance_m(mover: Track, scene: Scene) -> float:
    """The distance to keep from the middle of a mover, its own size and doubt included."""
    return scene.margin_m + mover.radius_m + _SURE_SIGMAS * min(mover.sigma_m(scene.now_s), scene.margin_m)


def _closest_m(mover: Track, scene: Scene, north_m_s: float, east_m_s: float) -> float:
    """Distance at the closest point of approach within HORIZON_S."""
    at: Point = mover.point(scene.now_s)
    north, east = at.north_m - scene.here.north_m, at.east_m - scene.here.east_m
    rate_n, rate_e = mover.north_m_s - north_m_s, mover.east_m_s - east_m_s
    square = rate_n * rate_n + rate_e * rate_e
    when_s = 0.0 if square <= 0.0 else -(north * rate_n + east * rate_e) / square
    when_s = min(max(when_s, 0.0), HORIZON_S)
    return math.hypot(north + when_s * rate_n, east + when_s * rate_e)
