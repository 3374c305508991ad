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
from companion.core.geo import Point, distance_m, path_length_m
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
from companion.obstacles.perception.voyage_map import VoyageMap
from companion.vehicle.track import SailedTrack

_CHECK_S = 1.0  # how often the way ahead is checked
_UNSEEN = 1.9  # the lake boat's cruise over its speed by a sight of 4 m (docs/avoidance.md)
# Of its clearance to what was seen, a leg keeps so much to each cell, as outlines cut corners; with less the
# way is barred
_CLEAR_SHARE, _BARRED_SHARE = 0.75, 0.6


class Surroundings:
    """fence: the uploaded areas. voyage: what the boat has seen. track: where it has sailed.

    The fence's shores are indexed when they change, in ticks of their own.
    """

    def __init__(self, fence: Fence, voyage: VoyageMap, track: SailedTrack) -> None:
        self.fence = fence
        self.voyage = voyage
        self.track = track
        self._water: FenceWater | None = None
        self._version = -1

    def prepare(self, margin_m: float) -> None:
        """Index the fence's shores if they have changed. To be called every tick."""
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
    ) -> Generator[None, None, WaterRoute | None]:
        """Search the shortest way to one of the goals, a part at a time. is_wary: unseen water costs more.

        Without a way that is clear of what was seen, which may be wrong, one inside the fence.
        """
        water, margin_m = self.water, config.fence.margin_m
        if water is None:
            return None
        stretches = self.voyage.stretches()
        if not stretches:  # all at once: others search the same water
            way = finished(searching_way(self.fence, water, here, goals, margin_m, shares))
            return None if way is None else WaterRoute(self.is_clear, here, way, config)
        seen = Seen(stretches, config.avoidance.margin_m)
        way = yield from searching_way(self.fence, water, here, goals, margin_m, shares, seen)
        length_m = math.inf if way is None else way.length_m

        def is_open(start: Point, end: Point) -> bool:
            return not self.voyage.bars(start, end, seen.margin_m, (start, end))

        back = self.track.back_to(here, goals, _UNSEEN, is_open) if is_wary else None
        if back is not None:
            joins, back_m = back
            to_track = None
            if _UNSEEN * distance_m(here, joins[0]) + back_m < _UNSEEN * length_m:
                to_track = yield from searching_way(
                    self.fence, water, here, joins[:1], margin_m, shares, seen
                )
            if to_track is not None and _UNSEEN * to_track.length_m + back_m < _UNSEEN * length_m:
                corners = (*to_track.corners, *joins[1:])
                way = Way(corners, path_length_m((here, *corners)), margin_m, LEAST_SEEN * seen.margin_m)
                return WaterRoute(_as_it_is, here, way, config)
        if way is None:
            way = finished(searching_way(self.fence, water, here, goals, margin_m, shares))
        return None if way is None else WaterRoute(self.is_clear, here, way, config)


def _as_it_is(start: Point, end: Point, clearance_m: float, seen_m: float) -> bool:  # noqa: ARG001
    """No corner of the track is cut: beside it the water is unknown."""
    return False


class Passage:
    """The way to the nearest of some goals, and what the boat does of it. way: None while it is not known.

    has_failed: there is none.
    """

    def __init__(self, surroundings: Surroundings) -> None:
        self._surroundings = surroundings
        self.restart()

    def restart(self) -> None:
        """Start from wherever the boat is."""
        self.way: WaterRoute | None = None
        self.has_failed = False
        self._search: Generator[None, None, WaterRoute | None] | None = None
        self._check_s = -math.inf
        self._version = -1
        self._is_wary = False  # something barred a way: the fence does not tell all

    def update(self, here: Point, goals: Sequence[Point], config: BoatConfig, now_s: float) -> None:
        """Check the way from time to time, and search another where it is barred."""
        if now_s >= self._check_s and self._search is None:
            self._check_s = now_s + _CHECK_S
            if self.way is not None and self._is_over_the_fence(here, self.way.leg.end):
                self.way = None
            is_barred = self.way is not None and self._is_barred(self.way, here)
            self._is_wary = self._is_wary or is_barred
            if self.way is None or is_barred:
                self._begin(here, goals, config)
        if self._search is not None:
            try:
                next(self._search)
            except StopIteration as end:
                self._search = None
                self.way = end.value or self.way
                self.has_failed = self.way is None and self._surroundings.water is not None

    def _begin(self, here: Point, goals: Sequence[Point], config: BoatConfig) -> None:
        self._version = self._surroundings.voyage.version
        goal = self._surroundings.straight(here, goals, config)
        if goal is not None:
            way = Way((goal,), distance_m(here, goal), 0.0, MARGIN_SHARES[0] * config.avoidance.margin_m)
            self.way = WaterRoute(self._surroundings.is_clear, here, way, config)
        else:
            self._search = self._surroundings.searching(here, goals, config, is_wary=self._is_wary)

    def _is_over_the_fence(self, here: Point, end: Point) -> bool:
        """Whether the fence now crosses the rest of the leg."""
        fence = self._surroundings.fence
        return fence.is_active and not fence.is_outside(here) and fence.crosses(here, end)

    def _is_barred(self, way: WaterRoute, here: Point) -> bool:
        """Whether something was seen on the rest of the way since it was planned."""
        voyage = self._surroundings.voyage
        if voyage.version == self._version:
            return False
        seen_m = _BARRED_SHARE * way.seen_m
        left = [here, *way.corners_left]
        return any(voyage.bars(start, end, seen_m, (here, way.end)) for start, end in pairwise(left))
