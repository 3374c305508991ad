"""The course to steer: the velocity triangle of boat, water and ground.

Velocity over ground = velocity through the water + current (leeway included). The heading for a course and
speed follows from their difference with the current; this is the crab angle of T. I. Fossen, *Handbook of
Marine Craft Hydrodynamics and Motion Control*, 2nd ed. 2021, (12.106), from an estimated current.

Why the current and not an integral of the cross-track error (12.108): GNSS velocity and compass show the
current within seconds, and the estimate holds through a corner; an integral must be learned again on each leg
and overshoots meanwhile. The compass offset looks like a current that turns with the boat, so it causes no
steady cross-track error either.
"""

import math

from companion.config.boat_config import BoatConfig
from companion.core.state import Demand, NavState
from companion.core.units import clamp, wrap_pi
from companion.guidance.speed_profile import steered_speed_m_s

MAX_CRAB_SINE = math.sin(1.0)  # beyond this crab angle little speed is left along the course


def course_to_steer(
    course_rad: float, speed_m_s: float, nav: NavState, config: BoatConfig
) -> tuple[float, float]:
    """Heading, not wrapped, and speed through the water for a course and speed over ground.

    The course has priority: the speed through the water is at most the top speed, and along the course at
    least min_speed_m_s, so the bow does not turn around where the current alone is faster than requested.
    """
    c, s, top = math.cos(course_rad), math.sin(course_rad), config.handling.top_speed_m_s
    limit = MAX_CRAB_SINE * top
    across = clamp(nav.current_north_m_s * s - nav.current_east_m_s * c, -limit, limit)
    room = math.sqrt(top * top - across * across)
    ahead = speed_m_s - nav.current_north_m_s * c - nav.current_east_m_s * s
    ahead = clamp(ahead, min(config.guidance.min_speed_m_s, room), room)
    return course_rad + math.atan2(across, ahead), math.hypot(across, ahead)


def make_good(
    course_rad: float,
    speed_m_s: float,
    nav: NavState,
    config: BoatConfig,
    cross_track_m: float = 0.0,
    distance_m: float = 0.0,
) -> Demand:
    """The heading and speed along the bow that make good a course and speed over ground."""
    heading, water = course_to_steer(course_rad, speed_m_s, nav, config)
    heading = wrap_pi(heading)
    water = steered_speed_m_s(water, wrap_pi(heading - nav.heading_rad), config)
    return Demand(heading, water + nav.current_along_m_s(nav.heading_rad), cross_track_m, distance_m)


def steerable_speed_m_s(course_rad: float, speed_m_s: float, change_m_s: float, nav: NavState) -> float:
    """The speed over ground for which to compute the heading: the requested one, within reach of the present
    one.

    With the crab angle of a higher speed the current would carry the boat off the path; with that of a lower
    one it would steer up-current. change_m_s: how much the speed may change before the bow has followed.
    """
    c, s = math.cos(course_rad), math.sin(course_rad)
    across = nav.current_north_m_s * s - nav.current_east_m_s * c
    water_m_s = nav.water_speed_m_s
    ahead = math.sqrt(max(water_m_s * water_m_s - across * across, 0.0))
    makes = ahead + nav.current_north_m_s * c + nav.current_east_m_s * s
    return clamp(speed_m_s, makes - change_m_s, makes + change_m_s)
