"""Circle guidance: line of sight (`line_of_sight.py`) along the tangent of the circle.

The tangent is taken at the place that the boat reaches after the response time of hull and heading loop; the
present tangent would be too straight.
"""

import math

from companion.config.boat_config import BoatConfig
from companion.core.geo import bearing_rad, distance_m
from companion.core.intent import FollowCircle
from companion.core.state import NavState
from companion.core.units import wrap_pi
from companion.guidance.line_of_sight import desired_course_rad, lookahead_m

_MAX_LEAD_RAD = 1.0


def circle_speed_m_s(circle: FollowCircle, config: BoatConfig) -> float:
    """The requested speed, or the limit of the centripetal acceleration v²/r if that is less."""
    setting = config.guidance
    allowed = math.sqrt(setting.corner_accel_m_s2 * circle.radius_m)
    return min(circle.speed_m_s, max(allowed, setting.min_speed_m_s))


def circle_course_rad(circle: FollowCircle, nav: NavState, config: BoatConfig) -> tuple[float, float, float]:
    """Course over ground that closes on the circle, distance right of it, rate of that course in rad/s."""
    here, side = nav.point, 1.0 if circle.clockwise else -1.0
    outward = bearing_rad(circle.centre, here) if here != circle.centre else nav.heading_rad
    cross_m = side * (circle.radius_m - distance_m(circle.centre, here))
    ground_m_s = math.hypot(nav.north_m_s, nav.east_m_s)
    handling, radius_m = config.handling, max(circle.radius_m, 1e-3)
    lead = side * min((handling.slip_m + handling.yaw_time_s * ground_m_s) / radius_m, _MAX_LEAD_RAD)
    tangent = outward + side * 0.5 * math.pi
    cross_m_s = nav.east_m_s * math.cos(tangent) - nav.north_m_s * math.sin(tangent)
    ahead_m = lookahead_m(ground_m_s, config.speed.cruise_m_s, config.guidance, nav.restraint)
    near = max(1.0 - abs(cross_m) / radius_m, 0.0)  # far off there is no curvature to follow
    course = desired_course_rad(tangent + near * lead, cross_m, cross_m_s, ahead_m, handling.yaw_time_s)
    return wrap_pi(course), cross_m, near * side * ground_m_s / radius_m
