"""The course to steer: the velocity triangle of boat, water and ground.

Velocity over ground = velocity through the water + set (current and leeway together). So to make good a
course at a speed, the bow points along their difference with the set; this is the crab angle of T. I.
Fossen, *Handbook of Marine Craft Hydrodynamics and Motion Control*, 2nd ed. 2021, (12.106), from a set that
is estimated.

Why the set and not an integral of the cross-track error (12.108): the set shows in satellite velocity and
compass within seconds and stays true through a corner, while an integral must learn it anew on every leg and
overshoots while it does. The compass's own offset looks like a set that turns with the boat, so it leaves no
steady cross-track error either.
"""

import math

from companion.core.units import clamp

MAX_CRAB_SINE = math.sin(1.0)  # beyond that crab angle little speed is left to go ahead with


def course_to_steer(
    course_rad: float,
    speed_m_s: float,
    current_north_m_s: float,
    current_east_m_s: float,
    slow_m_s: float,
    top_m_s: float,
) -> tuple[float, float]:
    """Heading, not wrapped, and speed through the water that make good a course at a speed over ground.

    The course goes before the speed: through the water the boat makes at most top_m_s, and ahead along the
    course at least slow_m_s, so that the bow does not turn about where the set alone is faster than asked.
    """
    c, s = math.cos(course_rad), math.sin(course_rad)
    limit = MAX_CRAB_SINE * top_m_s
    across = clamp(current_north_m_s * s - current_east_m_s * c, -limit, limit)
    room = math.sqrt(top_m_s * top_m_s - across * across)
    ahead = clamp(speed_m_s - current_north_m_s * c - current_east_m_s * s, min(slow_m_s, room), room)
    return course_rad + math.atan2(across, ahead), math.hypot(across, ahead)


def steerable_speed_m_s(
    course_rad: float,
    speed_m_s: float,
    water_m_s: float,
    change_m_s: float,
    current_north_m_s: float,
    current_east_m_s: float,
) -> float:
    """The speed over ground to point the bow for: the one asked for, as near as the boat will soon be to it.

    water_m_s: the speed through the water that it has. While that is too little for the speed asked for, the
    crab angle for that speed would let the current carry the boat aside; while it is too much, the boat would
    sail up the current. change_m_s: how much it may change before the bow has followed.
    """
    c, s = math.cos(course_rad), math.sin(course_rad)
    across = current_north_m_s * s - current_east_m_s * c
    ahead = math.sqrt(max(water_m_s * water_m_s - across * across, 0.0))
    makes = ahead + current_north_m_s * c + current_east_m_s * s
    return clamp(speed_m_s, makes - change_m_s, makes + change_m_s)
