"""Avoidance: keeps the boat clear of what its look-out has seen, by changing what it is to sail.

It stands between the vehicle, whose intent it takes, and the pilot, to whom it hands on that intent or
another one: a course round something, or a station to wait at. Speed is held to what the boat can stop from
before the thing. Decisions are made a few times a second, about as often as the ranger pings; a tick in open
water costs two comparisons.
"""

import math
from collections.abc import Sequence
from enum import IntEnum
from typing import NamedTuple

from msgspec.structs import replace

from companion.config import BoatConfig
from companion.geo import Point, bearing_rad, distance_m
from companion.guidance.clear_water import Bounds, ClearWater, clear_m
from companion.guidance.detour import PORT, STARBOARD, Detour, choose_side, open_course_rad
from companion.guidance.speed_profile import braking_speed_m_s
from companion.guidance.way_ahead import way_ahead
from companion.sensors.lookout import Lookout
from companion.state import Demand, NavState
from companion.vehicle.intent import (
    Drive,
    FollowCircle,
    FollowLeg,
    HoldCourse,
    HoldHeading,
    HoldTurn,
    Intent,
    KeepStation,
    Stop,
)
from companion.vehicle.notice import Notice, Severity

PERIOD_S = 0.12  # between decisions
_WIDER = 1.25  # a detour keeps this times the margin, so that its end is no new beginning
_FREE = 1.1  # and ends where the way keeps this
_HULL = 0.6  # of the margin: nearer than this ahead the boat stops
_BACKS_S = 4.0  # longest time astern
_MEMORIES = 3.0  # of the sight: how far ahead the way must be open before a detour ends
_FAR_M = 1000.0  # where a course leads to
_LOOK_S = 0.8  # until the sweep comes by again
_HEARD_S = 2.0  # a ranger that is silent for so long sees nothing
_MOST_HITS = 8
_HALTS = 0.25  # margins from the distance to keep, the boat has stopped
_SAME_PLACE = 4.0  # margins: a new beginning so near an old one is of the same thing
_GAIN = 0.3  # of the margin: as much nearer to the goal counts as progress


class Stage(IntEnum):
    """What avoidance is doing."""

    CLEAR = 0
    ROUND = 1  # sails round something
    BACK = 2  # goes astern from it
    BLOCKED = 3  # keeps station: there is no way round, or it is not to look for one
    WAIT = 4  # lets something pass


class _Hit(NamedTuple):
    """Where a detour began, on which side, and how far from its goal."""

    place: Point
    side: int
    to_goal_m: float


class Avoidance:
    """stage says what it does; limit_m_s is how fast the boat may go; what there is to say goes to
    `notices`.
    """

    __slots__ = (
        "_back_s",
        "_detour",
        "_due_s",
        "_given",
        "_hits",
        "_instead",
        "_notices",
        "_retry_s",
        "limit_m_s",
        "stage",
    )

    def __init__(self, notices: list[Notice]) -> None:
        self.stage = Stage.CLEAR
        self.limit_m_s = math.inf
        self._notices = notices
        self._detour: Detour | None = None
        self._hits: list[_Hit] = []  # of this goal
        self._given: Intent | None = None
        self._instead: Intent | None = None
        self._due_s = 0.0
        self._back_s = 0.0
        self._retry_s = 0.0

    def reset(self) -> None:
        """Forget what it was doing."""
        self.stage, self.limit_m_s = Stage.CLEAR, math.inf
        self._detour = self._given = self._instead = None
        self._hits.clear()

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
            self.limit_m_s = math.inf
            return intent
        if nav is None or not setting.is_looking_out or is_by_hand or isinstance(intent, Stop | Drive):
            if self._given is not None:
                self.reset()
            return intent
        if now_s >= self._due_s or type(intent) is not type(self._given):
            self._due_s = now_s + PERIOD_S
            if not _is_same_goal(intent, self._given):
                self._hits.clear()
                self._detour, self.stage = None, Stage.CLEAR
            self._given = intent
            self._instead = self._decide(intent, nav, config, lookout, bounds, now_s)
        return intent if self._instead is None else self._instead

    def limited(self, steered: Demand | Drive | Stop) -> Demand | Drive | Stop:
        """The demand, no faster than the boat may go."""
        if isinstance(steered, Demand) and steered.speed_m_s > self.limit_m_s:
            return replace(steered, speed_m_s=self.limit_m_s)
        return steered

    # How

    def _decide(
        self,
        intent: Intent,
        nav: NavState,
        config: BoatConfig,
        lookout: Lookout,
        bounds: Bounds,
        now_s: float,
    ) -> Intent | None:
        """What to sail instead of an intent, None for nothing else."""
        setting, guidance = config.avoidance, config.guidance
        margin_m, sight_m = setting.margin_m, lookout.reach_m or setting.lookahead_m
        self.limit_m_s = self._sighted_m_s(config, lookout, now_s)
        solid, suspects = lookout.solid(now_s), lookout.suspects(now_s)
        way = way_ahead(intent, nav, config, sight_m)
        free_m = clear_m(way, solid, margin_m, sight_m)
        if self.stage is not Stage.CLEAR:
            return self._go_on(intent, nav, config, solid, way, bounds, sight_m, now_s)
        slow_m = min(
            clear_m(way, suspects, margin_m, sight_m), self._motion_m(nav, suspects, config, sight_m)
        )
        if slow_m < math.inf:
            allowed = braking_speed_m_s(slow_m, 0.0, guidance)
            self.limit_m_s = min(self.limit_m_s, max(allowed, guidance.min_speed_m_s))
        if free_m == math.inf:
            return None
        if not setting.goes_round or isinstance(intent, HoldTurn):
            return self._halt(nav, config, free_m)
        return self._begin(intent, nav, config, solid, bounds, sight_m, now_s)

    def _begin(
        self,
        intent: Intent,
        nav: NavState,
        config: BoatConfig,
        solid: Sequence[Point],
        bounds: Bounds,
        sight_m: float,
        now_s: float,
    ) -> Intent | None:
        """The way is shut: choose a side to pass on."""
        here, margin_m = nav.point, config.avoidance.margin_m
        goal = _goal(intent, nav, config, sight_m)
        water = _open_water(here, solid, config, sight_m, bounds)
        chosen = self._choose(water, here, goal, sight_m, margin_m)
        if chosen is None:
            return self._give_up(nav, config, solid, now_s)
        side, course = chosen
        del self._hits[: -(_MOST_HITS - 1)]
        self._hits.append(_Hit(here, side, distance_m(here, goal)))
        self._detour = Detour(here, goal, side, course)
        self.stage = Stage.ROUND
        self._tell(Severity.INFO, f"Obstacle: going round to {'starboard' if side == STARBOARD else 'port'}")
        return self._sail_round(intent, nav, config, solid, sight_m, now_s)

    def _choose(
        self, water: ClearWater, here: Point, goal: Point, sight_m: float, margin_m: float
    ) -> tuple[int, float] | None:
        """Side and course. A side that has brought the boat nearer is kept, one that has not is given up."""
        to_goal_m = distance_m(here, goal)
        near = [hit for hit in self._hits if distance_m(hit.place, here) < _SAME_PLACE * margin_m]
        wanted = bearing_rad(here, goal)
        if not near:
            return choose_side(water, wanted, sight_m)
        tried = {hit.side for hit in near if hit.to_goal_m - to_goal_m < _GAIN * margin_m}
        for side in (near[-1].side, -near[-1].side):
            if side not in tried:
                course = open_course_rad(water, wanted, side, sight_m)
                if course is not None:
                    return side, course
        return None

    def _go_on(
        self,
        intent: Intent,
        nav: NavState,
        config: BoatConfig,
        solid: Sequence[Point],
        way: Sequence[Point],
        bounds: Bounds,
        sight_m: float,
        now_s: float,
    ) -> Intent | None:
        """Under way round something, or waiting."""
        here, margin_m, detour = nav.point, config.avoidance.margin_m, self._detour
        horizon_m = _MEMORIES * sight_m
        is_open = clear_m(way, solid, _FREE * margin_m, horizon_m) == math.inf
        if self.stage is Stage.BLOCKED or detour is None:
            if is_open or now_s >= self._retry_s:
                self._tell(Severity.INFO, "Obstacle: the way is open" if is_open else "Obstacle: tries again")
                self.reset()
                return None
            self.limit_m_s = min(self.limit_m_s, config.guidance.min_speed_m_s)
            return self._instead
        detour.advance(here, margin_m)
        if is_open and detour.has_gained(here, min(horizon_m, distance_m(here, detour.goal))):
            self.stage, self._detour = Stage.CLEAR, None
            return None
        if detour.length_m > config.avoidance.detour_m or detour.is_round(here, 2.0 * margin_m):
            return self._give_up(nav, config, solid, now_s)
        water = _open_water(here, solid, config, sight_m, bounds)
        if not detour.steer(here, solid, water, sight_m):
            return self._turn_back(intent, nav, config, solid, water, sight_m, now_s)
        return self._sail_round(intent, nav, config, solid, sight_m, now_s)

    def _turn_back(
        self,
        intent: Intent,
        nav: NavState,
        config: BoatConfig,
        solid: Sequence[Point],
        water: ClearWater,
        sight_m: float,
        now_s: float,
    ) -> Intent | None:
        """This side has come to an end: the other one, if it was not tried yet."""
        detour = self._detour
        assert detour is not None  # noqa: S101  only called on a detour
        side = -detour.side
        if any(hit.side == side for hit in self._hits):
            return self._give_up(nav, config, solid, now_s)
        detour.side = side
        detour.course_rad = math.remainder(detour.course_rad + math.pi, math.tau)
        self._hits.append(_Hit(nav.point, side, distance_m(nav.point, detour.goal)))
        if not detour.steer(nav.point, solid, water, sight_m):
            return self._give_up(nav, config, solid, now_s)
        self._tell(Severity.INFO, f"Obstacle: turns to {'port' if side == PORT else 'starboard'}")
        return self._sail_round(intent, nav, config, solid, sight_m, now_s)

    def _sail_round(
        self,
        intent: Intent,
        nav: NavState,
        config: BoatConfig,
        solid: Sequence[Point],
        sight_m: float,
        now_s: float,
    ) -> Intent:
        """The detour's course, or astern where something is right ahead."""
        detour, guidance, margin_m = self._detour, config.guidance, config.avoidance.margin_m
        assert detour is not None  # noqa: S101  only called on a detour
        ahead_m = _ahead_m(nav, solid, margin_m)
        if self.stage is Stage.BACK and ahead_m < margin_m and now_s < self._back_s:
            return HoldHeading(nav.heading_rad, -guidance.min_speed_m_s)
        if ahead_m < _HULL * margin_m and self.stage is Stage.ROUND:
            self.stage, self._back_s = Stage.BACK, now_s + _BACKS_S
            return HoldHeading(nav.heading_rad, -guidance.min_speed_m_s)
        self.stage = Stage.ROUND
        turning_m_s = math.sqrt(2.0 * guidance.corner_accel_m_s2 * margin_m)
        room_m = self._motion_m(nav, solid, config, sight_m)
        allowed = min(
            turning_m_s, braking_speed_m_s(room_m, 0.0, guidance) if room_m < math.inf else math.inf
        )
        self.limit_m_s = min(self.limit_m_s, allowed)
        return HoldCourse(detour.course_rad, min(_speed_m_s(intent, config), turning_m_s))

    def _give_up(
        self, nav: NavState, config: BoatConfig, solid: Sequence[Point], now_s: float
    ) -> KeepStation:
        """No way round: keep station clear of it, tell, and try again later."""
        self.stage, self._detour = Stage.BLOCKED, None
        self._retry_s = now_s + config.avoidance.retry_s
        self._tell(Severity.NOTICE, "Obstacle: no way round, keeping station")
        return KeepStation(_clear_of(nav.point, solid, config.avoidance.margin_m))

    def _halt(self, nav: NavState, config: BoatConfig, free_m: float) -> Intent | None:
        """Not to go round: brake, and keep station before it until the way is open."""
        self.limit_m_s = min(self.limit_m_s, braking_speed_m_s(free_m, 0.0, config.guidance))
        if free_m > _HALTS * config.avoidance.margin_m:
            return None
        self.stage, self._retry_s = Stage.BLOCKED, math.inf
        self._tell(Severity.NOTICE, "Obstacle ahead: keeping station before it")
        return KeepStation(nav.point)

    @staticmethod
    def _motion_m(nav: NavState, things: Sequence[Point], config: BoatConfig, sight_m: float) -> float:
        """How far the boat could go on as it goes now."""
        speed = math.hypot(nav.north_m_s, nav.east_m_s)
        if speed < 0.25 * config.guidance.min_speed_m_s:
            return math.inf
        here, reach = nav.point, sight_m / speed
        on = Point(here.north_m + nav.north_m_s * reach, here.east_m + nav.east_m_s * reach)
        return clear_m([here, on], things, _HULL * config.avoidance.margin_m, sight_m)

    @staticmethod
    def _sighted_m_s(config: BoatConfig, lookout: Lookout, now_s: float) -> float:
        """The speed from which the boat stops in the water that it sees, if it is to keep to that.

        v² = 2 a (d − v t), with the time t until the sweep comes by and the throttle answers.
        """
        setting, accel = config.avoidance, config.guidance.accel_m_s2
        if not setting.by_sight:
            return math.inf
        seen_m = lookout.reach_m if now_s - lookout.heard_s <= _HEARD_S else 0.0
        room_m = max(seen_m - setting.margin_m, 0.0)
        delayed = accel * (1.0 + _LOOK_S)
        allowed = math.sqrt(delayed * delayed + 2.0 * accel * room_m) - delayed
        return max(allowed, config.guidance.min_speed_m_s)

    def _tell(self, severity: int, text: str) -> None:
        self._notices.append(Notice(severity, text))


def _open_water(
    here: Point, solid: Sequence[Point], config: BoatConfig, sight_m: float, bounds: Bounds
) -> ClearWater:
    """The courses open to a detour."""
    water = ClearWater(here, solid, _WIDER * config.avoidance.margin_m, sight_m)
    water.keep_within(bounds, config.fence.margin_m)
    return water


def _is_same_goal(intent: Intent, last: Intent | None) -> bool:
    """Whether what was learned on the way still holds."""
    if isinstance(intent, FollowLeg) and isinstance(last, FollowLeg):
        return intent.end == last.end
    if isinstance(intent, KeepStation) and isinstance(last, KeepStation):
        return intent.point == last.point
    return type(intent) is type(last)


def _goal(intent: Intent, nav: NavState, config: BoatConfig, sight_m: float) -> Point:
    """Where the boat wants to get to."""
    if isinstance(intent, FollowLeg):
        return intent.end
    way = way_ahead(intent, nav, config, _FAR_M if isinstance(intent, HoldCourse | HoldHeading) else sight_m)
    return way[-1]


def _speed_m_s(intent: Intent, config: BoatConfig) -> float:
    if isinstance(intent, FollowLeg | FollowCircle | HoldCourse | HoldHeading):
        return abs(intent.speed_m_s)
    return config.speed.cruise_m_s


def _ahead_m(nav: NavState, things: Sequence[Point], reach_m: float) -> float:
    """The nearest thing within 45° of the bow; reach_m for none so near."""
    nearest, ahead_n, ahead_e = reach_m, math.cos(nav.heading_rad), math.sin(nav.heading_rad)
    for thing in things:
        north, east = thing.north_m - nav.north_m, thing.east_m - nav.east_m
        distance = math.sqrt(north * north + east * east)
        if distance < nearest and north * ahead_n + east * ahead_e > 0.7 * distance:
            nearest = distance
    return nearest


def _clear_of(here: Point, things: Sequence[Point], clearance_m: float) -> Point:
    """The boat's own place, moved away from what is nearer than the clearance."""
    nearest = min(things, key=lambda thing: distance_m(here, thing), default=None)
    if nearest is None:
        return here
    gap = distance_m(here, nearest)
    if gap >= clearance_m or gap <= 0.0:
        return here
    share = (clearance_m - gap) / gap
    return Point(
        here.north_m + share * (here.north_m - nearest.north_m),
        here.east_m + share * (here.east_m - nearest.east_m),
    )
