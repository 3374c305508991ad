"""The cost of a rollout, and the cheapest one.

    J = way / (v T) + 8 mean(max(0, 1 − d / margin)²) + hit + 20 C + side + habit + effort

way: what is left to the goal at the end of the rollout, a margin further along the bow (`cost_to_go.py`), in
shares of what the boat covers within the horizon T at the wanted speed v, at least of its sight. d: clearance
at a step. hit: the first touch, the more the sooner and the faster. C: expected number of collisions with
what may move (`movers.py`). side: to port of the way wanted, where something may move (collision regulations,
rules 14, 15 and 17). The weights were chosen on seeds 1 to 4 of `boat-sitl encounters`.
"""

import math
from typing import Final

from companion.config.boat_config import BoatConfig
from companion.core.state import NavState
from companion.core.units import wrap_pi
from companion.guidance.course_to_steer import course_to_steer
from companion.obstacles.planning.clearance import FENCE, LEVEL, LEVELS, ClearanceField
from companion.obstacles.planning.cost_to_go import CostToGo
from companion.obstacles.planning.motion import (
    CRASH_STOP,
    FULL_ASTERN,
    STEP_S,
    STEPS,
    CourseFan,
    Rollout,
    roll,
)
from companion.obstacles.planning.movers import Predicted, collision_risk

HORIZON_S: Final = STEP_S * STEPS
_NEAR: Final = 8.0
_HIT: Final = 10.0  # more than no progress and every other term,
_COLLISION: Final = 20.0  # and more for what comes towards the boat
_PORT: Final = 0.05  # breaks ties; with something that surely moves near, 1 more
_ASTERN: Final = 0.5  # an approaching obstacle catches up
_HABIT: Final = 1.0  # half a turn away from the last decision
_STAYS: Final = 0.1  # a rollout must be cheaper than the intent by this: about a turn by 5°
TOUCH: Final = 0.35  # margins: half its beam and a cell
HULL: Final = 0.6  # margins: half the hull's length and half a cell


class CostModel:
    """The terms for one decision. scale_m: v T; wanted_rad: course of the path."""

    def __init__(
        self,
        nav: NavState,
        field: ClearanceField,
        to_go: CostToGo,
        movers: list[Predicted],
        margin_m: float,
        scale_m: float,
        wanted_rad: float,
        config: BoatConfig,
    ) -> None:
        self._nav, self._field, self._to_go, self.movers = nav, field, to_go, movers
        self._config, self._wanted_rad = config, wanted_rad
        self._scale_m = scale_m
        self._lead_m = margin_m
        self._cos, self._sin = math.cos(nav.heading_rad), math.sin(nav.heading_rad)
        clear = [(LEVELS - level) * field.cell_m for level in range(LEVELS + 1)]
        self._near = [
            max(1.0 - clear_m / margin_m, 0.0) ** 2 + (clear_m < HULL * margin_m) for clear_m in clear
        ]
        self._near += [2.0] * (LEVEL - LEVELS)
        self._touch_level = LEVELS - round(TOUCH * margin_m / field.cell_m)
        here = field.at(nav.north_m, nav.east_m)
        self._from_level = here & LEVEL
        self._fence_bit = 0 if here & FENCE else FENCE  # outside, any way may lead back
        self._port = _PORT + max((one.weight for one in movers), default=0.0)
        self.is_near = (LEVELS - self._from_level) * field.cell_m < margin_m

    def plain(self, rollout: Rollout, last_heading_rad: float | None) -> float:
        """The terms that need no look at the map: a lower bound."""
        nav = self._nav
        c, s = self._cos, self._sin
        ahead, right = rollout.ahead_m[-1], rollout.right_m[-1]
        if rollout.speed_m_s >= 0.0:
            ahead += self._lead_m * math.cos(rollout.bow_rad)
            right += self._lead_m * math.sin(rollout.bow_rad)
        north_m = nav.north_m + ahead * c - right * s + HORIZON_S * nav.current_north_m_s
        east_m = nav.east_m + ahead * s + right * c + HORIZON_S * nav.current_east_m_s
        cost = self._to_go.at(north_m, east_m) / self._scale_m
        heading = nav.heading_rad + rollout.turn_rad
        if wrap_pi(heading - self._wanted_rad) < -0.1:
            cost += self._port
        if rollout.speed_m_s < 0.0:
            cost += _ASTERN
        if last_heading_rad is not None:
            cost += _HABIT * abs(wrap_pi(heading - last_heading_rad)) / math.pi
        return cost

    def risk(self, rollout: Rollout, most: float = math.inf, steps: int = STEPS) -> float:
        """Clearance, touches and movers along a rollout; abandoned above `most`."""
        nav = self._nav
        return self._along(
            rollout.ahead_m, rollout.right_m, self._cos, self._sin,
            nav.current_north_m_s, nav.current_east_m_s, most, steps,
        )  # fmt: skip

    def risk_on(self, norths_m: list[float], easts_m: list[float]) -> float:
        """The same along places relative to the boat, one a step. Before the fence alone, its brake stops."""
        fence_bit, self._fence_bit = self._fence_bit, 0
        risk = self._along(norths_m, easts_m, 1.0, 0.0, 0.0, 0.0, math.inf, STEPS)
        self._fence_bit = fence_bit
        return risk

    def _along(
        self,
        aheads: tuple[float, ...] | list[float],
        rights: tuple[float, ...] | list[float],
        c: float,
        s: float,
        drift_n: float,
        drift_e: float,
        most: float,
        steps: int,
    ) -> float:
        field, near, stops = self._field, self._near, self._fence_bit
        cells, width, per_m = field.cells, field.width, 1.0 / field.cell_m
        start_n, start_e = self._nav.north_m - field.south_m, self._nav.east_m - field.west_m
        drift_n, drift_e = drift_n * STEP_S, drift_e * STEP_S
        least_level = max(self._from_level, self._touch_level)
        norths, easts = [], []
        risk = 0.0
        share = _NEAR / STEPS
        for step in range(steps):
            ahead, right = aheads[step], rights[step]
            north = (start_n + ahead * c - right * s + drift_n * (step + 1)) * per_m
            east = (start_e + ahead * s + right * c + drift_e * (step + 1)) * per_m
            norths.append(north)
            easts.append(east)
            row, column = int(north), int(east)
            if 0 <= row < width and 0 <= column < width and (byte := cells[row * width + column]):
                level = byte & LEVEL
                risk += share * near[level]
                if level > least_level or byte & stops:
                    last_n, last_e = (norths[-2], easts[-2]) if step else (start_n * per_m, start_e * per_m)
                    speed = math.hypot(north - last_n, east - last_e) * field.cell_m / STEP_S
                    risk += _HIT * (1.0 - 0.5 * step / STEPS) * (0.5 + speed)
                    break
                if risk > most:
                    return risk
        for mover in self.movers:
            risk += _COLLISION * collision_risk(mover, norths, easts)
            if risk > most:
                break
        return risk

    def choose(
        self,
        fan: CourseFan,
        speed_m_s: float,
        path: tuple[list[float], list[float]] | None,
        last_heading_rad: float | None,
        *,
        is_certain: bool,
    ) -> Rollout | None:
        """The cheapest rollout; None: the intent is as cheap.

        path: places on the intent's path, relative to the boat; None if it leads nowhere. is_certain: not
        only single echoes are near; otherwise no propeller turns astern.
        """
        nav, config = self._nav, self._config
        surge = nav.surge_m_s - nav.current_along_m_s(nav.heading_rad)
        least = config.guidance.min_speed_m_s
        heading, water_m_s = course_to_steer(self._wanted_rad, speed_m_s, nav, config)
        straight = roll(surge, nav.yaw_rate_rad_s, wrap_pi(heading - nav.heading_rad), water_m_s, config)
        keeps = math.inf
        if path is not None:
            keeps = max(self.risk_on(*path), self.risk(straight, steps=STEPS // 2))
            if keeps == 0.0:
                return None
            left_m = self._to_go.at(nav.north_m + path[0][-1], nav.east_m + path[1][-1])
            keeps += max(left_m - self._lead_m, 0.0) / self._scale_m
        least += math.hypot(nav.current_north_m_s, nav.current_east_m_s)  # stems the current
        speeds = {round(speed, 1) for speed in (water_m_s, 0.5 * (water_m_s + least), least, 0.0)}
        if is_certain and (self.is_near or self.movers):
            speeds.add(-least)
        candidates = [straight]
        for speed in sorted(speeds):
            candidates += fan.rollouts(surge, nav.yaw_rate_rad_s, speed, config, brakes=is_certain)
        if is_certain and surge > config.guidance.min_speed_m_s:
            candidates.append(roll(surge, nav.yaw_rate_rad_s, 0.0, CRASH_STOP, config))
        if is_certain and self.movers:  # a boat at rest is run into
            candidates.append(roll(surge, nav.yaw_rate_rad_s, 0.0, FULL_ASTERN, config))
        best, least_cost = straight, math.inf
        for plain, number in sorted(
            (self.plain(one, last_heading_rad), n) for n, one in enumerate(candidates)
        ):
            if plain >= least_cost:
                break
            cost = plain + self.risk(candidates[number], least_cost - plain)
            if cost < least_cost:
                best, least_cost = candidates[number], cost
        return None if keeps <= least_cost + (_STAYS if last_heading_rad is None else 0.0) else best
