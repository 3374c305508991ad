"""The estimator: from whatever fix and heading are at hand to the boat's motion now.

The local frame is laid at the first good fix, or where a station has chosen if that is near, and never moved.
Readings are recognised by their time stamp, so the same one may be handed in at every tick; one stamped
later than now waits until its time has come. What is not finite, far out of the frame, or goes back in time,
is left out and ages the estimate instead.
"""

import math

from companion.estimation.heading import HeadingFilter
from companion.estimation.position import PositionFilter
from companion.geo import LocalFrame, Point
from companion.sensors.readings import GnssFix, HeadingReading
from companion.state import NavState

MIN_FIX_TYPE = 3  # a 3-D fix
SIGMA_PER_HDOP_M = 0.8  # for receivers that do not say how accurate they are
MIN_SIGMA_M = 0.001
MAX_SIGMA_M = 1000.0  # what lies beyond these four is a fault of the part; comparisons let no NaN pass
MAX_SPEED_M_S = 100.0
MAX_HEADING_RAD = 100.0
MAX_RATE_RAD_S = 50.0
MAX_OFFSET_M = 100_000.0  # from the frame's origin: its projection holds no farther


class Estimator:
    """Keeps one filter for position and one for heading. `frame` is None before the first good fix."""

    __slots__ = ("_heading", "_position", "frame", "frame_to_lay")

    def __init__(self, accel_m_s2: float = 0.5) -> None:
        """accel_m_s2: one standard deviation of the boat's manoeuvres; smaller smooths more."""
        self.frame: LocalFrame | None = None
        self.frame_to_lay: LocalFrame | None = None  # chosen beforehand; None: at the first good fix
        self._position = PositionFilter(accel_m_s2)
        self._heading = HeadingFilter()

    def update(self, fix: GnssFix | None, heading: HeadingReading | None, now_s: float) -> NavState | None:
        """Advance to now_s. None before anything was accepted.

        With only one of position and heading known, the other one is 0 with an infinite age.
        """
        position, compass = self._position, self._heading
        if fix is not None and position.time_s < fix.time_s <= now_s and fix.fix_type >= MIN_FIX_TYPE:
            self._take_fix(fix)
        if heading is not None and compass.time_s < heading.time_s <= now_s:
            _take_heading(compass, heading)
        position_age = now_s - position.time_s
        heading_age = now_s - compass.time_s
        if position_age == math.inf and heading_age == math.inf:
            return None
        yaw = compass.heading_at_rad(now_s)
        north_m_s, east_m_s = position.north_m_s, position.east_m_s
        ahead = position.predicted_ahead_s(now_s) if self.frame is not None else 0.0
        c, s = math.cos(yaw), math.sin(yaw)
        return NavState(
            now_s,
            position.north_m + north_m_s * ahead,
            position.east_m + east_m_s * ahead,
            yaw,
            compass.yaw_rate_rad_s,
            north_m_s,
            east_m_s,
            north_m_s * c + east_m_s * s,
            east_m_s * c - north_m_s * s,
            position_age,
            heading_age,
        )

    def _take_fix(self, fix: GnssFix) -> None:
        sigma_m = fix.horizontal_accuracy_m
        if sigma_m is None:
            sigma_m = SIGMA_PER_HDOP_M * fix.hdop
        if not sigma_m <= MAX_SIGMA_M:
            return
        velocity = None
        if fix.north_m_s is not None and fix.east_m_s is not None:
            velocity = (fix.north_m_s, fix.east_m_s)
            if not abs(fix.north_m_s) + abs(fix.east_m_s) <= MAX_SPEED_M_S:
                return
        if self.frame is None:
            chosen = self.frame_to_lay
            if chosen is None or not _is_near(chosen.to_local(fix.position)):
                chosen = LocalFrame(fix.position)
            self.frame = chosen
        at = self.frame.to_local(fix.position)
        if _is_near(at):
            self._position.update(fix.time_s, at, max(sigma_m, MIN_SIGMA_M), velocity)


def _is_near(at: Point) -> bool:
    return math.hypot(at.north_m, at.east_m) <= MAX_OFFSET_M


def _take_heading(compass: HeadingFilter, reading: HeadingReading) -> None:
    rate = reading.yaw_rate_rad_s
    if abs(reading.heading_rad) <= MAX_HEADING_RAD and (rate is None or abs(rate) <= MAX_RATE_RAD_S):
        compass.update(reading.time_s, reading.heading_rad, rate)
