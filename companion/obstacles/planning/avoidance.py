"""Obstacle avoidance: replaces the intent with one that keeps clear of perceived obstacles.

It takes the vehicle's intent and gives the pilot that intent, a course around an obstacle, or a station to
wait at. The speed is limited so that the boat can stop before the obstacle. Decisions are made a few times a
second, about as often as the sonar pings; in open water a tick costs two comparisons.
"""

import math
from enum import IntEnum

from companion.config.boat_config import BoatConfig
from companion.core.intent import (
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
from companion.obstacles.perception.looked_at import allowed_speed_m_s
from companion.obstacles.perception.perception import ObstaclePerception
from companion.obstacles.planning.detour import STARBOARD, Detour
from companion.obstacles.planning.detour_history import Breadcrumbs, DetourHistory
from companion.obstacles.planning.free_space import ChartedBounds
from companion.obstacles.planning.moving_obstacles import EvasiveManeuver, choose_maneuver
from companion.obstacles.planning.safe_speed import SafeSpeed, crash_stop
from companion.obstacles.planning.scene import HULL, Scene

PERIOD_S = 0.09  # between decisions, at least
GIVING_WAY = "Moving obstacle: giving way"
NO_WAY = "Obstacle: no way around, keeping station"
_FREE = 1.1  # times the margin that must be free for a detour to end
_MEMORIES = 3.0  # of the sight: how far ahead that is checked,
_LEAVES = 1.0  # and how many sights must be free
_BACKS_S = 4.0  # longest time astern
_PUZZLES = 1.0  # margins of room: beyond this, no side is chosen for an unclassified obstacle
_CRASH_STOP = 0.4  # of the slowest speed with steerage way: above it the boat stops with full reverse
_ASIDE_M_S2 = 0.5  # lateral acceleration of a turn onto a detour within the margin
_HALTS = 0.25  # margins


class Stage(IntEnum):
    """What avoidance is doing."""

    CLEAR = 0
    ROUND = 1  # on a detour
    BACK = 2  # backing off
    BLOCKED = 3  # keeping station: there is no way around, or none is allowed
    PASSING = 4  # avoiding a moving obstacle


class Avoidance:
    """stage: present action; safe_speed: the speed limits. Messages are appended to `status_texts`."""

    def __init__(self, status_texts: list[StatusText]) -> None:
        self.stage = Stage.CLEAR
        self.safe_speed = SafeSpeed()
        self._status_texts = status_texts
        self._detour: Detour | None = None
        self._history = DetourHistory()
        self._breadcrumbs = Breadcrumbs()
        self._last_intent: Intent | None = None
        self._override: Intent | None = None
        self._due_s = 0.0
        self._maneuver: EvasiveManeuver | None = None
        self._has_notified = False
        self._back_s = 0.0
        self._retry_s = 0.0
        self._station: KeepStation | None = None  # while blocked

    def reset(self) -> None:
        """Forget the present detour."""
        self.stage = Stage.CLEAR
        self.safe_speed.clear()
        self._detour = self._last_intent = self._override = self._maneuver = None
        self._history.forget()

    def update(
        self,
        intent: Intent,
        nav: NavState | None,
        config: BoatConfig,
        perception: ObstaclePerception,
        bounds: ChartedBounds,
        *,
        is_by_hand: bool,
        now_s: float,
    ) -> Intent:
        """The intent to follow; usually the given one."""
        setting = config.avoidance
        is_limited = nav is not None and perception.water.is_limited(nav.point, setting.by_sight, bounds)
        if perception.is_empty and self.stage is Stage.CLEAR and not is_limited:
            self.safe_speed.clear()
            return intent
        is_off = not setting.avoids_obstacles or (is_by_hand and not setting.by_hand)
        if nav is None or is_off or isinstance(intent, Stop):
            if self._last_intent is not None:
                self.reset()
            return intent
        is_far = self.stage is Stage.CLEAR and not perception.is_near(nav.point)
        if is_far and not is_limited:
            self.safe_speed.clear()
            return intent
        if now_s >= self._due_s or type(intent) is not type(self._last_intent):
            self._due_s = now_s + PERIOD_S
            if not _is_same_goal(intent, self._last_intent):
                self._history.forget()
                self._detour, self.stage = None, Stage.CLEAR
            self._last_intent = intent
            scene = Scene(intent, nav, config, perception, bounds, now_s)
            self.safe_speed.update(scene, perception)
            perception.wished_course_rad = scene.desired_course_and_speed(self._override)[0]
            self._override = (
                None if is_by_hand else self._avoid_movers(scene, perception, self._decide(scene))
            )
        return intent if self._override is None else self._override

    def _decide(self, scene: Scene) -> Intent | None:
        """The replacement intent for static obstacles; None: keep the intent."""
        self._breadcrumbs.add(scene.here, scene.margin_m)
        if self.stage is Stage.BLOCKED:
            return self._wait(scene)
        if self._detour is not None:
            return self._continue_detour(scene, self._detour)
        guidance = scene.config.guidance
        slow_m = scene.clear_path_m(scene.obstacles)
        if slow_m < math.inf:
            allowed = scene.stopping_speed_m_s(slow_m)
            self.safe_speed.reduce_to(max(allowed, guidance.min_speed_m_s))
        free_m = scene.clear_path_m(scene.solid)
        if free_m == math.inf:
            is_shut_in = scene.room_ahead_m() < math.inf
            return (
                scene.stop()
                if is_shut_in and scene.must_stop_to_turn(scene.desired_course_and_speed(None)[0])
                else None
            )
        if not scene.config.avoidance.goes_round or isinstance(scene.intent, HoldTurn):
            return self._stop_before(scene, free_m)
        if scene.has_unclassified and free_m > _PUZZLES * scene.margin_m:
            self.safe_speed.reduce_to(guidance.min_speed_m_s)
            return None
        return self._start_detour(scene)

    def _avoid_movers(
        self, scene: Scene, perception: ObstaclePerception, instead: Intent | None
    ) -> Intent | None:
        """The replacement intent for moving obstacles."""
        if scene.movers:
            course, speed = scene.desired_course_and_speed(instead)
            speed = min(
                speed,
                allowed_speed_m_s(scene.nav, scene.config, perception.water, scene.bounds, scene.now_s),
            )
            self._maneuver = choose_maneuver(scene, course, speed, self._maneuver)
        else:
            self._maneuver = None
        if self._maneuver is None:
            if self.stage is Stage.PASSING:
                self.stage = Stage.CLEAR
            return instead
        if self.stage is Stage.CLEAR:
            self.stage = Stage.PASSING
            self._has_notified = False
        if any(mover.is_mover for mover in scene.movers):  # a probable mover may be noise
            scene.water_known.note_unmapped_obstacle(scene.here)
            if not self._has_notified:
                self._has_notified = True
                self._notify(Severity.INFO, GIVING_WAY)
        turn, speed = self._maneuver
        if speed > 0.0:
            self.safe_speed.raise_to(speed)
            return HoldCourse(wrap_pi(course + turn), speed)
        if scene.nav.surge_m_s > _CRASH_STOP * scene.config.guidance.min_speed_m_s:
            return crash_stop(scene.nav, scene.config)
        return HoldHeading(scene.nav.heading_rad, speed) if speed < 0.0 else scene.stop()

    def _start_detour(self, scene: Scene) -> Intent | None:
        """The path is blocked: choose a side."""
        previous_side = self._history.last_side
        detour = self._history.start_detour(
            scene.here, scene.goal(), scene.water, scene.sight_m, scene.margin_m
        )
        if detour is None:
            return self._block(scene)
        if detour.side != previous_side:
            self._notify(Severity.INFO, f"Obstacle: passing to {_name(detour.side)}")
        self._detour, self.stage = detour, Stage.ROUND
        return self._steer_detour(scene, detour)

    def _continue_detour(self, scene: Scene, detour: Detour) -> Intent | None:
        """Follow the detour, end it, reverse it or give it up."""
        here, margin_m, setting = scene.here, scene.margin_m, scene.config.avoidance
        detour.advance(here, margin_m)
        if scene.solid and detour.length_m > margin_m:  # noise has decayed by then
            scene.water_known.note_unmapped_obstacle(here)
        free_m = scene.clear_path_m(scene.obstacles, _FREE, _MEMORIES)
        if free_m > _LEAVES * scene.sight_m and detour.has_progressed(here, free_m, margin_m):
            if scene.must_stop_to_turn(scene.desired_course_and_speed(None)[0]):
                return scene.stop()
            self._history.detour_length_m += detour.length_m
            self.stage, self._detour = Stage.CLEAR, None
            return None
        if self._history.detour_length_m + detour.length_m > setting.detour_m or detour.has_returned(
            here, 2.0 * margin_m
        ):
            return self._block(scene)
        if not detour.steer(here, scene.obstacles, scene.water, scene.sight_m):
            if self._history.has_tried(-detour.side):
                return self._block(scene)
            detour.reverse()
            self._history.record(here, detour.side, detour.goal)
            if not detour.steer(here, scene.obstacles, scene.water, scene.sight_m):
                return self._block(scene)
            self._notify(Severity.INFO, f"Obstacle: changing side to {_name(detour.side)}")
        return self._steer_detour(scene, detour)

    def _steer_detour(self, scene: Scene, detour: Detour) -> Intent:
        """The course of the detour; astern with an obstacle close ahead; stopped before a sharp turn."""
        nav, guidance = scene.nav, scene.config.guidance
        ahead_m = scene.nearest_m(nav.heading_rad)
        is_backing = self.stage is Stage.BACK and ahead_m < scene.margin_m and scene.now_s < self._back_s
        if not is_backing and self.stage is Stage.ROUND and ahead_m < HULL * scene.margin_m:
            self._back_s, is_backing = scene.now_s + _BACKS_S, True
        if is_backing and self.safe_speed.astern_m_s > 0.0:
            self.stage = Stage.BACK
            return HoldHeading(nav.heading_rad, -guidance.min_speed_m_s)
        self.stage = Stage.ROUND
        if (away_rad := scene.escape_course_rad()) is not None:
            return HoldCourse(away_rad, guidance.min_speed_m_s)
        speed = min(scene.requested_speed_m_s(), math.sqrt(2.0 * _ASIDE_M_S2 * scene.margin_m))
        if scene.must_stop_to_turn(scene.heading_for_rad(detour.course_rad, speed)):
            return scene.stop()
        return HoldCourse(detour.course_rad, speed)

    def _wait(self, scene: Scene) -> Intent | None:
        """Keep station until the path is free or the next attempt is due."""
        is_open = scene.clear_path_m(scene.obstacles, _FREE, _MEMORIES) == math.inf
        if not is_open and scene.now_s < self._retry_s:
            least_m_s = scene.config.guidance.min_speed_m_s
            self.safe_speed.reduce_to(least_m_s)
            is_going_for_it = scene.speed_m_s > least_m_s and scene.room_ahead_m() < math.inf
            return scene.stop() if is_going_for_it else self._station
        self._notify(Severity.INFO, "Obstacle: path is free" if is_open else "Obstacle: trying again")
        self._history.forget()
        self.stage, self._detour = Stage.CLEAR, None
        return None

    def _block(self, scene: Scene) -> Intent | None:
        """There is no way around: keep station where there was room, and try again later."""
        self.stage, self._detour = Stage.BLOCKED, None
        self._retry_s = scene.now_s + scene.config.avoidance.retry_s
        self._notify(Severity.NOTICE, NO_WAY)
        self._station = KeepStation(
            self._breadcrumbs.last_with_room(scene.here, scene.obstacles, scene.margin_m)
        )
        return self._wait(scene)

    def _stop_before(self, scene: Scene, free_m: float) -> Intent | None:
        """Detours are disabled: stop, and keep station until the path is free."""
        scene.water_known.note_unmapped_obstacle(scene.here)
        self.safe_speed.reduce_to(scene.stopping_speed_m_s(free_m))
        if free_m > _HALTS * scene.margin_m:
            return None
        self.stage, self._retry_s = Stage.BLOCKED, math.inf
        self._notify(Severity.NOTICE, "Obstacle ahead: keeping station")
        self._station = KeepStation(scene.here)
        return self._station

    def _notify(self, severity: int, text: str) -> None:
        self._status_texts.append(StatusText(severity, text))


def _name(side: int) -> str:
    return "starboard" if side == STARBOARD else "port"


def _is_same_goal(intent: Intent, last: Intent | None) -> bool:
    """Whether the detour history still applies."""
    if isinstance(intent, FollowLeg) and isinstance(last, FollowLeg):
        return intent.end == last.end
    if isinstance(intent, KeepStation) and isinstance(last, KeepStation):
        return intent.point == last.point
    return type(intent) is type(last)
