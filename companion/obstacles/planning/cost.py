"""The cost of a rollout, and the cheapest one.

    J = way / 5 margins + 4 mean(max(0, margin / d − 1)²) + hit + unseen + 100 C + side + habit + effort

way: what is left to the goal at the end of the rollout, a margin further along the bow (`cost_to_go.py`).
d: clearance of the hull's leading half at a step, with the potential of O. Khatib
(*Real-time obstacle avoidance*, International Journal of Robotics Research 5(1), 1986), which has no jump
that a small move of the boat would turn into another choice. hit: the first touch, the more
the sooner and the faster. unseen: share of the first three seconds in water that no ranger has seen free, the
more the faster: what lies there is met before the boat can stop. C: expected number of collisions with what
may move, AIS vessels among it (`movers.py`). side: to port of the way wanted, where something may move
(collision regulations, rules 14, 15 and 17). habit: change of the heading and of the speed that are held.
The weights were chosen on seeds 1001 to 1009 of `boat-sitl encounters`.
"""

import math
from collections.abc import Sequence
from typing import Final

from companion.config.boat_config import BoatConfig
from companion.core.state import NavState
from companion.core.units import wrap_pi
from companion.guidance.course_to_steer import course_to_steer
from companion.obstacles.planning.clearance import FENCE, LEVEL, LEVELS, UNSEEN, ClearanceField
from companion.obstacles.planning.cost_to_go import CostToGo
from companion.obstacles.planning.motion import (
    APART_RAD,
    BOW,
    CRASH_STOP,
    FULL_ASTERN,
    STEP_S,
    STEPS,
    CourseFan,
    Rollout,
    roll,
)
from companion.obstacles.planning.movers import EVERY, VESSEL_S, Predicted, collision_risk

HORIZON_S: Final = STEP_S * STEPS
_NEAR: Final = 4.0
_WAY: Final = 5.0  # margins
_WARY: Final = 1.0  # a path near something whose extent is not known
_HIT: Final = 100.0  # more than no progress and every other term
_UNSEEN: Final = 2.0
_STOPS: Final = 12  # steps: three seconds, a crash stop from 1.7 m/s
_COLLISION: Final = 100.0  # with what may move
_PORT: Final = 0.05  # breaks ties; with something that surely moves near, 1 more
_ASTERN: Final = 0.5  # an approaching obstacle catches up
_BRAKE: Final = 0.1  # a crash stop throws spray over the deck
_HABIT: Final = 0.8  # half a turn away from the last decision,
_CHANGE: Final = 0.3  # and the whole of the wanted speed
_SPEEDS_M_S: Final = 0.3  # apart
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
        vessels: Sequence[Predicted] = (),
    ) -> None:
        self._nav, self._field, self._to_go, self.movers = nav, field, to_go, movers
        self._vessels = vessels
        self._config, self._wanted_rad = config, wanted_rad
        self._scale_m, self._fast_m_s = _WAY * margin_m, scale_m / HORIZON_S
        self._blind = _UNSEEN / _STOPS / self._fast_m_s
        self._lead_m = margin_m
        self._cos, self._sin = math.cos(nav.heading_rad), math.sin(nav.heading_rad)
        clear = [(LEVELS - level) * field.cell_m for level in range(LEVELS + 1)]
        self._near = [max(margin_m / max(clear_m, field.cell_m) - 1.0, 0.0) ** 2 for clear_m in clear]
        self._near += [self._near[-1]] * (LEVEL - LEVELS)
        self._touch_level = LEVELS - round(TOUCH * margin_m / field.cell_m)
        bow_m = BOW * config.avoidance.margin_m
        here = field.at(nav.north_m + bow_m * self._cos, nav.east_m + bow_m * self._sin)
        self._from_level = here & LEVEL
        self._fence_bit = 0 if here & FENCE else FENCE  # outside, any way may lead back
        self._port = _PORT + max((one.weight for one in (*movers, *vessels)), default=0.0)
        self.is_near = (LEVELS - self._from_level) * field.cell_m < margin_m

    def plain(self, rollout: Rollout, last: tuple[float, float] | None) -> float:
        """The terms that need no look at the map: a lower bound. last: heading and speed held so far."""
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
            cost += _BRAKE if rollout.speed_m_s == CRASH_STOP else _ASTERN
        if last is not None:
            cost += _HABIT * abs(wrap_pi(heading - last[0])) / math.pi
            change_m_s = _held_m_s(rollout.speed_m_s) - _held_m_s(last[1])
            cost += _CHANGE * abs(change_m_s) / self._fast_m_s
        return cost

    def risk(self, rollout: Rollout, most: float = math.inf, steps: int = STEPS) -> float:
        """Clearance, touches, unseen water and movers along a rollout; abandoned above `most`. Fewer steps:
        only to see whether it is clear, whatever was not seen.
        """
        nav = self._nav
        blind = self._blind * max(rollout.speed_m_s, 0.0) if steps == STEPS else 0.0
        return self._along(
            rollout.ahead_m, rollout.right_m, self._cos, self._sin,
            nav.current_north_m_s, nav.current_east_m_s, most, steps, blind,
        )  # fmt: skip

    def risk_on(self, norths_m: list[float], easts_m: list[float]) -> float:
        """The same along places relative to the boat, one a step. Before the fence alone, its brake stops."""
        fence_bit, self._fence_bit = self._fence_bit, 0
        risk = self._along(norths_m, easts_m, 1.0, 0.0, 0.0, 0.0, math.inf, STEPS, 0.0)
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
        blind: float,
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
                if byte & UNSEEN and step < _STOPS:
                    risk += blind
                if level > least_level or byte & stops:
                    last_n, last_e = (norths[-2], easts[-2]) if step else (start_n * per_m, start_e * per_m)
                    speed = math.hypot(north - last_n, east - last_e) * field.cell_m / STEP_S
                    risk += _HIT * (1.0 - 0.5 * step / STEPS) * (0.5 + speed) + 2.0 * share * (steps - step)
                    break
                if risk > most:
                    return risk
        for mover in self.movers:
            risk += _COLLISION * collision_risk(mover, norths, easts)
            if risk > most:
                return risk
        if self._vessels and step:
            norths, easts = _onward(norths), _onward(easts)
            for vessel in self._vessels:
                risk += _COLLISION * collision_risk(vessel, norths, easts)
                if risk > most:
                    break
        return risk

    def choose(
        self,
        fan: CourseFan,
        speed_m_s: float,
        path: tuple[list[float], list[float]] | None,
        last: tuple[float, float] | None,
        *,
        is_certain: bool,
        is_new: bool,
    ) -> Rollout | None:
        """The cheapest rollout; None: the intent is as cheap.

        path: places on the intent's path, relative to the boat; None if it leads nowhere. last: heading and
        speed through the water that are held, None while the intent is. is_certain: not only single echoes
        are near; otherwise no propeller turns astern. is_new: the extent of an obstacle is not known; the
        boat slows down on its heading until it is.
        """
        nav, config = self._nav, self._config
        surge = nav.water_speed_m_s
        least = config.guidance.min_speed_m_s
        heading, water_m_s = course_to_steer(self._wanted_rad, speed_m_s, nav, config)
        straight = roll(surge, nav.yaw_rate_rad_s, wrap_pi(heading - nav.heading_rad), water_m_s, config)
        keeps = math.inf
        if path is not None:
            keeps = max(self.risk_on(*path), self.risk(straight, steps=STEPS // 2))
            if keeps == 0.0:
                return None
            left_m = self._to_go.at(nav.north_m + path[0][-1], nav.east_m + path[1][-1])
            if keeps >= (_WARY if is_new else 0.25 * _HIT):
                keeps = math.inf  # it meets something, be it slowly and late
            keeps += max(left_m - self._lead_m, 0.0) / self._scale_m
        least += math.hypot(nav.current_north_m_s, nav.current_east_m_s)  # stems the current
        between = range(1, math.ceil((water_m_s - least) / _SPEEDS_M_S))
        speeds = {0.0, least, water_m_s, *(least + _SPEEDS_M_S * step for step in between)}
        if is_certain and surge <= least and (self.is_near or self.movers):
            speeds.add(-least)
        # The turns are told from the heading that is held, which so remains one of the candidates
        held = wrap_pi((heading if last is None else last[0]) - nav.heading_rad)
        candidates = [straight]
        if is_new and surge > least:
            turn = held if abs(held) < APART_RAD else 0.0
            candidates = [roll(surge, nav.yaw_rate_rad_s, turn, speed, config) for speed in (least, 0.0)]
            speeds = set()
        for speed in sorted(speeds):
            candidates += fan.rollouts(surge, nav.yaw_rate_rad_s, speed, config, held, brakes=is_certain)
        if is_certain and surge > config.guidance.min_speed_m_s:
            candidates.append(roll(surge, nav.yaw_rate_rad_s, 0.0, CRASH_STOP, config))
        if is_certain and self.movers:  # a boat at rest is run into
            candidates.append(roll(surge, nav.yaw_rate_rad_s, 0.0, FULL_ASTERN, config))
        best, least_cost = 0, math.inf
        for plain, number in sorted((self.plain(one, last), n) for n, one in enumerate(candidates)):
            if plain >= least_cost:
                break
            cost = plain + self.risk(candidates[number], least_cost - plain)
            if cost < least_cost:
                best, least_cost = number, cost
        if keeps <= least_cost + (_STAYS if last is None else -_STAYS):
            return None
        found = candidates[best]
        if least_cost >= 0.25 * _HIT and is_certain and surge > 0.0:
            return roll(surge, nav.yaw_rate_rad_s, 0.0, CRASH_STOP, config)  # a touch: as slowly as can be
        if best and speeds and found.speed_m_s >= 0.0:
            steps = round((found.turn_rad - held) / APART_RAD)
            found = found._replace(
                turn_rad=held + steps * APART_RAD, speed_m_s=min(found.speed_m_s, water_m_s)
            )
        return found


def _onward(along: list[float]) -> list[float]:
    """Where vessels are looked at: along a rollout, and straight on from its end."""
    end_s, a_second = len(along) * STEP_S, (along[-1] - along[-2]) / STEP_S
    later = [along[-1] + (time_s - end_s) * a_second for time_s in VESSEL_S if time_s > end_s]
    return along[EVERY - 1 :: EVERY] + later


def _held_m_s(speed_m_s: float) -> float:
    """The speed that a rollout holds; a crash stop holds none."""
    return speed_m_s if speed_m_s > CRASH_STOP else 0.0
