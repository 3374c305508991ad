"""The drift that the bow must be held against: how water and wind carry the boat over ground.

A boat with a keel goes where its bow points, plus the drift. So whatever velocity the boat has square to
its bow is the drift's component in that direction, and only that one is learned; the other one keeps what
earlier headings have taught. The drift is held in north and east, hence a boat that turns a corner knows
much of it already, where a crab angle would have to be learned anew. This is a normalised LMS filter with
the unit vector to starboard as its regressor (S. Haykin, *Adaptive Filter Theory*, 4th ed. 2002, chapter
6).
"""

import math

from companion.state import NavState

LEARNING_TIME_S = 3.0  # slower than the hull's own sideslip, faster than a leg
TURNING_RAD_S = 0.25  # faster turns make the hull slide outward: nothing to be learned from that
FRESH_S = 1.0  # older estimates teach nothing
MAX_CRAB_RAD = 1.0  # beyond that little speed is left to go ahead with
MAX_CRAB_SINE = math.sin(MAX_CRAB_RAD)


class Drift:
    """Velocity of the drift over ground, north and east in m/s."""

    __slots__ = ("east_m_s", "north_m_s")

    def __init__(self) -> None:
        self.north_m_s = 0.0
        self.east_m_s = 0.0

    def reset(self) -> None:
        """Forget it."""
        self.north_m_s = self.east_m_s = 0.0

    def update(self, nav: NavState, dt_s: float) -> None:
        """Learn from dt_s of motion."""
        if abs(nav.yaw_rate_rad_s) > TURNING_RAD_S or max(nav.position_age_s, nav.heading_age_s) > FRESH_S:
            return
        north, east = -math.sin(nav.heading_rad), math.cos(nav.heading_rad)
        surprise = nav.sway_m_s - (self.north_m_s * north + self.east_m_s * east)
        step = surprise * dt_s / (LEARNING_TIME_S + dt_s)
        if math.isfinite(step):
            self.north_m_s += step * north
            self.east_m_s += step * east

    def heading_for_course_rad(self, course_rad: float, water_speed_m_s: float) -> float:
        """Where the bow must point so that the boat, at a speed through the water, goes that way over ground.

        The crab angle's sine is the drift's component to starboard of the course over the water speed, held
        within MAX_CRAB_SINE. Not wrapped.
        """
        across = self.east_m_s * math.cos(course_rad) - self.north_m_s * math.sin(course_rad)
        limit = MAX_CRAB_SINE * water_speed_m_s
        if abs(across) >= limit:
            return course_rad - math.copysign(MAX_CRAB_RAD, across) if across else course_rad
        return course_rad - math.asin(across / water_speed_m_s)

    def water_speed_m_s(self, nav: NavState) -> float:
        """The boat's speed through the water."""
        return math.hypot(nav.north_m_s - self.north_m_s, nav.east_m_s - self.east_m_s)
