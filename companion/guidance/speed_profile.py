"""Speed limits for the corner ahead and for stops."""

import math
from collections.abc import Sequence
from itertools import pairwise

from companion.config.boat_config import BoatConfig
from companion.config.tuning import Guidance
from companion.core.geo import Point
from companion.guidance.path import Node

REACTION_S = 1.0  # response time of the speed
# Of accel_m_s2, the deceleration: acceleration of full throttle at two thirds of the top speed.
GAINING_SHARE = 1.5
_LEAST_GAINING = 0.2  # of accel_m_s2: nearer to the top speed a corner does not pay


def gaining_m_s2(water_m_s: float, config: BoatConfig) -> float:
    """Acceleration out of a corner: accel_m_s2 at half the top speed, falling with the square of the speed.

    Thrust changes little with speed, drag with its square, and both are equal at the top speed. Measured on
    the lake boat: 0.4 m/s² from 1.0 to 2.0 m/s in calm water, 0.25 m/s² against 0.5 m/s.
    """
    share = (1.0 - (water_m_s / config.handling.top_speed_m_s) ** 2) / 0.75
    return config.guidance.accel_m_s2 * max(share, _LEAST_GAINING)


def braking_speed_m_s(
    distance_m: float, end_speed_m_s: float, setting: Guidance, reaction_s: float = REACTION_S
) -> float:
    """Highest speed from which the boat can slow to end_speed_m_s in distance_m.

    It continues at v for reaction_s, then slows by a = accel_m_s2: v² = v_end² + 2 a (d − v t), solved for v.
    """
    delayed = setting.accel_m_s2 * reaction_s
    room = 2.0 * setting.accel_m_s2 * max(distance_m, 0.0)
    speed = math.sqrt(delayed * delayed + end_speed_m_s * end_speed_m_s + room) - delayed
    return max(speed, end_speed_m_s)


def leg_speed_m_s(leg_speed_m_s: float, distance_m: float, end_speed_m_s: float, config: BoatConfig) -> float:
    """Speed limit on a leg with end_speed_m_s required in distance_m.

    Never below min_speed_m_s unless the leg's own speed is: the boat needs steerage way, and the leg's owner
    ends it.
    """
    if end_speed_m_s >= leg_speed_m_s:
        return leg_speed_m_s
    allowed = braking_speed_m_s(distance_m, end_speed_m_s, config.guidance, config.handling.surge_time_s)
    return min(leg_speed_m_s, max(allowed, config.guidance.min_speed_m_s))


def steered_speed_m_s(speed_m_s: float, heading_error_rad: float, config: BoatConfig) -> float:
    """Speed limit with a heading error.

    No limit up to half of pivot_angle_rad, then linear to min_speed_m_s at pivot_angle_rad. Beyond, the boat
    turns on the spot, at speed zero; one that cannot turns at min_speed_m_s.
    """
    setting = config.guidance
    pivot = setting.pivot_angle_rad
    error = abs(heading_error_rad)
    if error > pivot:
        return 0.0 if config.drive.can_pivot else min(speed_m_s, setting.min_speed_m_s)
    return min(speed_m_s, max(speed_m_s * 2.0 * (1.0 - error / pivot), setting.min_speed_m_s))


def with_speeds(
    nodes: list[Node], fillets: Sequence[tuple[int, int]], speed_m_s: float, config: BoatConfig
) -> list[Node]:
    """The nodes with their speed limits, and additional nodes where acceleration ends or braking begins.

    fillets: first and last node of each; within them the speed is the fillet's, unless the path behind needs
    less. A backward pass limits the deceleration, a forward pass the acceleration.
    """
    slowing = 2.0 * config.guidance.accel_m_s2
    gaining = GAINING_SHARE * slowing
    speeds = [node.speed_m_s for node in nodes]
    inside = {n for first, last in fillets for n in range(first, last)}  # from n to n + 1 within a fillet
    lengths = [math.hypot(b.north_m - a.north_m, b.east_m - a.east_m) for a, b in pairwise(nodes)]
    for n in range(len(nodes) - 2, -1, -1):
        if n not in inside or speeds[n + 1] < nodes[n + 1].speed_m_s:
            speeds[n] = min(speeds[n], math.sqrt(speeds[n + 1] ** 2 + slowing * lengths[n]))
    out = []
    for n, node in enumerate(nodes):
        out.append(node._replace(speed_m_s=speeds[n]))
        if n + 1 == len(nodes):
            break
        if n not in inside or speeds[n] < node.speed_m_s:
            speeds[n + 1] = min(speeds[n + 1], math.sqrt(speeds[n] ** 2 + gaining * lengths[n]))
        if n not in inside:
            out.extend(_straight(node, nodes[n + 1], speeds[n], speeds[n + 1], speed_m_s, slowing, gaining))
    return out


def _straight(
    start: Node, end: Node, start_m_s: float, end_m_s: float, most_m_s: float, slowing: float, gaining: float
) -> list[Node]:
    """Nodes where acceleration ends and braking begins on a straight stretch."""
    length_m = math.hypot(end.north_m - start.north_m, end.east_m - start.east_m)
    # Squared speed is linear in distance; the two lines intersect at the highest speed.
    peak = gaining * end_m_s**2 + slowing * start_m_s**2 + gaining * slowing * length_m
    peak /= gaining + slowing
    top = min(peak, most_m_s * most_m_s)
    grown_m, fallen_m = (top - start_m_s**2) / gaining, length_m - (top - end_m_s**2) / slowing
    found = []
    for at_m in (grown_m, fallen_m) if fallen_m > grown_m + 1e-6 else (grown_m,):
        if 1e-6 < at_m < length_m - 1e-6:
            at = Point(*start[:2]).towards(Point(*end[:2]), at_m / length_m)
            found.append(Node(*at, start.course_rad, math.sqrt(max(top, 0.0))))
    return found
