"""How fast the boat may go now, so that it can take the corner ahead and stop where it should."""

import math

from companion.config import Guidance


def corner_speed_m_s(turn_rad: float, setting: Guidance) -> float:
    """Speed at which a corner can be rounded; infinite for no corner at all.

    The arc that leaves one leg and joins the next waypoint_radius_m from the corner has the radius
    r = waypoint_radius_m / tan(|turn|/2); going round it at v takes the centripetal acceleration v²/r, which
    may be corner_accel_m_s2. Never below min_speed_m_s. turn_rad is wrapped, −π..π.
    """
    half_tangent = math.tan(0.5 * min(abs(turn_rad), math.pi))
    if half_tangent <= 0.0:
        return math.inf if abs(turn_rad) < 1.0 else setting.min_speed_m_s
    radius_m = setting.waypoint_radius_m / half_tangent
    return max(math.sqrt(setting.corner_accel_m_s2 * radius_m), setting.min_speed_m_s)


def braking_speed_m_s(distance_m: float, end_speed_m_s: float, setting: Guidance) -> float:
    """Highest speed that accel_m_s2 brings down to end_speed_m_s in distance_m: v² = v_end² + 2 a d."""
    return math.sqrt(end_speed_m_s * end_speed_m_s + 2.0 * setting.accel_m_s2 * max(distance_m, 0.0))


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
