"""How fast the boat may go now, so that it can take the corner ahead and stop where it should."""

import math

from companion.config import Guidance

REACTION_S = 1.0  # until throttle taken back shows in the speed
TURN_TIME_S_PER_RAD = 0.75  # half of what the hull needs to turn by one radian
CIRCLE_SHARE = 0.8  # of waypoint_radius_m: how near the corner a turn begun early must still pass


def corner_speed_m_s(turn_rad: float, setting: Guidance) -> float:
    """Speed at which a corner can be rounded; infinite for no corner at all.

    The arc that leaves one leg and joins the next waypoint_radius_m from the corner has the radius
    r = waypoint_radius_m / tan(|turn|/2); going round it at v takes the centripetal acceleration v²/r, which
    may be corner_accel_m_s2. Never below min_speed_m_s. turn_rad is wrapped, −π..π.
    """
    half_tangent = math.tan(0.5 * min(abs(turn_rad), 3.0))
    if half_tangent <= 0.0:
        return math.inf
    radius_m = setting.waypoint_radius_m / half_tangent
    return max(math.sqrt(setting.corner_accel_m_s2 * radius_m), setting.min_speed_m_s)


def braking_speed_m_s(distance_m: float, end_speed_m_s: float, setting: Guidance) -> float:
    """Highest speed from which the boat can be down to end_speed_m_s in distance_m.

    It goes on at v for REACTION_S, then slows by a = accel_m_s2: v² = v_end² + 2 a (d − v t), solved for v.
    """
    delayed = setting.accel_m_s2 * REACTION_S
    room = 2.0 * setting.accel_m_s2 * max(distance_m, 0.0)
    speed = math.sqrt(delayed * delayed + end_speed_m_s * end_speed_m_s + room) - delayed
    return max(speed, end_speed_m_s)


def leg_speed_m_s(
    leg_speed_m_s: float, distance_m: float, turn_rad: float | None, setting: Guidance
) -> float:
    """Speed allowed on a leg whose end is distance_m ahead.

    turn_rad: the corner that follows, None for a stop at the end. The corner begins waypoint_radius_m before
    the end, so that is where its speed must be reached. Never below min_speed_m_s, unless the leg's own speed
    is lower: a boat without steerage way steers badly, and whoever gave the leg ends it.
    """
    if turn_rad is None:
        allowed = braking_speed_m_s(distance_m, 0.0, setting)
    else:
        corner = corner_speed_m_s(turn_rad, setting)
        if corner >= leg_speed_m_s:
            return leg_speed_m_s
        allowed = braking_speed_m_s(distance_m - setting.waypoint_radius_m, corner, setting)
    return min(leg_speed_m_s, max(allowed, setting.min_speed_m_s))


def steered_speed_m_s(speed_m_s: float, heading_error_rad: float, setting: Guidance) -> float:
    """Speed left while the bow points elsewhere.

    All of it up to half of pivot_angle_rad, falling in a straight line to min_speed_m_s at pivot_angle_rad,
    and none beyond: there the boat turns on the spot.
    """
    pivot = setting.pivot_angle_rad
    error = abs(heading_error_rad)
    if error > pivot:
        return 0.0
    return min(speed_m_s, max(speed_m_s * 2.0 * (1.0 - error / pivot), setting.min_speed_m_s))


def turn_lead_m(turn_rad: float, speed_m_s: float, setting: Guidance) -> float:
    """How far before the end of a leg to begin turning onto the next.

    The arc at the corner speed leaves the leg r tan(|turn|/2) before the corner, and the hull needs
    TURN_TIME_S_PER_RAD at the present speed to come round. Never so early that the arc, which passes the
    corner at lead · tan(|turn|/4), would miss the waypoint's circle.
    """
    turn = min(abs(turn_rad), math.pi)
    if turn < 1e-6:
        return 0.0
    radius_m = corner_speed_m_s(turn, setting) ** 2 / setting.corner_accel_m_s2
    lead_m = radius_m * math.tan(0.5 * min(turn, 3.0)) + TURN_TIME_S_PER_RAD * turn * speed_m_s
    return min(lead_m, CIRCLE_SHARE * setting.waypoint_radius_m / math.tan(0.25 * turn))
