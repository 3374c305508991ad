"""Stemming: sailing a corner slowly in water that sets fast, with the bow up into it.

A bow that points ahead leaves a boat no slower over ground than the set along its leg; it is swept round the
corner, and on the way the bow must swing far further than the course. With the bow up, as at anchor, the boat
is let down on the corner as slowly as it likes and sidles round it, and the bow swings less than the course:
the velocity through the water w = v − set, whose direction is the heading, is then mostly −set. For a ground
speed v on an arc of radius r, at an angle δ between the course and a set of size s, differentiating the
direction of w gives the bow's turn rate

    ψ' = v/r · v (v − s cos δ) / (v² + s² − 2 v s cos δ)

Where the first leg leads down the set, the way is taken off first with the bow ahead, and the bow turned up
while the water carries the boat on along the leg: a bow that turns about without way leaves the line by
little. Where the second leg does, speed grows on it no faster than it was taken off, for the same reason.
"""

import math
from typing import NamedTuple

from companion.config import BoatConfig
from companion.guidance.course_to_steer import course_to_steer
from companion.guidance.speed_profile import TURN_SHARE
from companion.units import wrap_pi

SETTLING_S = 0.6  # for the way through the water to be off
COASTING_SHARE = 0.25  # of min_speed_m_s through the water, so that the bow stays ahead meanwhile
LEAST_SHARE = 0.75  # of min_speed_m_s through the water on the arc: with less there is no heading to hold
SAMPLES = 8  # along the arc


class Stemming(NamedTuple):
    """How a corner is stemmed: how fast over ground, and where the bow is up.

    carried_m_s: by the set, along the first leg; nought where it does not do so. turn_m: before the arc the
    bow turns up, nought where it need not turn about; settle_m: before that the way is off. exit_m: behind
    the arc, up to where the bow is up.
    """

    speed_m_s: float
    carried_m_s: float
    turn_m: float
    settle_m: float
    exit_m: float


def stemming(
    course_rad: float,
    turn_rad: float,
    speed_m_s: float,
    set_north_m_s: float,
    set_east_m_s: float,
    config: BoatConfig,
) -> Stemming:
    """For a corner from a leg's course by a turn, at a speed over ground."""
    set_m_s = math.hypot(set_north_m_s, set_east_m_s)
    off = course_rad - math.atan2(set_east_m_s, set_north_m_s)
    carried, onward = set_m_s * math.cos(off), set_m_s * math.cos(off + turn_rad)
    handling, turn_m, exit_m = config.handling, 0.0, 0.0
    coasting = COASTING_SHARE * config.guidance.min_speed_m_s
    if carried > speed_m_s:
        top = handling.top_speed_m_s
        ahead, up = (
            course_to_steer(course_rad, speed, set_north_m_s, set_east_m_s, -top, top)[0]
            for speed in (carried + coasting, speed_m_s)
        )
        turn_m = carried * (abs(wrap_pi(up - ahead)) / handling.turn_rate_rad_s + handling.yaw_time_s)
    if onward > speed_m_s:
        fast = onward + coasting
        exit_m = (fast * fast - speed_m_s * speed_m_s) / (2.0 * config.guidance.accel_m_s2)
    return Stemming(speed_m_s, max(carried, 0.0), turn_m, SETTLING_S * set_m_s, exit_m)


def stemming_radius_m(
    course_rad: float,
    turn_rad: float,
    speed_m_s: float,
    set_north_m_s: float,
    set_east_m_s: float,
    config: BoatConfig,
) -> float:
    """Radius of the tightest arc that can be stemmed; infinite where set and speed are too much alike."""
    set_m_s = math.hypot(set_north_m_s, set_east_m_s)
    off = course_rad - math.atan2(set_east_m_s, set_north_m_s)
    least = LEAST_SHARE * config.guidance.min_speed_m_s
    widest = 0.0
    for n in range(SAMPLES + 1):
        carried = set_m_s * math.cos(off + n / SAMPLES * turn_rad)
        water_2 = speed_m_s * speed_m_s + set_m_s * set_m_s - 2.0 * speed_m_s * carried
        if water_2 < least * least:
            return math.inf
        widest = max(widest, speed_m_s * speed_m_s * abs(speed_m_s - carried) / water_2)
    return widest / (TURN_SHARE * config.handling.turn_rate_rad_s)
