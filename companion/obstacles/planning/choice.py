"""Chooses between the intent's own path and the rollouts."""

import math
from typing import Final

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.state import NavState
from companion.core.units import wrap_pi
from companion.guidance.course_to_steer import course_to_steer
from companion.obstacles.planning.cost import CostModel
from companion.obstacles.planning.motion import CRASH_STOP, STEP_S, STEPS, Fan, Rollout, roll
from companion.obstacles.planning.way_ahead import places_on

_STAYS: Final = 0.1  # a rollout must be cheaper than the intent by this: about a turn by 5°
_DIRE: Final = 4.0  # the cost of a touch at low speed: only then a crash stop is considered
_HURRIES: Final = 3.0  # times the slowest speed with steerage way: to get out of a mover's way
_STILL: Final = 0.4  # of that speed: weaker currents are ignored, and a slower boat is stopped


def choose(
    nav: NavState,
    config: BoatConfig,
    costs: CostModel,
    fan: Fan,
    way: list[Point] | None,
    speed_m_s: float,
    last_heading_rad: float | None,
    *,
    is_holding: bool,
    is_certain: bool,
    has_movers: bool,
) -> Rollout | None:
    """The cheapest rollout; None: the intent is as cheap.

    way: the intent's path, None where it is blocked. is_holding: a rollout is held now. is_certain: not only
    single echoes are near. A rollout that touches before the boat can stop is not taken unless all do.
    """
    current_m_s = math.hypot(nav.current_north_m_s, nav.current_east_m_s)
    surge = nav.surge_m_s - nav.current_along_m_s(nav.heading_rad)
    least = config.guidance.min_speed_m_s
    heading, water_m_s = course_to_steer(
        costs.wanted_rad, speed_m_s, nav.current_north_m_s, nav.current_east_m_s,
        least, config.handling.top_speed_m_s,
    )  # fmt: skip
    straight = roll(surge, nav.yaw_rate_rad_s, wrap_pi(heading - nav.heading_rad), water_m_s, config)
    keeps = math.inf
    if way is not None:
        places = places_on(way, max(speed_m_s, least) * STEP_S, STEPS)
        norths_m = [at.north_m - nav.north_m for at in places]
        easts_m = [at.east_m - nav.east_m for at in places]
        danger = costs.danger_of_intent(straight, norths_m, easts_m)
        if costs.can_stop(danger.hit_s, surge):
            keeps = danger.risk
        if keeps == 0.0:
            return None
    speeds = {round(speed, 1) for speed in (water_m_s, 0.5 * (water_m_s + least), least, 0.0)}
    if has_movers:
        speeds.add(round(min(_HURRIES * least, config.speed.cruise_m_s), 1))
    if costs.is_near or has_movers:
        speeds.add(-least)
    candidates = [straight]
    for speed in sorted(speeds):
        candidates += fan.rollouts(surge, nav.yaw_rate_rad_s, speed, config)
    if current_m_s > _STILL * least and config.drive.can_pivot:  # the bow into the current holds the place
        upstream = math.atan2(-nav.current_east_m_s, -nav.current_north_m_s)
        candidates.append(
            roll(surge, nav.yaw_rate_rad_s, wrap_pi(upstream - nav.heading_rad), current_m_s, config)
        )
    best, least_cost, late, latest_s = None, math.inf, straight, -1.0
    rated = sorted((costs.plain(one, last_heading_rad), number) for number, one in enumerate(candidates))
    for plain, number in rated:
        if plain >= least_cost:
            break
        one = candidates[number]
        danger = costs.danger(one, least_cost - plain)
        if one.speed_m_s > 0.0 and not costs.can_stop(danger.hit_s, one.speed_m_s):
            if danger.hit_s > latest_s:
                late, latest_s = one, danger.hit_s
        elif plain + danger.risk < least_cost:
            best, least_cost = one, plain + danger.risk
    if is_certain and surge > least and least_cost > _DIRE:
        one = roll(surge, nav.yaw_rate_rad_s, 0.0, CRASH_STOP, config)
        cost = costs.plain(one, last_heading_rad) + costs.danger(one).risk
        if cost < least_cost:
            best, least_cost = one, cost
    if keeps <= least_cost + (0.0 if is_holding else _STAYS):
        return None
    return late if best is None else best
