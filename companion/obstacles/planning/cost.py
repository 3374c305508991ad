"""The cost of a rollout: progress, clearance, movers, side and effort, one term each.

    J = progress + 0.3 bow + 8 mean((1 − d / margin)²) + hit + 8 mean(mover) + side + effort

progress: distance from the end of the rollout to the point that the path reaches in the same time, in shares
of the way to it. bow: angle from the bow to that point at the end, in half turns. d: clearance at a step.
hit: a rollout that touches costs the more, the sooner. With a mover near, a turn to port costs more than one
to starboard (collision regulations, rules 14, 15 and 17); the movers themselves are in `movers.py`.
"""

import math
from typing import Final, NamedTuple

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.state import NavState
from companion.core.units import wrap_pi
from companion.obstacles.planning.clearance import FENCE, LEVEL, LEVELS, SOLID, ClearanceField
from companion.obstacles.planning.motion import CRASH_STOP, STEP_S, STEPS, Rollout
from companion.obstacles.planning.movers import HULL, NEAR, Predicted, encounter_cost, hit_cost

HORIZON_S: Final = STEP_S * STEPS
_BOW: Final = 0.3
_PORT: Final = 0.05  # breaks ties,
_PORT_MOVER: Final = 0.3  # with 0.6 a boat among rocks, one taken for a mover, turns to and fro
_ASTERN: Final = 0.5  # an approaching obstacle catches up
_HABIT: Final = 2.0  # of half a turn away from the last decision
_BRAKES: Final = 0.7  # of accel_m_s2: the lake boat stops within 2.3 m from 1 m/s with half reverse
_REACTION_S: Final = 0.5
TOUCH: Final = 0.35  # half its beam and a cell


class Danger(NamedTuple):
    """risk: cost of clearance and movers; hit_s: time of a touch of something certain, infinite for none."""

    risk: float
    hit_s: float


class CostModel:
    """The terms for one decision. reference_m_s: the speed that the path asks for; target: the point to make
    for, as far ahead as the boat comes within the horizon.
    """

    def __init__(
        self,
        nav: NavState,
        field: ClearanceField,
        movers: list[Predicted],
        margin_m: float,
        reference_m_s: float,
        target: Point,
        config: BoatConfig,
    ) -> None:
        self._nav = nav
        self._field = field
        self._target = target
        self._scale_m = max(reference_m_s * HORIZON_S, margin_m)
        self._config = config
        self._cos, self._sin = math.cos(nav.heading_rad), math.sin(nav.heading_rad)
        cell_m = field.cell_m
        self._near = [0.0] * (LEVEL + 1)
        for level in range(1, LEVELS + 1):
            clear_m = (LEVELS - level) * cell_m
            self._near[level] = max(1.0 - clear_m / margin_m, 0.0) ** 2 + (clear_m < HULL * margin_m)
        self._touch_level = LEVELS - round(TOUCH * margin_m / cell_m)
        here = field.at(nav.north_m, nav.east_m)
        self._from_level = here & LEVEL
        self._fence_bit = 0 if here & FENCE else FENCE  # outside, any way may lead back
        self.is_near = (LEVELS - self._from_level) * cell_m < margin_m
        self.movers = movers
        self.wanted_rad = math.atan2(target.east_m - nav.east_m, target.north_m - nav.north_m)

    def plain(self, rollout: Rollout, last_heading_rad: float | None) -> float:
        """The terms that need no look at the map: a lower bound."""
        nav, target = self._nav, self._target
        ahead, right = rollout.ahead_m[-1], rollout.right_m[-1]
        north = target.north_m - nav.north_m - ahead * self._cos + right * self._sin
        east = target.east_m - nav.east_m - ahead * self._sin - right * self._cos
        north -= HORIZON_S * nav.current_north_m_s
        east -= HORIZON_S * nav.current_east_m_s
        left_m = math.sqrt(north * north + east * east)
        bow = abs(wrap_pi(math.atan2(east, north) - nav.heading_rad - rollout.bow_rad)) / math.pi
        cost = left_m / self._scale_m + _BOW * bow * min(left_m / self._scale_m, 1.0)
        heading = nav.heading_rad + rollout.turn_rad
        if wrap_pi(heading - self.wanted_rad) < -0.1:
            cost += _PORT_MOVER if self.movers else _PORT
        if rollout.speed_m_s < 0.0:
            cost += _ASTERN if rollout.speed_m_s > CRASH_STOP else 2.0 * _ASTERN
        if last_heading_rad is not None:
            cost += _HABIT * abs(wrap_pi(heading - last_heading_rad)) / math.pi
        return cost

    def danger(self, rollout: Rollout, most: float = math.inf, steps: int = STEPS) -> Danger:
        """Clearance and movers along a rollout; abandoned above `most`."""
        nav = self._nav
        return self._along(
            rollout.ahead_m, rollout.right_m, self._cos, self._sin,
            nav.current_north_m_s, nav.current_east_m_s, most, steps,
        )  # fmt: skip

    def danger_on(self, norths_m: list[float], easts_m: list[float]) -> Danger:
        """The same along places relative to the boat, one a step."""
        return self._along(norths_m, easts_m, 1.0, 0.0, 0.0, 0.0, math.inf)

    def danger_of_intent(self, straight: Rollout, norths_m: list[float], easts_m: list[float]) -> Danger:
        """Of the intent's path, and of the turn towards it: before the fence alone, the fence brake stops."""
        fence_bit, self._fence_bit = self._fence_bit, 0
        ahead, first = self.danger_on(norths_m, easts_m), self.danger(straight, steps=STEPS // 2)
        self._fence_bit = fence_bit
        return Danger(max(ahead.risk, first.risk), min(ahead.hit_s, first.hit_s))

    def can_stop(self, hit_s: float, speed_m_s: float) -> bool:
        """Whether the boat, at this speed from now on, can stop before a touch at hit_s."""
        return hit_s > _REACTION_S + 0.5 * abs(speed_m_s) / (_BRAKES * self._config.guidance.accel_m_s2)

    def _along(
        self,
        aheads: tuple[float, ...] | list[float],
        rights: tuple[float, ...] | list[float],
        c: float,
        s: float,
        drift_n: float,
        drift_e: float,
        most: float,
        steps: int = STEPS,
    ) -> Danger:
        field, near, fence_bit = self._field, self._near, self._fence_bit
        cells, width, per_m = field.cells, field.width, 1.0 / field.cell_m
        start_n, start_e = self._nav.north_m - field.south_m, self._nav.east_m - field.west_m
        drift_n, drift_e = drift_n * STEP_S, drift_e * STEP_S
        norths, easts = [], []
        total, risk, hit_s = 0.0, 0.0, math.inf
        for step in range(steps):
            ahead, right = aheads[step], rights[step]
            north = (start_n + ahead * c - right * s + drift_n * (step + 1)) * per_m
            east = (start_e + ahead * s + right * c + drift_e * (step + 1)) * per_m
            norths.append(north)
            easts.append(east)
            row, column = int(north), int(east)
            if 0 <= row < width and 0 <= column < width and (byte := cells[row * width + column]):
                level = byte & LEVEL
                total += near[level]
                is_nearer = level > self._from_level and level > self._touch_level
                if is_nearer or byte & fence_bit:
                    last_n, last_e = (norths[-2], easts[-2]) if step else (start_n * per_m, start_e * per_m)
                    risk = hit_cost(step, math.hypot(north - last_n, east - last_e) * field.cell_m / STEP_S)
                    if byte & (fence_bit | SOLID):
                        hit_s = (step + 1) * STEP_S
                    break
        risk += NEAR * total / STEPS
        for mover in self.movers:
            if risk > most:
                break
            risk += mover.weight * encounter_cost(mover, norths, easts)
        return Danger(risk, hit_s)
