"""The water around the boat, by fence and map of the voyage, and ways through it.

A way keeps clear of the fence and of what was seen on this voyage; what was never seen counts as free. Where
something new bars the way, it is planned anew from the boat on: D* without its incremental search (A. Stentz,
*Optimal and efficient path planning for partially-known environments*, ICRA 1994). As what was seen stays in
the map, a side that did not end is not tried again. From then on unseen water costs more than water that the
boat has sailed: the way may lead back along its track.
"""

import math
from collections.abc import Generator, Sequence
from itertools import pairwise

from companion.config.boat_config import BoatConfig
from companion.core.geo import Line, Point, distance_m, path_length_m
from companion.core.state import NavState
from companion.core.steps import finished
from companion.geofence.fence import Fence
from companion.geofence.water_route import (
    LEAST_SEEN,
    MARGIN_SHARES,
    FenceWater,
    Seen,
    WaterRoute,
    Way,
    is_clear,
    searching_way,
)
from companion.guidance.leg import Leg
from companion.obstacles.perception.voyage_map import VoyageMap
from companion.obstacles.planning.cost_to_go import UNSEEN_COST
from companion.vehicle.track import SailedTrack

_CHECK_S = 1.0  # how often the way ahead is checked
_LOOKS_M = 6.0  # to what was seen; the boat stops from its cruise within 5 m
# Of its clearance to what was seen, a leg keeps so much to each cell, as outlines cut corners; with less the
# way is barred
_CLEAR_SHARE, _BARRED_SHARE = 0.75, 0.6
_ROOM, _CLOSE = 1.2, 0.8  # margins to what was seen: there is room, and there is none


class Surroundings:
    """fence: the uploaded areas. voyage: what the boat has seen. track: where it has sailed.

    The fence's shores are indexed when they change, in cycles of their own.
    """

    def __init__(self, fence: Fence, voyage: VoyageMap, track: SailedTrack) -> None:
        self.fence = fence
        self.voyage = voyage
        self.track = track
        self._water: FenceWater | None = None
        self._version = -1

    def prepare(self, margin_m: float) -> None:
        """Index the fence's shores if they have changed. To be called every cycle."""
        if self._water is None or self._version != self.fence.version:
            self._water, self._version = FenceWater(self.fence), self.fence.version
        else:
            self._water.prepare(margin_m)

    @property
    def water(self) -> FenceWater | None:
        """The water inside the fence; None while it is not indexed."""
        return self._water if self._version == self.fence.version else None

    def is_clear(self, start: Point, end: Point, clearance_m: float, seen_m: float) -> bool:
        """Whether a straight leg keeps these clearances from the fence and from what was seen."""
        is_free = not self.fence.is_active or is_clear(self.fence, start, end, clearance_m)
        return is_free and not self.voyage.bars(start, end, _CLEAR_SHARE * seen_m, ())

    def straight(self, here: Point, goals: Sequence[Point], config: BoatConfig) -> Point | None:
        """The nearest goal, if the straight line to it is clear."""
        goal = min(goals, key=lambda goal: distance_m(here, goal), default=None)
        share = MARGIN_SHARES[0]
        clearance_m, seen_m = share * config.fence.margin_m, share * config.avoidance.margin_m
        return goal if goal is not None and self.is_clear(here, goal, clearance_m, seen_m) else None

    def searching(
        self,
        here: Point,
        goals: Sequence[Point],
        config: BoatConfig,
        shares: Sequence[float] = MARGIN_SHARES,
        *,
        is_wary: bool = False,
        via: Point | None = None,
    ) -> Generator[None, None, WaterRoute | None]:
        """Search the shortest way to one of the goals, a part at a time. is_wary: unseen water costs more.
        via: sail there first.

        Without a way that is clear of what was seen, which may be wrong, one inside the fence.
        """
        water, margin_m, start = self.water, config.fence.margin_m, via or here
        if water is None:
            return None
        way, is_clear = None, self.is_clear
        seen = Seen(self.voyage.stretches(), config.avoidance.margin_m)
        if seen.stretches:
            way = yield from searching_way(self.fence, water, start, goals, margin_m, shares, seen)
            most_m = math.inf if way is None else UNSEEN_COST * way.length_m
            back = (yield from self._searching_back(start, goals, config, seen, most_m)) if is_wary else None
            if back is not None:
                way, is_clear = back, _as_it_is
        if way is None:  # all at once: others search the same water
            way = finished(searching_way(self.fence, water, start, goals, margin_m, shares))
        if way is not None and via is not None:
            way = way._replace(corners=(via, *way.corners))
        return None if way is None else WaterRoute(is_clear, here, way, config)

    def _searching_back(
        self, here: Point, goals: Sequence[Point], config: BoatConfig, seen: Seen, most_m: float
    ) -> Generator[None, None, Way | None]:
        """Search a way along the track; None where it costs more than most_m."""

        def is_open(start: Point, end: Point) -> bool:
            return not self.voyage.bars(start, end, seen.margin_m, (start, end))

        water, margin_m = self.water, config.fence.margin_m
        back = self.track.back_to(here, goals, UNSEEN_COST, is_open)
        if water is None or back is None:
            return None
        track, back_m = back
        if UNSEEN_COST * distance_m(here, track[0]) + back_m >= most_m:
            return None
        joins = yield from searching_way(self.fence, water, here, track[:1], margin_m, seen=seen)
        if joins is None or UNSEEN_COST * joins.length_m + back_m >= most_m:
            return None
        corners = (*joins.corners, *track[1:])
        return Way(corners, path_length_m((here, *corners)), margin_m, LEAST_SEEN * seen.margin_m)


def _as_it_is(start: Point, end: Point, clearance_m: float, seen_m: float) -> bool:  # noqa: ARG001
    """No corner of the track is cut: beside it the water is unknown."""
    return False


def _is_off(leg: Leg, here: Point, config: BoatConfig) -> bool:
    """Whether the boat gave way to something, and its leg no longer leads from where it is."""
    along_m, cross_m = Line(leg.start, leg.end).along_and_cross_track_m(here)
    to_end_m = distance_m(leg.start, leg.end) - along_m
    return abs(cross_m) > config.guidance.lookahead_m or to_end_m < -config.guidance.waypoint_radius_m


class Passage:
    """The way to the nearest of some goals, and what the boat does of it. way: None while it is not known.

    has_failed: there is none.
    """

    def __init__(self, surroundings: Surroundings) -> None:
        self._surroundings = surroundings
        self.restart()

    def restart(self) -> None:
        """Start from wherever the boat is."""
        self._check_s = -math.inf
        self._roomy: Point | None = None  # the latest place with room
        self.aim_anew()

    def aim_anew(self) -> None:
        """There is another goal. However often there is, nothing is searched more often than before."""
        self.way: WaterRoute | None = None
        self.has_failed = False
        self._search: Generator[None, None, WaterRoute | None] | None = None
        self._version = -1
        self._is_wary = False  # something barred a way: the fence does not tell all
        self._direct: Leg | None = None

    def sail_straight(self, here: Point, goal: Point, config: BoatConfig) -> None:
        """Sail straight to a goal, until something seen bars the way."""
        self.aim_anew()
        self._go_straight(here, goal, config)

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
        here, margin_m = nav.point, config.avoidance.margin_m
        if not self._surroundings.voyage.is_near(here, _ROOM * margin_m):
            self._roomy = here
        if now_s >= self._check_s and self._search is None:
            self._check_s = now_s + _CHECK_S
            if self.way is not None and self._is_over_the_fence(here, self.way.leg.end):
                self.way = None
            is_barred = self.way is not None and self._is_barred(self.way, here, margin_m)
            if is_barred:
                self._is_wary = self._surroundings.voyage.has_barred_a_way = True
            if is_barred and self._comes_upon_something(nav, config):
                self._check_s = now_s
            elif self.way is None or is_barred or (self._is_wary and _is_off(self.way.leg, here, config)):
                self._begin(here, goals, config)
        if self._search is not None:
            try:
                next(self._search)
            except StopIteration as end:
                self._search = None
                self.way = end.value or self.way
                self.has_failed = self.way is None and self._surroundings.water is not None

    def _begin(self, here: Point, goals: Sequence[Point], config: BoatConfig) -> None:
        """Without room, the boat goes back to where it last had some: it cannot tell which side is land."""
        surroundings = self._surroundings
        self._version = surroundings.voyage.version
        goal = surroundings.straight(here, goals, config)
        if goal is not None:
            self._go_straight(here, goal, config)
            return
        is_close = surroundings.voyage.is_near(here, _CLOSE * config.avoidance.margin_m)
        self._search = surroundings.searching(
            here, goals, config, is_wary=self._is_wary, via=self._roomy if is_close else None
        )

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
        voyage = self._surroundings.voyage
        if voyage.version == self._version:
            return False
        seen_m = _BARRED_SHARE * min(way.seen_m, MARGIN_SHARES[0] * margin_m)
        left = [here, *way.corners_left]
        return any(voyage.bars(start, end, seen_m, (here, way.end)) for start, end in pairwise(left))
