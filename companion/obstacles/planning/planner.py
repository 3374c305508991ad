"""The local planner: keeps the intent, or replaces it by the heading and speed of the cheapest rollout.

Ten times a second the path of the intent is checked. Where it is clear and leads on, the intent stays, and in
open water a tick costs two comparisons. Otherwise each rollout of the boat's motion (`motion.py`) is rated
(`cost.py`) by what it meets and by the way that is then left around the known obstacles (`cost_to_go.py`),
and the cheapest is held until the next decision. Where no way is left, or the detour becomes too long, the
boat keeps station and tries again later.
"""

import math
from collections.abc import Sequence
from enum import IntEnum
from typing import Final

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point, distance_m
from companion.core.intent import FollowLeg, HoldHeading, HoldTurn, Intent, KeepStation, Stop
from companion.core.state import NavState
from companion.core.status_text import Severity, StatusText
from companion.core.units import wrap_pi
from companion.guidance.leg import passing_m
from companion.guidance.speed_profile import braking_speed_m_s
from companion.obstacles.perception.perception import ObstaclePerception
from companion.obstacles.perception.vessels import Vessel
from companion.obstacles.planning.clearance import ClearanceBounds, ClearanceField
from companion.obstacles.planning.cost import HORIZON_S, HULL, CostModel
from companion.obstacles.planning.cost_to_go import CostToGo
from companion.obstacles.planning.detour import Detour
from companion.obstacles.planning.local_map import LocalMap
from companion.obstacles.planning.motion import CRASH_STOP, STEPS, CourseFan, Rollout
from companion.obstacles.planning.movers import predict, predict_vessels
from companion.obstacles.planning.speed_limit import STILL_SHARE, SpeedLimit, crash_stop
from companion.obstacles.planning.way_ahead import free_m, is_same_goal, places_on, requested_m_s, way_ahead

PERIOD_S: Final = 0.09  # between decisions, at least
GIVING_WAY: Final = "Moving obstacle: giving way"
KEEPING_CLEAR: Final = "Keeping clear of vessel"  # and its name
PASSING: Final = "Obstacle: passing to"
NO_WAY: Final = "Obstacle: no way around, keeping station"
BY_SIGHT: Final = "No fence: sailing by sight. Faster: upload a fence, or set AVOID_SIGHT 2"
_BEYOND_M: Final = 6.0  # the map reaches beyond the sight: a detour
_DRIFT_S: Final = 0.8  # a current carries the boat on for so long before it answers: more margin
_SAME_S: Final = 10.0  # what is in the way again so soon is the same thing: it is told once
_LEADS_ON: Final = 0.5  # of its length: a path that brings the boat nearer to the goal by less is not kept


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
        self.limit = SpeedLimit()
        self._status_texts = status_texts
        self._fan = CourseFan()
        self._map = LocalMap()
        self._detour = Detour()
        self._due_s = 0.0
        self._roomy: Point | None = None  # the latest place with room
        self._has_told_sight = self._has_new_goal = False
        self._told_side, self._round_s = 0, -math.inf  # the side told last, and when it was last held
        self.reset()

    def reset(self) -> None:
        """Forget the present detour and the limits."""
        self._forget()
        self._detour.forget()
        self.limit.clear()
        self._intent: Intent | None = None
        self._override: Intent | None = None
        self.eases = False

    def _forget(self) -> None:
        self.stage = Stage.CLEAR
        self._map.forget()
        self._held: tuple[float, float] | None = None  # heading and speed through the water
        self._met_s = -math.inf  # when something moved in the way
        self._station: KeepStation | None = None
        self._retry_s = 0.0

    def update(
        self,
        intent: Intent,
        nav: NavState | None,
        config: BoatConfig,
        perception: ObstaclePerception,
        bounds: ClearanceBounds,
        *,
        is_by_hand: bool,
        now_s: float,
    ) -> Intent:
        """The intent to follow; usually the given one."""
        setting = config.avoidance
        is_clear = self.stage is Stage.CLEAR and self._override is None
        is_limited = nav is not None and perception.water.is_limited(nav.point, setting.by_sight, bounds)
        is_alone = not (is_limited or perception.vessels)
        if is_clear and perception.is_empty and is_alone:
            self.limit.clear()
            return intent
        is_off = not setting.avoids_obstacles or (is_by_hand and not setting.by_hand)
        if nav is None or is_off or isinstance(intent, Stop):
            if self._intent is not None:
                self.reset()
            return intent
        if is_clear and is_alone and not perception.is_near(nav.point):
            self.limit.clear()
            return intent
        if now_s >= self._due_s or type(intent) is not type(self._intent):
            self._due_s = now_s + PERIOD_S
            if not is_same_goal(intent, self._intent):
                self._forget()
                self._has_new_goal = True
            self._intent = intent
            self.eases = False
            self._override = self._decide(
                intent, nav, config, perception, bounds, is_by_hand=is_by_hand, now_s=now_s
            )
            perception.wished_course_rad = None if self._held is None else self._held[0]
        return intent if self._override is None else self._override

    def _decide(
        self,
        intent: Intent,
        nav: NavState,
        config: BoatConfig,
        perception: ObstaclePerception,
        bounds: ClearanceBounds,
        *,
        is_by_hand: bool,
        now_s: float,
    ) -> Intent | None:
        """The replacement; None keeps the intent."""
        here, setting = nav.point, config.avoidance
        reach_m = (perception.reach_m or setting.lookahead_m) + _BEYOND_M
        margin_m = setting.margin_m + _DRIFT_S * math.hypot(nav.current_north_m_s, nav.current_east_m_s)
        is_certain = bool(perception.solid())
        tracks, still_count = perception.possible_movers(now_s)
        meets_mover = any(track.is_mover for track in tracks)
        field = self._map.update(nav, config, perception, bounds, margin_m, reach_m, now_s)
        self.limit.update(nav, config, perception, field, bounds, now_s)
        if is_by_hand:
            return None
        if field.distance_m(*here) > margin_m:
            self._roomy = here
        way = way_ahead(intent, nav, config, reach_m)
        if not setting.goes_round or isinstance(intent, HoldTurn):
            return self._stop_before(nav, config, free_m(way, field, margin_m))
        if self.stage is Stage.BLOCKED and self._is_waiting(way, field, margin_m, now_s) and self._station:
            intent = self._station
            way = [here, intent.point]
        speed = self._speed_by_sight(requested_m_s(intent, nav, config), here, config, perception, bounds)
        is_there = isinstance(intent, KeepStation) and distance_m(here, intent.point) < margin_m
        if not (tracks or perception.vessels) and (speed <= 0.0 or is_there or not perception.suspects()):
            return self._keep()
        ahead_m = max(speed * HORIZON_S, reach_m - _BEYOND_M)
        goal = _next_goal(intent, here, ahead_m, config) or way[-1]
        to_go = self._map.way_to(
            field, here, goal, setting.margin_m, self._detour, now_s, is_certain=is_certain
        )
        is_too_long = self._detour.is_too_long(
            here, setting.detour_m, config.guidance.min_speed_m_s, now_s, is_certain=is_certain
        )
        if (is_too_long or self._map.is_shut(now_s)) and self.stage is not Stage.BLOCKED:
            self._retry_s = now_s + setting.retry_s
            return self._stay(self._roomy or here, NO_WAY)
        places = places_on(way[: way.index(goal) + 1], ahead_m / STEPS, STEPS)
        norths_m = [at.north_m - here.north_m for at in places]
        easts_m = [at.east_m - here.east_m for at in places]
        meets_m = free_m(way, field, margin_m) if is_certain else math.inf
        is_barred = is_certain and (
            meets_m < math.inf or self._detour.side != 0
        )  # a wall is known or assumed
        leads_on = not is_barred or _leads_on(here, places[-1], to_go)
        wanted_rad = math.atan2(easts_m[-1], norths_m[-1])
        wanted_m_s = speed * math.cos(wanted_rad), speed * math.sin(wanted_rad)
        movers = predict(
            tracks, still_count, nav, wanted_m_s, field, setting.margin_m, HULL * setting.margin_m, now_s
        )
        vessels = predict_vessels(perception.vessels, nav, wanted_m_s, field, setting.vessel_margin_m)
        costs = CostModel(nav, field, to_go, movers, margin_m, ahead_m, wanted_rad, config, vessels)
        if self._has_new_goal:
            self._has_new_goal = False
            self._detour.aim(wanted_rad)
        if meets_m < math.inf:
            at = here.moved(wanted_rad, meets_m + 1.5 * margin_m)
            self._detour.begin(at, wanted_rad, perception.reach_m, now_s)
        best = costs.choose(
            self._fan, speed, (norths_m, easts_m) if leads_on else None, self._held,
            is_certain=is_certain or meets_mover or bool(perception.vessels),
            is_new=self._detour.is_new(now_s) and not meets_mover,
        )  # fmt: skip
        if best is None:
            return self._keep()
        if self._detour.update(here, to_go, now_s):
            self._map.search_anew()
            self._tell_side(now_s)
        if meets_mover or (is_certain and not leads_on):
            perception.water.note_unmapped_obstacle(here)
        return self._hold(
            best, nav, config, now_s, perception.vessels, is_certain=is_certain, meets_mover=meets_mover
        )

    def _hold(
        self,
        best: Rollout,
        nav: NavState,
        config: BoatConfig,
        now_s: float,
        vessels: Sequence[Vessel],
        *,
        is_certain: bool,
        meets_mover: bool,
    ) -> Intent:
        """Hold a rollout's heading and speed, and report it."""
        heading, speed = wrap_pi(nav.heading_rad + best.turn_rad), best.speed_m_s
        self._held = heading, speed
        along_m_s = nav.current_along_m_s(nav.heading_rad)
        self.eases = not (is_certain or meets_mover or vessels)  # a single echo may be noise
        if self.stage is not Stage.BLOCKED:
            if CRASH_STOP < speed < 0.0:
                self.stage = Stage.BACK
            elif meets_mover or vessels:
                self.stage = Stage.PASSING
                if now_s > self._met_s + _SAME_S:
                    self._notify(GIVING_WAY if meets_mover else f"{KEEPING_CLEAR} {vessels[0].name}")
                self._met_s = now_s
            elif is_certain:
                self.stage = Stage.ROUND
                if self._detour.side:
                    self._round_s = now_s
        self.limit.release()
        return crash_stop(nav, config) if speed <= CRASH_STOP else HoldHeading(heading, speed + along_m_s)

    def _speed_by_sight(
        self,
        speed_m_s: float,
        here: Point,
        config: BoatConfig,
        perception: ObstaclePerception,
        bounds: ClearanceBounds,
    ) -> float:
        """The speed within the limit; says once that a fence would lift it."""
        is_slow = self.limit.sight_m_s < speed_m_s
        if is_slow and not self._has_told_sight:
            self._has_told_sight = perception.water.is_uncharted(here, config.avoidance.by_sight, bounds)
            if self._has_told_sight:
                self._notify(BY_SIGHT, Severity.NOTICE)
        return min(speed_m_s, self.limit.sight_m_s)

    def _tell_side(self, now_s: float) -> None:
        """Once a thing: what is passed so soon after another one on the same side counts as the same."""
        side = self._detour.side
        if side != self._told_side or now_s > self._round_s + _SAME_S:
            self._notify(f"{PASSING} {'starboard' if side > 0 else 'port'}")
        self._told_side = side

    def _keep(self, *, is_blocked: bool = True) -> Intent | None:
        """The intent as it is; while blocked the station."""
        self._held = None
        if is_blocked and self.stage is Stage.BLOCKED:
            return self._station
        self.stage = Stage.CLEAR
        return None

    def _is_waiting(self, way: list[Point], field: ClearanceField, margin_m: float, now_s: float) -> bool:
        """Whether to keep station on: until the path is free or the next attempt is due."""
        is_open = free_m(way, field, margin_m) == math.inf
        if not is_open and now_s < self._retry_s:
            return True
        self._notify("Obstacle: path is free" if is_open else "Obstacle: trying again")
        self._forget()
        self._detour.forget()
        return False

    def _stop_before(self, nav: NavState, config: BoatConfig, room_m: float) -> Intent | None:
        """Detours are disabled: stop, and keep station until the path is free."""
        if room_m == math.inf:
            return self._keep(is_blocked=False)
        if self.stage is Stage.BLOCKED:
            return self._station
        self.limit.reduce_to(braking_speed_m_s(0.5 * room_m, 0.0, config.guidance))
        if nav.surge_m_s > STILL_SHARE * config.guidance.min_speed_m_s:
            return None
        return self._stay(self._roomy or nav.point, "Obstacle ahead: keeping station")

    def _stay(self, place: Point, text: str) -> KeepStation:
        self.stage = Stage.BLOCKED
        self._detour.forget()
        self._map.forget()
        self._notify(text, Severity.NOTICE)
        self._station = KeepStation(place)
        return self._station

    def _notify(self, text: str, severity: int = Severity.INFO) -> None:
        self._status_texts.append(StatusText(severity, text))


def _next_goal(intent: Intent, here: Point, ahead_m: float, config: BoatConfig) -> Point | None:
    """The end of a leg until the boat is near enough to pass it; None: the end of its way."""
    if not isinstance(intent, FollowLeg):
        return None
    passes_m = passing_m(intent.line, intent.next_line, intent.radius_m or config.guidance.waypoint_radius_m)
    return intent.end if distance_m(here, intent.end) > min(ahead_m, passes_m) else None


def _leads_on(here: Point, end: Point, to_go: CostToGo) -> bool:
    """Whether a path brings the boat nearer to the goal."""
    return to_go.at(*here) - to_go.at(*end) >= _LEADS_ON * distance_m(here, end) - to_go.side_m
