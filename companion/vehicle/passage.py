"""The way to the nearest of some goals, planned anew where something bars it.

A dead end is a way that the boat has turned back on, or could not sail on. It is shut from then on, until
there is no other way, whatever echoes come or go there: the learning of LRTA* (R. E. Korf, *Real-time
heuristic search*, Artificial Intelligence 42, 1990).
"""

import math
from collections.abc import Generator, Sequence

from companion.config.boat_config import BoatConfig
from companion.core.geo import Line, Point, bearing_rad, distance_m
from companion.core.state import NavState
from companion.geofence.water_route import LEAST_SEEN, MARGIN_SHARES, WaterRoute, Way
from companion.guidance.leg import Leg
from companion.obstacles.perception.voyage_map import Stretch
from companion.vehicle.surroundings import Surroundings

CHECK_S = 1.0  # how often the way ahead is checked
_LOOKS_M = 6.0  # to what was seen; the boat stops from its cruise within 5 m
_LONGER = 2.0  # sights, than the way before: along a shore the way grows by what was just seen
_TRIES = 2.0  # attempts of the local planner at one place
_BEND_M = 0.1  # rounding of a bend round what was seen
_ROOM, _CLOSE = 1.2, 0.8  # margins to what was seen: there is room, and there is none


def _is_off(leg: Leg, here: Point, config: BoatConfig) -> bool:
    """Whether the boat gave way to something, and its leg no longer leads from where it is."""
    along_m, cross_m = Line(leg.start, leg.end).along_and_cross_track_m(here)
    to_end_m = distance_m(leg.start, leg.end) - along_m
    return abs(cross_m) > config.guidance.lookahead_m or to_end_m < -config.guidance.waypoint_radius_m


class Passage:
    """The way to the nearest of some goals, and what the boat does of it. way: None while it is not known.

    has_failed: there is none. is_shut: none is clear of what was seen. leads_back: where something barred it,
    it may lead back along the track.
    """

    def __init__(self, surroundings: Surroundings) -> None:
        self._surroundings = surroundings
        self.leads_back = True
        self.restart()

    def restart(self) -> None:
        """Start from wherever the boat is."""
        self._check_s = -math.inf
        self._roomy: Point | None = None  # the latest place with room
        self._dead_ends: list[Stretch] = []
        self._anchored_s = self._updated_s = 0.0  # when it came there; when it was last asked
        self.aim_anew()

    def aim_anew(self) -> None:
        """There is another goal. However often there is, nothing is searched more often than before."""
        self.way: WaterRoute | None = None
        self.has_failed = self.is_shut = False
        self._search: Generator[None, None, WaterRoute | None] | None = None
        self._version = -1
        self._anchor: Point | None = None  # where the boat was when it had last sailed on
        self._is_wary = False  # something barred a way: the fence does not tell all
        self._direct: Leg | None = None

    def sail_straight(self, here: Point, goal: Point, config: BoatConfig) -> None:
        """Sail straight to a goal, until something seen bars the way."""
        self.aim_anew()
        self._go_straight(here, goal, config)

    def left_m(self, here: Point) -> float | None:
        """Length of the rest of the way; None while it is not known."""
        return None if self.way is None else self.way.left_m(here)

    def leg(self, nav: NavState, goals: Sequence[Point], config: BoatConfig, now_s: float) -> Leg | None:
        """What to sail: straight to the first goal while no way is known. None once the end is reached."""
        self.update(nav, goals, config, now_s)
        if self.way is not None:
            return None if self.way.advance(nav, config) else self.way.leg
        self._direct = self._direct or Leg(nav.point, goals[0])
        return None if self._direct.has_ended(nav, config.guidance.waypoint_radius_m) else self._direct

    def update(self, nav: NavState, goals: Sequence[Point], config: BoatConfig, now_s: float) -> None:
        """Check the way from time to time, and search another where it is barred.

        A boat that comes upon something brakes first: another way would have it turn instead.
        """
        here = nav.point
        if not self._surroundings.voyage.is_near(here, _ROOM * config.avoidance.margin_m):
            self._roomy = here
        anchor, was_away = self._anchor, now_s > self._updated_s + 2.0 * CHECK_S  # something else steered
        if anchor is None or was_away or distance_m(here, anchor) > config.avoidance.lookahead_m:
            self._anchor, self._anchored_s = here, now_s
        self._updated_s = now_s
        if now_s >= self._check_s and self._search is None:
            self._check_s = now_s + CHECK_S
            if self.way is None or self._has_ended(self.way, nav, config, now_s):
                self._begin(here, goals, config)
        if self._search is not None:
            try:
                next(self._search)
            except StopIteration as end:
                self._search = None
                self._take(end.value, here, config)

    def _has_ended(self, way: WaterRoute, nav: NavState, config: BoatConfig, now_s: float) -> bool:
        """Whether another way is to be searched now."""
        here, margin_m = nav.point, config.avoidance.margin_m
        if self._is_over_the_fence(here, way.leg.end):
            self.way = None
            return True
        if self._is_barred(way, here, margin_m):
            self._is_wary = self._surroundings.voyage.has_barred_a_way = True
            if self._comes_upon_something(nav, config):
                self._check_s = now_s
                return False
            return True
        if self._is_wary and _is_off(way.leg, here, config):
            return True
        is_held = now_s - self._anchored_s > _TRIES * config.avoidance.retry_s
        return is_held and self._shut(way, config)

    def _take(self, found: WaterRoute | None, here: Point, config: BoatConfig) -> None:
        """The search has ended."""
        longer_m = _LONGER * config.avoidance.lookahead_m
        if self.way and found and found.left_m(here) > self.way.left_m(here) + longer_m:
            self._shut(self.way, config)  # it turns back
        self.way = found or self.way
        ignores_seen = self.way is not None and self.way.seen_m == math.inf
        self.is_shut = ignores_seen and bool(self._surroundings.voyage.stretches())
        self.has_failed = self.way is None and self._surroundings.water is not None

    def _begin(self, here: Point, goals: Sequence[Point], config: BoatConfig) -> None:
        """Without room, the boat goes back to where it last had some: it cannot tell which side is land."""
        surroundings = self._surroundings
        self.is_shut = False
        self._version = surroundings.voyage.version
        goal = surroundings.straight(here, goals, config)
        if goal is not None:
            self._go_straight(here, goal, config)
            return
        is_close = surroundings.voyage.is_near(here, _CLOSE * config.avoidance.margin_m)
        self._search = self._searching(here, goals, config, self._roomy if is_close else None)

    def _searching(
        self, here: Point, goals: Sequence[Point], config: BoatConfig, via: Point | None
    ) -> Generator[None, None, WaterRoute | None]:
        """The search, once more with all dead ends open where they leave no way."""
        while True:
            way = yield from self._surroundings.searching(
                here,
                goals,
                config,
                is_wary=self._is_wary and self.leads_back,
                via=via,
                dead_ends=self._dead_ends,
            )
            if not self._dead_ends or (way is not None and way.seen_m < math.inf):
                return way
            self._dead_ends = []

    def _shut(self, way: WaterRoute, config: BoatConfig) -> bool:
        """Shut the gap that the way leads through next, if what was seen makes it one; whether it does.
        Through one that is wider, a way would have kept more clearance.
        """
        self._anchor = None
        corner, sight_m = way.leg.end, config.avoidance.lookahead_m
        at = self._surroundings.voyage.nearest(corner, sight_m)
        if way.is_last or at is None:
            return False
        bend = [one for one in way.corners_left if distance_m(one, at) < distance_m(corner, at) + _BEND_M]
        reach_m = 2.0 * (way.clearance_m + min(way.seen_m, sight_m))
        self._dead_ends.append((at, at.moved(bearing_rad(at, bend[len(bend) // 2]), reach_m)))
        return True

    def _go_straight(self, here: Point, goal: Point, config: BoatConfig) -> None:
        self.way = WaterRoute(self._surroundings.is_clear, here, Way((goal,), 0.0, 0.0), config)

    def _comes_upon_something(self, nav: NavState, config: BoatConfig) -> bool:
        """Whether the boat approaches what was seen so fast that it can just stop."""
        near = self._surroundings.voyage.nearest(nav.point, _LOOKS_M)
        if near is None:
            return False
        away_m = max(distance_m(nav.point, near), 1e-6)
        north_m, east_m = near.north_m - nav.north_m, near.east_m - nav.east_m
        closing_m_s = (nav.north_m_s * north_m + nav.east_m_s * east_m) / away_m
        room_m = away_m - LEAST_SEEN * config.avoidance.margin_m
        is_fast = closing_m_s**2 > 2.0 * config.guidance.accel_m_s2 * room_m
        return closing_m_s > config.guidance.min_speed_m_s and is_fast

    def _is_over_the_fence(self, here: Point, end: Point) -> bool:
        """Whether the fence now crosses the rest of the leg."""
        fence = self._surroundings.fence
        return fence.is_active and not fence.is_outside(here) and fence.crosses(here, end)

    def _is_barred(self, way: WaterRoute, here: Point, margin_m: float) -> bool:
        """Whether something was seen on the rest of the way since it was planned."""
        if self._surroundings.voyage.version == self._version:
            return False
        seen_m = min(way.seen_m, MARGIN_SHARES[0] * margin_m)
        return self._surroundings.bars([here, *way.corners_left], way.end, seen_m)
