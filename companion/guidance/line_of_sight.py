"""Line-of-sight guidance along a straight leg, after Fossen, *Handbook of Marine Craft Hydrodynamics and
Motion Control*, 2nd ed. 2021: the proportional law (12.78), (12.79) gives the course over ground, and the
crab angle (12.106) turns it into a heading.

Why the crab angle and not an integral of the cross-track error (12.108): satellite velocity and compass
show the crab angle directly, within a second or two, while an integral must learn it anew after every
corner and overshoots while it does. Whatever offset the compass has is part of the measured crab angle, so
it leaves no steady cross-track error either.
"""

import math

from companion.config import Guidance
from companion.geo import Point
from companion.state import NavState
from companion.units import clamp, wrap_pi

CRAB_TIME_S = 1.0  # low-pass on the crab angle: longer than the velocity's noise, shorter than a leg
MAX_CRAB_RAD = 1.1  # sideways at nearly the boat's own speed; beyond that no heading holds the line
LOOKAHEAD_SPAN = (0.5, 1.5)  # of the configured lookahead, over speed


def lookahead_m(speed_m_s: float, cruise_m_s: float, setting: Guidance) -> float:
    """Lookahead distance: the configured one at cruise speed, in proportion to speed within LOOKAHEAD_SPAN.

    The time to close half of an offset, about 0.7 · lookahead / speed, then stays as far from the heading
    loop's own time at every speed.
    """
    low, high = LOOKAHEAD_SPAN
    return setting.lookahead_m * clamp(speed_m_s / cruise_m_s, low, high)


def desired_course_rad(leg_course_rad: float, cross_track_m: float, ahead_m: float) -> float:
    """Course over ground that closes on the leg: (12.78) with Kp = 1/lookahead (12.79).

    cross_track_m is positive to starboard of the leg. Not wrapped.
    """
    return leg_course_rad - math.atan(cross_track_m / ahead_m)


class CrabAngle:
    """The angle from the bow to the course over ground, clockwise, low-passed.

    Below min_speed_m_s over ground the course means less and less; it is trusted in proportion, and not at
    all at half that speed or when the boat goes astern.
    """

    __slots__ = ("angle_rad",)

    def __init__(self) -> None:
        self.angle_rad = 0.0

    def reset(self) -> None:
        """Forget it."""
        self.angle_rad = 0.0

    def update(self, nav: NavState, min_speed_m_s: float, dt_s: float) -> float:
        """Advance by dt_s and return the angle in rad."""
        speed = math.hypot(nav.surge_m_s, nav.sway_m_s)
        trust = clamp(2.0 * speed / min_speed_m_s - 1.0, 0.0, 1.0)
        measured = 0.0
        if trust > 0.0 and nav.surge_m_s > 0.0:
            measured = trust * clamp(math.atan2(nav.sway_m_s, nav.surge_m_s), -MAX_CRAB_RAD, MAX_CRAB_RAD)
        # A turning boat slides outward and its velocity estimate lags: no crab angle to be learned from that.
        share = dt_s / (CRAB_TIME_S + dt_s)
        self.angle_rad += share * (measured - self.angle_rad)
        return self.angle_rad


def heading_for_course_rad(course_rad: float, crab_rad: float) -> float:
    """Where the bow must point to go that way over ground, in [−π, π)."""
    return wrap_pi(course_rad - crab_rad)


def leg_course_rad(start: Point, end: Point, at: Point) -> float:
    """Direction of the leg; of what is left of it where it has no length."""
    north, east = end.north_m - start.north_m, end.east_m - start.east_m
    if north * north + east * east < 1e-12:
        north, east = end.north_m - at.north_m, end.east_m - at.east_m
    return math.atan2(east, north)
