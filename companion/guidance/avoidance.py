"""Avoidance: keeps the boat clear of what its look-out has seen, by changing what it is to sail.

It stands between the vehicle, whose intent it takes, and the pilot, to whom it hands on that intent or
another one: a course round something, or a station to wait at. Speed is held to what the boat can stop from
before the thing. Decisions are made a few times a second, about as often as the ranger pings; a tick in open
water costs two comparisons.
"""

import math
from collections import deque
from enum import IntEnum

from msgspec.structs import replace

from companion.config import BoatConfig
from companion.control.speed import feed_forward
from companion.geo import Point, distance_m
from companion.guidance.clear_water import Bounds
from companion.guidance.detour import STARBOARD, Detour
from companion.guidance.passing import STRAIGHT_ON, choose_passing
from companion.guidance.scene import HULL, Scene
from companion.guidance.tries import Tries
from companion.sensors.lookout import Lookout
from companion.state import Demand, NavState
from companion.units import wrap_pi
from companion.vehicle.intent import (
    Drive,
    FollowLeg,
    HoldCourse,
    HoldHeading,
    HoldTurn,
    Intent,
    KeepStation,
    Stop,
)
from companion.vehicle.notice import Notice, Severity

PERIOD_S = 0.09  # between decisions, at least
_FREE = 1.1  # times the margin must be free on the way for a detour to end
_MEMORIES = 3.0  # of the sight: how far ahead a detour's end is looked for
_LEAVES = 1.0  # sights must be free for that
_BACKS_S = 4.0  # longest time astern
_HALTS = 0.25  # margins from the distance to keep, the boat has stopped
_WAKE_POINTS = 24
_WAKE_STEP = 0.5  # of the margin


class Stage(IntEnum):
    """What avoidance is doing."""

    CLEAR = 0
    ROUND = 1  # sails round something
    BACK = 2  # goes astern from it
    BLOCKED = 3  # keeps station: there is no way round, or it is not to look for one
    PASSING = 4  # turns aside from something that moves, or lets it pass


class Avoidance:
    """stage says what it does; limit_m_s and astern_m_s how fast the boat may go; what there is to say goes
    to `notices`.
    """

    __slots__ = (
        "_back_s",
        "_detour",
        "_due_s",
        "_given",
        "_instead",
        "_notices",
        "_passing",
        "_retry_s",
        "_station",
        "_tries",
        "_wake",
        "astern_m_s",
        "limit_m_s",
        "stage",
    )

    def __init__(self, notices: list[Notice]) -> None:
        self.stage = Stage.CLEAR
        self.limit_m_s = self.astern_m_s = math.inf
        self._notices = notices
        self._detour: Detour | None = None
        self._tries = Tries()
        self._wake: deque[Point] = deque(maxlen=_WAKE_POINTS)  # where the boat has come along
        self._given: Intent | None = None
        self._instead: Intent | None = None
        self._due_s = 0.0
        self._passing = STRAIGHT_ON
        self._back_s = 0.0
        self._retry_s = 0.0
        self._station: KeepStation | None = None  # while it is blocked

    def reset(self) -> None:
        """Forget what it was doing."""
        self.stage, self.limit_m_s, self.astern_m_s = Stage.CLEAR, math.inf, math.inf
        self._detour = self._given = self._instead = None
        self._passing = STRAIGHT_ON
        self._tries.forget()

    def update(
        self,
        intent: Intent,
        nav: NavState | None,
        config: BoatConfig,
        lookout: Lookout,
        bounds: Bounds,
        *,
        is_by_hand: bool,
        now_s: float,
    ) -> Intent:
        """What to sail instead of an intent; most of the time the intent itself."""
        setting = config.avoidance
        if lookout.is_empty and self.stage is Stage.CLEAR and not setting.by_sight:
            self.limit_m_s = self.astern_m_s = math.inf
            return intent
        is_off = not setting.is_looking_out or (is_by_hand and not setting.by_hand)
        if nav is None or is_off or isinstance(intent, Stop):
            if self._given is not None:
                self.reset()
            return intent
        if self.stage is Stage.CLEAR and not setting.by_sight and not lookout.is_near(nav.point):
            self.limit_m_s = self.astern_m_s = math.inf
            return intent
        if now_s >= self._due_s or type(intent) is not type(self._given):
            self._due_s = now_s + PERIOD_S
            if not _is_same_goal(intent, self._given):
                self._tries.forget()
                self._detour, self.stage = None, Stage.CLEAR
            self._given = intent
            scene = Scene(intent, nav, config, lookout, bounds, now_s)
            self._hold_speed(scene, lookout)
            self._instead = None if is_by_hand else self._let_pass(scene, self._decide(scene))
        return intent if self._instead is None else self._instead

    def limited(
        self, steered: Demand | Drive | Stop, nav: NavState | None, config: BoatConfig
    ) -> Demand | Drive | Stop:
        """The same, no faster than the boat may go."""
        if self.limit_m_s == math.inf and self.astern_m_s == math.inf:
            return steered
        if isinstance(steered, Demand):
            speed = max(min(steered.speed_m_s, self.limit_m_s), -self.astern_m_s)
            return steered if speed == steered.speed_m_s else replace(steered, speed_m_s=speed)
        if isinstance(steered, Drive) and nav is not None and steered.throttle > 0.0:
            setting, limit = config.speed, self.limit_m_s
            if limit < math.inf:
                most = feed_forward(limit, setting) + setting.kp * (limit - nav.surge_m_s)
                return Drive(max(min(steered.throttle, most), -1.0), steered.steering)
        return steered

    # How

    def _hold_speed(self, scene: Scene, lookout: Lookout) -> None:
        """How fast the boat may go, whatever it sails: it can stop before what it is going for."""
        heading = scene.nav.heading_rad
        self.limit_m_s = scene.sighted_m_s(lookout)
        room_m = scene.motion_m()
        if room_m < math.inf:
            self.limit_m_s = min(self.limit_m_s, scene.stopping_m_s(room_m))
        ahead_m, astern_m = scene.room_m(heading), scene.room_m(heading + math.pi)
        if ahead_m < math.inf:
            self.limit_m_s = min(self.limit_m_s, scene.stopping_m_s(ahead_m))
        self.astern_m_s = math.inf if astern_m == math.inf else scene.stopping_m_s(astern_m)

    def _decide(self, scene: Scene) -> Intent | None:
        """What to sail instead of an intent, None for nothing else."""
        self._keep_wake(scene)
        if self.stage is Stage.BLOCKED:
            return self._wait(scene)
        if self._detour is not None:
            return self._go_on(scene, self._detour)
        guidance = scene.config.guidance
        slow_m = scene.way_m(scene.things)
        if slow_m < math.inf:
            allowed = scene.stopping_m_s(slow_m)
            self.limit_m_s = min(self.limit_m_s, max(allowed, guidance.min_speed_m_s))
        free_m = scene.way_m(scene.solid)
        if free_m == math.inf:
            is_shut_in = scene.motion_m() < math.inf
            return scene.stop() if is_shut_in and scene.must_stop_to_turn(scene.wanted(None)[0]) else None
        if not scene.config.avoidance.goes_round or isinstance(scene.intent, HoldTurn):
            return self._halt(scene, free_m)
        return self._begin(scene)

    def _let_pass(self, scene: Scene, instead: Intent | None) -> Intent | None:
        """Of what lies still the boat keeps clear already; now what moves."""
        if not scene.movers or self.stage not in (Stage.CLEAR, Stage.PASSING):
            self._passing = STRAIGHT_ON
            if self.stage is Stage.PASSING:
                self.stage = Stage.CLEAR
            return instead
        course, speed = scene.wanted(instead)
        self._passing = choose_passing(scene, course, speed, self._passing)
        turn, pace = self._passing
        if self._passing == STRAIGHT_ON:
            if self.stage is Stage.PASSING:
                self.stage = Stage.CLEAR
            return instead
        if self.stage is Stage.CLEAR:
            self.stage = Stage.PASSING
            self._tell(Severity.INFO, "Obstacle moves: letting it pass")
        if not pace:
            return scene.stop()
        return HoldCourse(wrap_pi(course + turn), pace * speed)

    def _begin(self, scene: Scene) -> Intent | None:
        """The way is shut: choose a side to pass on."""
        told = self._tries.last_side
        detour = self._tries.begin(scene.here, scene.goal(), scene.water, scene.sight_m, scene.margin_m)
        if detour is None:
            return self._give_up(scene)
        if detour.side != told:
            self._tell(Severity.INFO, f"Obstacle: going round to {_name(detour.side)}")
        self._detour, self.stage = detour, Stage.ROUND
        return self._sail_round(scene, detour)

    def _go_on(self, scene: Scene, detour: Detour) -> Intent | None:
        """Under way round something."""
        here, margin_m, setting = scene.here, scene.margin_m, scene.config.avoidance
        detour.advance(here, margin_m)
        free_m = scene.way_m(scene.things, _FREE, _MEMORIES)
        if free_m > _LEAVES * scene.sight_m and detour.has_gained(here, free_m, margin_m):
            if scene.must_stop_to_turn(scene.wanted(None)[0]):
                return scene.stop()
            self._tries.roamed_m += detour.length_m
            self.stage, self._detour = Stage.CLEAR, None
            return None
        if self._tries.roamed_m + detour.length_m > setting.detour_m or detour.is_round(here, 2.0 * margin_m):
            return self._give_up(scene)
        if not detour.steer(here, scene.things, scene.water, scene.sight_m):
            if self._tries.has_taken(-detour.side):
                return self._give_up(scene)
            detour.turn_back()
            self._tries.take(here, detour.side, detour.goal)
            if not detour.steer(here, scene.things, scene.water, scene.sight_m):
                return self._give_up(scene)
            self._tell(Severity.INFO, f"Obstacle: turns to {_name(detour.side)}")
        return self._sail_round(scene, detour)

    def _sail_round(self, scene: Scene, detour: Detour) -> Intent:
        """The detour's course; astern where something is right ahead; stopped before a sharp turn."""
        nav, guidance = scene.nav, scene.config.guidance
        ahead_m = scene.nearest_m(nav.heading_rad)
        is_backing = self.stage is Stage.BACK and ahead_m < scene.margin_m and scene.now_s < self._back_s
        if not is_backing and self.stage is Stage.ROUND and ahead_m < HULL * scene.margin_m:
            self._back_s, is_backing = scene.now_s + _BACKS_S, True
        if is_backing and self.astern_m_s > 0.0:
            self.stage = Stage.BACK
            return HoldHeading(nav.heading_rad, -guidance.min_speed_m_s)
        self.stage = Stage.ROUND
        if (away_rad := scene.away_rad()) is not None:
            return HoldCourse(away_rad, guidance.min_speed_m_s)
        speed = min(scene.asked_m_s(), math.sqrt(2.0 * guidance.corner_accel_m_s2 * scene.margin_m))
        if scene.must_stop_to_turn(scene.heading_for_rad(detour.course_rad, speed)):
            return scene.stop()
        return HoldCourse(detour.course_rad, speed)

    def _wait(self, scene: Scene) -> Intent | None:
        """No way round was found: until the way is open, or it is time for the next try."""
        is_open = scene.way_m(scene.things, _FREE, _MEMORIES) == math.inf
        if not is_open and scene.now_s < self._retry_s:
            least_m_s = scene.config.guidance.min_speed_m_s
            self.limit_m_s = min(self.limit_m_s, least_m_s)
            is_going_for_it = scene.speed_m_s > least_m_s and scene.motion_m() < math.inf
            return scene.stop() if is_going_for_it else self._station
        self._tell(Severity.INFO, "Obstacle: the way is open" if is_open else "Obstacle: tries again")
        self._tries.forget()
        self.stage, self._detour = Stage.CLEAR, None
        return None

    def _give_up(self, scene: Scene) -> Intent | None:
        """No way round: keep station where there was room, tell, and try again later."""
        self.stage, self._detour = Stage.BLOCKED, None
        self._retry_s = scene.now_s + scene.config.avoidance.retry_s
        self._tell(Severity.NOTICE, "Obstacle: no way round, keeping station")
        self._station = KeepStation(self._roomy(scene))
        return self._wait(scene)

    def _halt(self, scene: Scene, free_m: float) -> Intent | None:
        """Not to go round: brake, and keep station before it until the way is open."""
        self.limit_m_s = min(self.limit_m_s, scene.stopping_m_s(free_m))
        if free_m > _HALTS * scene.margin_m:
            return None
        self.stage, self._retry_s = Stage.BLOCKED, math.inf
        self._tell(Severity.NOTICE, "Obstacle ahead: keeping station before it")
        self._station = KeepStation(scene.here)
        return self._station

    def _keep_wake(self, scene: Scene) -> None:
        step_m = _WAKE_STEP * scene.margin_m
        if not self._wake or distance_m(self._wake[-1], scene.here) > step_m:
            self._wake.append(scene.here)

    def _roomy(self, scene: Scene) -> Point:
        """The last place that the boat has been to which has the margin around it."""
        for place in reversed(self._wake):
            if all(distance_m(place, thing) > scene.margin_m for thing in scene.things):
                return place
        return scene.here

    def _tell(self, severity: int, text: str) -> None:
        self._notices.append(Notice(severity, text))


def _name(side: int) -> str:
    return "starboard" if side == STARBOARD else "port"


def _is_same_goal(intent: Intent, last: Intent | None) -> bool:
    """Whether what was learned on the way still holds."""
    if isinstance(intent, FollowLeg) and isinstance(last, FollowLeg):
        return intent.end == last.end
    if isinstance(intent, KeepStation) and isinstance(last, KeepStation):
        return intent.point == last.point
    return type(intent) is type(last)
