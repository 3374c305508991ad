"""What corners and stops cost a boat in time, beside straight legs at its speed."""

import math
from collections.abc import Sequence

from companion.core.geo import Point, bearing_rad
from companion.core.units import wrap_pi
from mission_tools.costs.boat import Boat

TURN_LOSS = 0.7
"""Share of the time that a turn takes at the boat's full turn rate that a corner costs beside its fillet (an
emulated survey with 45 sharp corners, lake boat)."""
GAINING_SHARE = 1.5  # as the boat's speed profile: it gains speed half as fast again as it loses it


def turns_rad(points: Sequence[Point]) -> list[float]:
    """At the end of each leg; 0 at the last."""
    found = []
    for a, b, c in zip(points, points[1:], points[2:], strict=False):
        is_turn = b not in (a, c)
        found.append(abs(wrap_pi(bearing_rad(b, c) - bearing_rad(a, b))) if is_turn else 0.0)
    return [*found, 0.0]


def manoeuvres_s(
    turns_rad: Sequence[float], holds_s: Sequence[float], boat: Boat, speed_m_s: float
) -> tuple[list[float], list[bool]]:
    """Time lost at the end of each leg: in its corner, and by a stop; the start is in the first. And whether
    the boat keeps steerage way meanwhile. The mission ends at the waypoint's radius, under way.
    """
    stop_s2_m = 1.0 / boat.accel_m_s2
    both_s2_m = (1.0 + 1.0 / GAINING_SHARE) / boat.accel_m_s2
    lost, under_way = [], []
    for n, (turn, hold_s) in enumerate(zip(turns_rad, holds_s, strict=True), start=1):
        is_last = n == len(turns_rad)
        if hold_s > 0.0:
            slowest = 0.0
        elif is_last:
            slowest = min(speed_m_s, math.sqrt(2.0 * boat.accel_m_s2 * boat.waypoint_radius_m))
        else:
            slack = 1.0 / max(math.cos(0.5 * turn), 1e-3) - 1.0  # of a fillet, per metre of its radius
            radius_m = boat.waypoint_radius_m / max(slack, 1e-9)
            slowest = min(speed_m_s, math.sqrt(boat.corner_accel_m_s2 * radius_m))
        slowing_s = (speed_m_s - slowest) ** 2 / (2.0 * speed_m_s) * (stop_s2_m if is_last else both_s2_m)
        is_on_the_spot = slowest < boat.slowest_m_s
        rate_rad_s = boat.turn_rate_rad_s
        if boat.least_radius_m > 0.0:
            rate_rad_s = min(rate_rad_s, max(slowest, boat.slowest_m_s) / boat.least_radius_m)
        turning_s = (1.0 if is_on_the_spot else TURN_LOSS) * turn / rate_rad_s
        ahead_s = boat.waypoint_radius_m / speed_m_s if is_last and not hold_s > 0.0 else 0.0
        lost.append(slowing_s + turning_s - ahead_s)
        under_way.append(not is_on_the_spot)
    lost[0] += 0.5 * speed_m_s / (GAINING_SHARE * boat.accel_m_s2)
    return lost, under_way
