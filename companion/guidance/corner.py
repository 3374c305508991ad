"""A corner between two legs, rounded on an arc that touches both.

The arc of radius r leaves the first leg r tan(|turn|/2) before the corner, passes the corner at r
(1/cos(|turn|/2) − 1), and joins the second leg as far behind it. Distances along the path count from where
the arc begins: negative on the first leg, beyond `length_m` on the second one. A fast set is stemmed
(`stemming.py`) where the arc can be tighter so.
"""

import math

from companion.config import BoatConfig
from companion.geo import Line, Point
from companion.guidance.course_to_steer import course_to_steer
from companion.guidance.speed_profile import (
    TURN_SHARE,
    corner_speed_m_s,
    full_speed_radius_m,
    leg_speed_m_s,
)
from companion.guidance.stemming import COASTING_SHARE, Stemming, stemming, stemming_radius_m
from companion.units import clamp, wrap_pi

CIRCLE_SHARE = 0.42  # of the waypoint's radius: how near the corner the arc must pass
LEG_SHARE = 0.5  # of either leg that the arc may take
SHARPEST_RAD = 2.4  # a sharper one is turned on the spot
_RIGHT_ANGLE_CUT = math.sqrt(2.0) - 1.0  # of the radius: how far from a right angle's corner its arc passes
LEAST_TURN_RAD = 1e-3  # less is no corner


class Corner:
    """turn_rad is positive to starboard, in [−π, π). stemming: how, None where the bow points ahead."""

    __slots__ = (
        "_centre", "_entry_rad", "entry_m", "length_m", "line", "next_line", "radius_m", "stemming",
        "turn_rad",
    )  # fmt: skip

    def __init__(self, line: Line, next_line: Line, radius_m: float, stemmed: Stemming | None = None) -> None:
        self.stemming = stemmed
        self.line = line
        self.next_line = next_line
        self.radius_m = radius_m
        self.turn_rad = turn = wrap_pi(next_line.course_rad - line.course_rad)
        self.entry_m = radius_m * math.tan(0.5 * abs(turn))
        self.length_m = radius_m * abs(turn)
        c, s = math.cos(line.course_rad), math.sin(line.course_rad)
        side_m = math.copysign(radius_m, turn)
        corner = line.end
        self._centre = Point(
            corner.north_m - self.entry_m * c - side_m * s, corner.east_m - self.entry_m * s + side_m * c
        )
        self._entry_rad = line.course_rad - math.copysign(0.5 * math.pi, turn)  # from the centre to the entry

    def along_and_cross_track_m(self, at: Point) -> tuple[float, float]:
        """How far along the path its nearest place is, and how far to the right of it `at` lies."""
        along, cross = self.line.along_and_cross_track_m(at)
        along -= self.line.length_m - self.entry_m
        if along <= 0.0:
            return along, cross
        beyond, beyond_cross = self.next_line.along_and_cross_track_m(at)
        if beyond >= self.entry_m:
            return self.length_m + beyond - self.entry_m, beyond_cross
        north, east = at.north_m - self._centre.north_m, at.east_m - self._centre.east_m
        turned = wrap_pi(math.atan2(east, north) - self._entry_rad)
        turned = clamp(math.copysign(1.0, self.turn_rad) * turned, 0.0, abs(self.turn_rad))
        inside = self.radius_m - math.hypot(north, east)
        return self.radius_m * turned, math.copysign(1.0, self.turn_rad) * inside

    def course_rad(self, along_m: float) -> float:
        """The path's direction at a place along it. Not wrapped."""
        share = clamp(along_m / self.length_m, 0.0, 1.0)
        return self.line.course_rad + share * self.turn_rad

    @property
    def exit_m(self) -> float:
        """How far behind the arc the corner is sailed out."""
        return 0.0 if self.stemming is None else self.stemming.exit_m

    def speed_m_s(self, along_m: float, wanted_m_s: float, config: BoatConfig) -> float:
        """Speed over ground allowed at a place along the path."""
        stemmed, before_m, beyond_m = self.stemming, -along_m, along_m - self.length_m
        if stemmed is None:
            slow = corner_speed_m_s(self.radius_m, config)
        else:
            slow = stemmed.speed_m_s
            before_m -= stemmed.turn_m + stemmed.settle_m
            if before_m > 0.0:
                slow = max(slow, stemmed.carried_m_s)
        if beyond_m > 0.0:
            grown = math.sqrt(slow * slow + 2.0 * config.guidance.accel_m_s2 * beyond_m)
            return min(wanted_m_s, grown)
        return leg_speed_m_s(wanted_m_s, before_m, slow, config)

    def least_ahead_m_s(self, along_m: float, config: BoatConfig) -> float:
        """Least speed through the water along the course at a place along the path; negative where the
        boat may be let down stern first.
        """
        stemmed, slow = self.stemming, config.guidance.min_speed_m_s
        if stemmed is None:
            return slow
        return COASTING_SHARE * slow if 0.0 < stemmed.turn_m <= -along_m else -config.handling.top_speed_m_s


def easy_radius_m(turn_rad: float, config: BoatConfig) -> float:
    """Radius to round a turn on: the configured one of a right angle and more. A lesser turn is rounded
    wider, up to what takes no way off, passing no further from its corner than a right angle's arc does.
    """
    radius_m = config.guidance.corner_radius_m
    if turn_rad >= 0.5 * math.pi:
        return radius_m
    alike_m = radius_m * _RIGHT_ANGLE_CUT / (1.0 / math.cos(0.5 * turn_rad) - 1.0)
    return max(radius_m, min(alike_m, full_speed_radius_m(config)))


def corner_between(
    line: Line,
    next_line: Line,
    radius_m: float,
    config: BoatConfig,
    set_north_m_s: float = 0.0,
    set_east_m_s: float = 0.0,
) -> Corner | None:
    """The corner as it is to be sailed; None where the legs go straight on, nearly back, or one has no
    length.

    radius_m: how near the waypoint must be passed. The arc's own radius is the easy one, or wider
    where the set makes the bow swing further than the course, stemmed if that takes less; within what passes
    CIRCLE_SHARE of the waypoint's radius from the corner and takes no more than LEG_SHARE of the shorter leg.
    """
    turn = wrap_pi(next_line.course_rad - line.course_rad)
    size = abs(turn)
    shorter_m = min(line.length_m, next_line.length_m)
    if not LEAST_TURN_RAD < size < SHARPEST_RAD or shorter_m < 1e-6:
        return None
    half = 0.5 * size
    widest_m = min(
        CIRCLE_SHARE * radius_m / (1.0 / math.cos(half) - 1.0), LEG_SHARE * shorter_m / math.tan(half)
    )
    wanted_m = easy_radius_m(size, config)
    speed = corner_speed_m_s(wanted_m, config)
    slow, top = config.guidance.min_speed_m_s, config.handling.top_speed_m_s
    ahead_m, fastest, bows = wanted_m, speed, []
    for course in (line.course_rad, next_line.course_rad):
        fastest = max(fastest, set_north_m_s * math.cos(course) + set_east_m_s * math.sin(course) + slow)
        bows.append(course_to_steer(course, speed, set_north_m_s, set_east_m_s, slow, top)[0])
    swing = abs(wrap_pi(bows[1] - bows[0]))
    if set_north_m_s or set_east_m_s:
        ahead_m = max(wanted_m, swing * fastest / (size * TURN_SHARE * config.handling.turn_rate_rad_s))
    if fastest > speed:
        sails = (line.course_rad, turn, speed, set_north_m_s, set_east_m_s, config)
        stemmed_m = max(stemming_radius_m(*sails), wanted_m)
        if stemmed_m < ahead_m:
            return Corner(line, next_line, min(stemmed_m, widest_m), stemming(*sails))
    return Corner(line, next_line, min(ahead_m, widest_m))
