"""The turn from one leg onto the next, as this hull sails it in this current.

In a current, the ground track of a boat that turns at a constant rate is a trochoid, not a circle (L. Techy
and C. A. Woolsey, "Minimum-time path planning for unmanned aerial vehicles in steady uniform winds", *Journal
of Guidance, Control, and Dynamics* 32, 2009). A fillet is therefore planned through the water: the yaw rate
is a trapezoid (clothoid, arc, clothoid), and the speed through the water changes linearly from the first
leg's to the second's. Adding the current gives the ground track, which is then placed to begin on the first
leg and end on the second. By construction, no fillet exceeds the configured yaw rate or lateral acceleration,
nor, on a boat that cannot turn on the spot, its smallest turning radius through the water.

Entry and exit speeds are chosen for the least time lost, where the squared distance from the legs, integrated
over time, has a price. With one price for all corners, the sum of lost time is the least for the RMS
cross-track error that results.
"""

import math
from typing import NamedTuple

from companion.config.boat_config import BoatConfig
from companion.guidance.speed_profile import gaining_m_s2

STEPS = 16  # of the numerical integration over a fillet
TURN_SHARE = 0.92  # of the turn rate at full steering: the rest is for corrections
# Price of a second at the waypoint's radius off the legs, in seconds: with 17 the lake boat's zigzag in
# 0.5 m/s takes 163 s at an RMS of 0.21 m; up to 24 it is 3 s slower and 0.03 m nearer to the legs.
ERROR_COST = 17.0
BEYOND_COST_S = 40.0  # per radius beyond the radius
HASTY_SHARE = 0.1  # of yaw_time_s: faster change of the yaw rate, for short legs
HASTY_LOSS_S = 1.0  # a fillet that loses more time is tried hastily as well
EASY_LOSS_S = 0.25  # a fillet at full speed that loses less is taken without a search
PASSED_RADII = 2.0  # from the waypoint: farther from it, a fillet passes only where a pivot drifts as far
SHARP_RAD = 2.0  # for sharper turns, that is one radius
SHARPEST_RAD = 2.4  # sharper turns are made on the spot
LEAST_TURN_RAD = 0.01  # smaller turns are no corner
LEAST_AHEAD_SHARE = 0.75  # of min_speed_m_s through the water along the leg: the least that gives a heading
OUTSIDE_M = 0.02  # beyond a leg, on the outside of the corner: the error of the integration
_COARSE = (1.0, 0.85, 0.7, 0.55, 0.4, 0.25, 0.12)  # of the leg's speed: coarse grid,
_FINE = (0.08, 0.04)  # and steps around its best


class Bend(NamedTuple):
    """The constraints of a fillet.

    Course of the first leg; turn onto the second, positive to starboard; room along each leg; the waypoint's
    radius; speed over ground on the legs; the current. onward_m along the second leg the speed must be down
    to onward_m_s.
    """

    course_rad: float
    turn_rad: float
    entry_room_m: float
    exit_room_m: float
    radius_m: float
    speed_m_s: float
    current_north_m_s: float
    current_east_m_s: float
    onward_m: float
    onward_m_s: float


class FilletNode(NamedTuple):
    """Relative to the waypoint. turned_rad: course over ground, relative to the first leg."""

    north_m: float
    east_m: float
    turned_rad: float
    speed_m_s: float


class Fillet(NamedTuple):
    """It begins entry_m before the waypoint, ends exit_m behind it, and passes it at cut_m.

    error_m2_s: the square of the distance to the nearer leg, integrated over time.
    """

    entry_m: float
    exit_m: float
    time_s: float
    cut_m: float
    error_m2_s: float
    nodes: tuple[FilletNode, ...]


def best_fillet(bend: Bend, config: BoatConfig) -> Fillet | None:
    """The fillet of least cost; None: there is none, and the boat turns on the spot, or behind the corner."""
    if not LEAST_TURN_RAD < abs(bend.turn_rad) < SHARPEST_RAD:
        return None
    reach_m = (1.0 if abs(bend.turn_rad) > SHARP_RAD else PASSED_RADII) * bend.radius_m
    ramp_s = config.handling.yaw_time_s
    for ramp in (ramp_s, HASTY_SHARE * ramp_s):
        easy = fillet_between(bend, bend.speed_m_s, bend.speed_m_s, ramp, config)
        if easy is not None and cost_s(easy, bend, config) < EASY_LOSS_S:
            return easy
    best = _search(bend, ramp_s, config)
    if best is None or cost_s(best, bend, config) > HASTY_LOSS_S:
        hasty = _search(bend, HASTY_SHARE * ramp_s, config)
        if hasty is not None and (
            best is None or cost_s(hasty, bend, config) + 2.0 * ramp_s < cost_s(best, bend, config)
        ):
            best = hasty
    if best is None or best.cut_m > max(reach_m, _drift_m(bend, config)):
        return None
    return best


def _drift_m(bend: Bend, config: BoatConfig) -> float:
    """How far the current carries a boat that turns on the spot instead."""
    turning_s = (
        abs(bend.turn_rad) / (TURN_SHARE * config.handling.turn_rate_rad_s) + config.handling.yaw_time_s
    )
    return math.hypot(bend.current_north_m_s, bend.current_east_m_s) * turning_s


def cost_s(fillet: Fillet, bend: Bend, config: BoatConfig) -> float:
    """Time lost against both legs at full speed, with braking and acceleration, plus the price of the cut."""
    full = bend.speed_m_s
    entry_m_s, exit_m_s = fillet.nodes[0].speed_m_s, fillet.nodes[-1].speed_m_s
    lost = fillet.time_s - (fillet.entry_m + fillet.exit_m) / full
    lost += (full - entry_m_s) ** 2 / (2.0 * config.guidance.accel_m_s2 * full)
    lost += (full - exit_m_s) ** 2 / (2.0 * _gaining_m_s2(bend, 0.5 * (full + exit_m_s), config) * full)
    beyond = max(fillet.cut_m / bend.radius_m - 1.0, 0.0)
    return lost + ERROR_COST * fillet.error_m2_s / bend.radius_m**2 + BEYOND_COST_S * beyond


def _gaining_m_s2(bend: Bend, speed_m_s: float, config: BoatConfig) -> float:
    """Acceleration at full throttle at a speed over ground on the second leg."""
    onto = bend.course_rad + bend.turn_rad
    water = speed_m_s - bend.current_north_m_s * math.cos(onto) - bend.current_east_m_s * math.sin(onto)
    return gaining_m_s2(water, config)


def _search(bend: Bend, ramp_s: float, config: BoatConfig) -> Fillet | None:
    """Search entry and exit speeds: a coarse grid, then steps around the best."""
    best: Fillet | None = None
    least_s, at = math.inf, (0.0, 0.0)
    tries = [(one, other) for one in _COARSE for other in _COARSE]
    for step in (*_FINE, 0.0):
        for one, other in tries:
            if max(one, other) > 1.0 or min(one, other) <= 0.0:
                continue
            fillet = fillet_between(bend, one * bend.speed_m_s, other * bend.speed_m_s, ramp_s, config)
            if fillet is None:
                continue
            cost = cost_s(fillet, bend, config)
            if cost < least_s:
                best, least_s, at = fillet, cost, (one, other)
        if best is None:
            return None
        tries = [(at[0] + i * step, at[1] + j * step) for i in (-1, 0, 1) for j in (-1, 0, 1) if i or j]
    return best


def fillet_between(
    bend: Bend, entry_m_s: float, exit_m_s: float, ramp_s: float, config: BoatConfig
) -> Fillet | None:
    """The fillet between two speeds over ground; None: it does not fit.

    ramp_s: time in which the yaw rate grows to its maximum.
    """
    current_n, current_e = bend.current_north_m_s, bend.current_east_m_s
    setting = config.guidance
    first, second = bend.course_rad, bend.course_rad + bend.turn_rad
    c1, s1, c2, s2 = math.cos(first), math.sin(first), math.cos(second), math.sin(second)
    ahead1 = entry_m_s - current_n * c1 - current_e * s1
    ahead2 = exit_m_s - current_n * c2 - current_e * s2
    # Least speed through the water that keeps a heading.
    least = LEAST_AHEAD_SHARE * setting.min_speed_m_s
    ahead1, ahead2 = max(ahead1, least), max(ahead2, least)
    exit_m_s = ahead2 + current_n * c2 + current_e * s2
    across1, across2 = current_n * s1 - current_e * c1, current_n * s2 - current_e * c2
    water1, water2 = math.hypot(ahead1, across1), math.hypot(ahead2, across2)
    if max(water1, water2) > config.handling.top_speed_m_s:
        return None
    crab1 = math.atan2(across1, ahead1)
    bow = bend.turn_rad + math.atan2(across2, ahead2) - crab1
    fastest = TURN_SHARE * config.handling.turn_rate_rad_s
    rate = min(fastest, setting.corner_accel_m_s2 / max(water1, water2))
    if config.drive.least_radius_m > 0.0:
        rate = min(rate, min(water1, water2) / config.drive.least_radius_m)
    rate, ramp_s, time_s = _trapezoid(abs(bow), rate, fastest / ramp_s)
    if abs(water2 - water1) > setting.accel_m_s2 * time_s:
        return None

    # The ground track from the entry on, and its placement.
    side = math.copysign(1.0, bow)
    step_s = time_s / STEPS
    growth = (water2 - water1) / time_s
    north = east = 0.0
    track = [(0.0, 0.0)]
    for n in range(STEPS):
        at_s = (n + 0.5) * step_s
        psi = first + crab1 + side * _turned_rad(at_s, time_s, ramp_s, rate)
        water = water1 + growth * at_s
        north += step_s * (water * math.cos(psi) + current_n)
        east += step_s * (water * math.sin(psi) + current_e)
        track.append((north, east))
    sine = c1 * s2 - s1 * c2
    entry_m, exit_m = (north * s2 - east * c2) / sine, (c1 * east - s1 * north) / sine
    if not (0.0 <= entry_m <= bend.entry_room_m and 0.0 <= exit_m <= bend.exit_room_m):
        return None
    braking_m = max(bend.onward_m - exit_m, 0.0)
    if exit_m_s * exit_m_s > bend.onward_m_s * bend.onward_m_s + 2.0 * setting.accel_m_s2 * braking_m:
        return None

    inner = math.copysign(1.0, bend.turn_rad)
    nodes, cut_m, error_m2_s = [], math.inf, 0.0
    for n, (at_n, at_e) in enumerate(track):
        n_m, e_m = at_n - entry_m * c1, at_e - entry_m * s1
        cut_m = min(cut_m, math.hypot(n_m, e_m))
        off_m = min(inner * (e_m * c1 - n_m * s1), inner * (e_m * c2 - n_m * s2))
        if off_m < -OUTSIDE_M:
            return None
        error_m2_s += step_s * off_m * off_m
        at_s = n * step_s
        psi = crab1 + side * _turned_rad(at_s, time_s, ramp_s, rate)
        water = water1 + growth * at_s
        ahead = water * math.cos(psi) + current_n * c1 + current_e * s1
        aside = water * math.sin(psi) + current_e * c1 - current_n * s1
        nodes.append(FilletNode(n_m, e_m, math.atan2(aside, ahead), math.hypot(ahead, aside)))
    return Fillet(entry_m, exit_m, time_s, cut_m, error_m2_s, tuple(nodes))


def _trapezoid(angle_rad: float, rate_rad_s: float, accel_rad_s2: float) -> tuple[float, float, float]:
    """Maximum rate, ramp time and total time of the fastest turn by an angle."""
    if angle_rad * accel_rad_s2 < rate_rad_s * rate_rad_s:
        rate_rad_s = math.sqrt(max(angle_rad * accel_rad_s2, 1e-12))
    ramp_s = rate_rad_s / accel_rad_s2
    return rate_rad_s, ramp_s, angle_rad / rate_rad_s + ramp_s


def _turned_rad(at_s: float, time_s: float, ramp_s: float, rate_rad_s: float) -> float:
    """Angle turned by a trapezoidal yaw rate up to a time."""
    if at_s < ramp_s:
        return 0.5 * rate_rad_s * at_s * at_s / ramp_s
    left_s = time_s - at_s
    if left_s < ramp_s:
        return rate_rad_s * (time_s - ramp_s - 0.5 * left_s * left_s / ramp_s)
    return rate_rad_s * (at_s - 0.5 * ramp_s)
