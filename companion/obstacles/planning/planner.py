"""The local planner: keeps the intent, or replaces it by the heading and speed of the cheapest rollout.

Ten times a second the path of the intent is checked. Where it is clear, the intent stays, and in open water a
tick costs two comparisons. Otherwise each rollout of the boat's motion (`motion.py`) is rated (`cost.py`),
and the cheapest is held until the next decision. Where known cells block the path, the rollouts make for a
route around them (`route.py`); where there is none, the boat keeps station and tries again later.
"""

import math
from collections import deque
from enum import IntEnum
from typing import Final

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point, distance_m
from companion.core.intent import (
    FollowCircle,
    FollowLeg,
    HoldCourse,
    HoldHeading,
    HoldTurn,
    Intent,
    KeepStation,
    Stop,
)
from companion.core.state import NavState
from companion.core.status_text import Severity, StatusText
from companion.core.units import wrap_pi
from companion.guidance.speed_profile import braking_speed_m_s
from companion.obstacles.perception.perception import ObstaclePerception
from companion.obstacles.perception.track import Track
from companion.obstacles.planning.choice import choose
from companion.obstacles.planning.clearance import Bounds, ClearanceField
from companion.obstacles.planning.cost import HORIZON_S, TOUCH, CostModel
from companion.obstacles.planning.detour import Detour, blocked_m
from companion.obstacles.planning.motion import CRASH_STOP, Fan, Rollout
from companion.obstacles.planning.movers import HULL, predict_movers
from companion.obstacles.planning.speed_limit import SpeedLimit, crash_stop
from companion.obstacles.planning.way_ahead import is_same_goal, places_on, requested_m_s, way_ahead

PERIOD_S: Final = 0.09  # between decisions, at least
GIVING_WAY: Final = "Moving obstacle: giving way"
NO_WAY: Final = "Obstacle: no way around, keeping station"
_SIGHTS: Final = 2.5  # of the ranger: half the width of the map
_MOVES: Final = 0.2  # of it: the boat's way off the centre after which the map is laid anew
_DRIFT_S: Final = 0.8  # a current carries the boat on for so long before it answers: more margin
_BLOCKS: Final = 0.8  # of the margin: a path this near to something is blocked
_SPREAD: Final = 0.6  # of the margin: a mover's echoes in the grid lie within its radius and this,
_IN_VIEW_S: Final = 1.0  # as long as it is seen
_FENCE_STEP_M: Final = 0.5  # of the margin that is left
_CRUMBS: Final = 24  # places with room that are remembered, half a margin apart
_HALTS: Final = 0.25  # margins: told not to go round, the boat keeps station this near to the end of its way


class Stage(IntEnum):
    """What the planner is doing."""

    CLEAR = 0
    ROUND = 1  # around an obstacle
    BACK = 2  # astern
    BLOCKED = 3  # keeping station: there is no way around, or none is allowed
    PASSING = 4  # giving way to a moving obstacle


class LocalPlanner:
    """stage: present action; limit: the speed limits; eases: what it avoids may be noise, which no propeller
    turns astern for. Messages are appended to `status_texts`.
    """

    def __init__(self, status_texts: list[StatusText]) -> None:
        self.stage = Stage.CLEAR
        self.limit = SpeedLimit()
        self.eases = False
        self._status_texts = status_texts
        self._fan = Fan()
        self._field: ClearanceField | None = None
        self._field_key: tuple[object, ...] | None = None
        self._intent: Intent | None = None
        self._override: Intent | None = None
        self._due_s = 0.0
        self._crumbs: deque[Point] = deque(maxlen=_CRUMBS)
        self._forget()

    def reset(self) -> None:
        """Forget the present detour and the limits."""
        self._forget()
        self.limit.clear()
        self._intent = self._override = None
        self.eases = False

    def _forget(self) -> None:
        self.stage = Stage.CLEAR
        self._detour = Detour()
        self._heading_rad: float | None = None  # held at the last decision
        self._side = 0
        self._has_notified = False
        self._station: KeepStation | None = None
        self._retry_s = 0.0

    def update(
        self,
        intent: Intent,
        nav: NavState | None,
        config: BoatConfig,
        perception: ObstaclePerception,
        bounds: Bounds,
        *,
        is_by_hand: bool,
        now_s: float,
    ) -> Intent:
        """The intent to follow; usually the given one."""
        setting = config.avoidance
        is_clear = self.stage is Stage.CLEAR and self._override is None
        is_limited = nav is not None and perception.water.is_limited(nav.point, setting.by_sight, bounds)
        if is_clear and perception.is_empty and not is_limited:
            self.limit.clear()
            return intent
        is_off = not setting.avoids_obstacles or (is_by_hand and not setting.by_hand)
        if nav is None or is_off or isinstance(intent, Stop):
            if self._intent is not None:
                self.reset()
            return intent
        if is_clear and not is_limited and not perception.is_near(nav.point):
            self.limit.clear()
            return intent
        if now_s >= self._due_s or type(intent) is not type(self._intent):
            self._due_s = now_s + PERIOD_S
            if not is_same_goal(intent, self._intent):
                self._forget()
            self._intent = intent
            self._override = self._decide(
                intent, nav, config, perception, bounds, is_by_hand=is_by_hand, now_s=now_s
            )
            held = self._heading_rad
            perception.wished_course_rad = None if self._override is None else held
        return intent if self._override is None else self._override

    def _decide(
        self,
        intent: Intent,
        nav: NavState,
        config: BoatConfig,
        perception: ObstaclePerception,
        bounds: Bounds,
        *,
        is_by_hand: bool,
        now_s: float,
    ) -> Intent | None:
        """The replacement; None keeps the intent."""
        self.eases = False
        here, setting = nav.point, config.avoidance
        sight_m = perception.reach_m or setting.lookahead_m
        margin_m = setting.margin_m + _DRIFT_S * math.hypot(nav.current_north_m_s, nav.current_east_m_s)
        likely = perception.tracks.likely(now_s)
        solid, suspects = (
            _without(cells, likely, setting.margin_m, now_s)
            for cells in (perception.solid(now_s), perception.suspects(now_s))
        )
        if perception.is_looking_again and not solid and not likely and self.stage is Stage.CLEAR:
            suspects = []  # a tenth of a second tells whether the echo is real
        field = self._map(nav, config, bounds, perception.occupancy.cell_m, _SIGHTS * sight_m)
        field.fill(solid, suspects, TOUCH * margin_m)
        self.limit.update(nav, config, perception, field, bounds, now_s)
        if is_by_hand:
            return None
        if not self._crumbs or distance_m(self._crumbs[-1], here) > 0.5 * margin_m:
            self._crumbs.append(here)
        way = way_ahead(intent, nav, config, _SIGHTS * sight_m)
        if self.stage is Stage.BLOCKED and self._is_waiting(way, field, margin_m, now_s) and self._station:
            intent = self._station
            way = way_ahead(intent, nav, config, _SIGHTS * sight_m)
        speed = min(requested_m_s(intent, nav, config), self.limit.sight_m_s)
        is_there = isinstance(intent, KeepStation) and distance_m(here, intent.point) < margin_m
        if (speed <= 0.0 or is_there) and not likely:
            return self._keep()
        free_m = blocked_m(way, field, _BLOCKS * margin_m)
        if not setting.goes_round or isinstance(intent, HoldTurn):
            return self._stop_before(nav, config, free_m)
        may_route = isinstance(intent, FollowLeg | KeepStation | HoldCourse | FollowCircle)
        is_routed = free_m < math.inf and may_route and self.stage is not Stage.BLOCKED
        if not is_routed:
            self._detour.route = None
        else:
            goal = (
                intent.end
                if isinstance(intent, FollowLeg) and distance_m(here, intent.end) > free_m
                else way[-1]
            )
            hull_m, is_certain = HULL * margin_m, bool(solid)
            is_found = self._detour.update(here, goal, field, margin_m, hull_m, now_s, is_certain=is_certain)
            if not is_found or self._detour.length_m > setting.detour_m:
                return self._block(nav, config, field, margin_m, now_s)
            if is_certain and self._detour.length_m > margin_m:  # noise has decayed by then
                perception.water.note_unmapped_obstacle(here)
        length_m = max(speed * HORIZON_S, margin_m)
        target = self._detour.target(here, field, length_m, HULL * margin_m) or places_on(way, length_m, 1)[0]
        # Without an echo left, a new track was refuted
        new = [one for one in perception.unclassified(now_s) if suspects and not one.is_likely_mover]
        movers = predict_movers([*likely, *new], nav, field, setting.margin_m, now_s)
        is_met = any(mover.is_mover for mover in likely)  # a probable mover may be noise
        costs = CostModel(nav, field, movers, margin_m, speed, target, config)
        best = choose(
            nav, config, costs, self._fan, way if self._detour.route is None else None, speed,
            self._heading_rad,
            is_holding=self._override is not None, is_certain=bool(solid) or is_met, has_movers=bool(likely),
        )  # fmt: skip
        if best is None:
            return self._keep()
        if is_met:
            perception.water.note_unmapped_obstacle(here)
        return self._hold(best, nav, config, has_solid=bool(solid), has_movers=bool(likely), is_met=is_met)

    def _hold(
        self,
        best: Rollout,
        nav: NavState,
        config: BoatConfig,
        *,
        has_solid: bool,
        has_movers: bool,
        is_met: bool,
    ) -> Intent:
        """Hold a rollout's heading and speed, and report it."""
        heading, speed = wrap_pi(nav.heading_rad + best.turn_rad), best.speed_m_s
        self._heading_rad = heading
        along_m_s = nav.current_along_m_s(nav.heading_rad)
        self.eases = not has_solid and not is_met  # a single echo may be noise
        if self.stage is not Stage.BLOCKED:
            if CRASH_STOP < speed < 0.0:
                self.stage = Stage.BACK
            elif has_movers:
                self.stage = Stage.PASSING
                if is_met and not self._has_notified:
                    self._has_notified = True
                    self._notify(Severity.INFO, GIVING_WAY)
            elif has_solid:
                self.stage = Stage.ROUND
                self._report_side()
        self.limit.release()
        return crash_stop(nav, config) if speed == CRASH_STOP else HoldHeading(heading, speed + along_m_s)

    def _report_side(self) -> None:
        aside_m = self._detour.aside_m()
        side = (aside_m > 0.0) - (aside_m < 0.0)
        if side not in (0, self._side):
            verb = "changing side" if self._side else "passing"
            self._notify(Severity.INFO, f"Obstacle: {verb} to {'starboard' if side > 0 else 'port'}")
            self._side = side

    def _keep(self) -> Intent | None:
        """The intent as it is; while blocked the station."""
        self._heading_rad = None
        if self.stage is Stage.BLOCKED:
            return self._station
        self.stage, self._side, self._has_notified = Stage.CLEAR, 0, False
        return None

    def _map(
        self, nav: NavState, config: BoatConfig, bounds: Bounds, cell_m: float, reach_m: float
    ) -> ClearanceField:
        """The grid around the boat, with the fence in it. Nearer to the fence than its margin, the boat keeps
        what is left.
        """
        field, here, fence_m = self._field, nav.point, -1.0
        if bounds.is_active and bounds.is_near(here, 2.0 * reach_m):
            least_m = config.fence.margin_m
            room_m = bounds.margin_within_m(*here, least_m + cell_m)
            fence_m = least_m if room_m > least_m else _FENCE_STEP_M * math.floor(room_m / _FENCE_STEP_M)
        key = (bounds.version, cell_m, reach_m, fence_m)
        is_off = field is None or distance_m(field.centre, here) > _MOVES * reach_m
        if field is None or is_off or key != self._field_key:
            field = self._field = ClearanceField(here, cell_m, reach_m)
            self._field_key = key
            if fence_m >= 0.0:
                field.fence(bounds, fence_m)
        return field

    def _is_waiting(self, way: list[Point], field: ClearanceField, margin_m: float, now_s: float) -> bool:
        """Whether to keep station on: until the path is free or the next attempt is due."""
        is_open = blocked_m(way, field, margin_m) == math.inf
        if not is_open and now_s < self._retry_s:
            return True
        self._notify(Severity.INFO, "Obstacle: path is free" if is_open else "Obstacle: trying again")
        self._forget()
        return False

    def _block(
        self, nav: NavState, config: BoatConfig, field: ClearanceField, margin_m: float, now_s: float
    ) -> Intent:
        """There is no way around: keep station where there was room, and try again later."""
        places = (crumb for crumb in reversed(self._crumbs) if field.distance_m(*crumb) > margin_m)
        self._retry_s = now_s + config.avoidance.retry_s
        return self._stay(next(places, nav.point), NO_WAY)

    def _stop_before(self, nav: NavState, config: BoatConfig, free_m: float) -> Intent | None:
        """Detours are disabled: stop, and keep station until the path is free."""
        if self.stage is Stage.BLOCKED:
            return self._station
        if free_m == math.inf:
            return None
        self.limit.reduce_to(braking_speed_m_s(0.5 * free_m, 0.0, config.guidance))
        if free_m > _HALTS * config.avoidance.margin_m:
            return None
        self._retry_s = math.inf
        return self._stay(nav.point, "Obstacle ahead: keeping station")

    def _stay(self, place: Point, text: str) -> KeepStation:
        self.stage, self._detour.route = Stage.BLOCKED, None
        self._notify(Severity.NOTICE, text)
        self._station = KeepStation(place)
        return self._station

    def _notify(self, severity: int, text: str) -> None:
        self._status_texts.append(StatusText(severity, text))


def _without(cells: list[Point], movers: list[Track], margin_m: float, now_s: float) -> list[Point]:
    """The cells without what movers in view left behind them. Where one is now, its cells stay: it may be the
    side of a rock, which seems to move along with the boat.
    """
    seen = [
        (mover, mover.point(now_s), mover.radius_m + _SPREAD * margin_m)
        for mover in movers
        if mover.is_mover and now_s - mover.seen_s < _IN_VIEW_S
    ]
    return [
        at
        for at in cells
        if not any(one.was_at(at, reach_m) and distance_m(at, now) > reach_m for one, now, reach_m in seen)
    ]
