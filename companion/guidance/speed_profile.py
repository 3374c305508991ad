"""How fast the boat may go now, so that it can take the corner ahead and stop where it should."""

import math

from companion.config import BoatConfig, Guidance

REACTION_S = 1.0  # until throttle taken back shows in the speed
TURN_SHARE = 0.7  # of the turn rate that full steering gives: the rest is left to correct with


def corner_speed_m_s(radius_m: float, config: BoatConfig) -> float:
    """Speed at which an arc can be sailed.

    Its centripetal acceleration v²/r may be corner_accel_m_s2, its turn rate v/r TURN_SHARE of what the
    hull can do. Never below min_speed_m_s.
    """
    setting = config.guidance
    fastest = min(
        math.sqrt(setting.corner_accel_m_s2 * radius_m),
        TURN_SHARE * config.handling.turn_rate_rad_s * radius_m,
    )
    return max(fastest, setting.min_speed_m_s)


def full_speed_radius_m(config: BoatConfig) -> float:
    """Radius of the tightest arc for cruise speed: `corner_speed_m_s` the other way round."""
    speed = config.speed.cruise_m_s
    return max(
        speed * speed / config.guidance.corner_accel_m_s2,
        speed / (TURN_SHARE * config.handling.turn_rate_rad_s),
    )


def braking_speed_m_s(
    distance_m: float, end_speed_m_s: float, setting: Guidance, reaction_s: float = REACTION_S
) -> float:
    """Highest speed from which the boat can be down to end_speed_m_s in distance_m.

    It goes on at v for reaction_s, then slows by a = accel_m_s2: v² = v_end² + 2 a (d − v t), solved for v.
    """
    delayed = setting.accel_m_s2 * reaction_s
    room = 2.0 * setting.accel_m_s2 * max(distance_m, 0.0)
    speed = math.sqrt(delayed * delayed + end_speed_m_s * end_speed_m_s + room) - delayed
    return max(speed, end_speed_m_s)


def leg_speed_m_s(leg_speed_m_s: float, distance_m: float, end_speed_m_s: float, config: BoatConfig) -> float:
    """Speed allowed on a leg where in distance_m no more than end_speed_m_s may be left.

    Never below min_speed_m_s, unless the leg's own speed is lower: a boat without steerage way steers
    badly, and whoever gave the leg ends it.
    """
    if end_speed_m_s >= leg_speed_m_s:
        return leg_speed_m_s
    allowed = braking_speed_m_s(distance_m, end_speed_m_s, config.guidance, config.handling.surge_time_s)
    return min(leg_speed_m_s, max(allowed, config.guidance.min_speed_m_s))


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
