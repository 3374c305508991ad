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
from companion.obstacles.perception.voyage_map import Stretch, VoyageMap
from companion.obstacles.planning.cost_to_go import UNSEEN_COST
from companion.vehicle.track import SailedTrack

# Of its clearance to what was seen, a leg keeps so much to each cell, as outlines cut corners; with less the
# way is barred
_CLEAR_SHARE, _BARRED_SHARE = 0.75, 0.6


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

    def bars(self, places: Sequence[Point], end: Point, seen_m: float) -> bool:
        """Whether what was seen bars a way from place to place towards an end that keeps so clear of it."""
        ends = (places[0], end)
        return any(
            self.voyage.bars(one, other, _BARRED_SHARE * seen_m, ends) for one, other in pairwise(places)
        )

    def is_barred(self, places: Sequence[Point], end: Point, config: BoatConfig, *, has_left: bool) -> bool:
        """Whether what was seen bars a way from place to place towards an end. has_left: a boat that has left
        it needs as much room as a planned way, also from the fence.
        """
        clearance_m, seen_m = (
            MARGIN_SHARES[0] * margin_m for margin_m in (config.fence.margin_m, config.avoidance.margin_m)
        )
        if not has_left:
            return self.bars(places, end, seen_m)
        return not all(self.is_clear(one, other, clearance_m, seen_m) for one, other in pairwise(places))

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
        dead_ends: Sequence[Stretch] = (),
    ) -> Generator[None, None, WaterRoute | None]:
        """Search the shortest way to one of the goals, a part at a time. is_wary: unseen water costs more.
        via: sail there first. dead_ends: no way leads across.

        Without a way that is clear of what was seen, which may be wrong, one inside the fence.
        """
        water, margin_m, start = self.water, config.fence.margin_m, via or here
        if water is None:
            return None
        way, is_clear = None, self.is_clear
        seen = Seen([*self.voyage.stretches(), *dead_ends], config.avoidance.margin_m)
        if seen.stretches:
            way = yield from searching_way(self.fence, water, start, goals, margin_m, shares, seen)
            most_m = math.inf if way is None else UNSEEN_COST * way.length_m
            back = (yield from self._searching_back(start, goals, config, seen, most_m)) if is_wary else None
            if back is not None:
                # No corner of the track is cut: beside it the water is unknown
                way, is_clear = back, lambda *_: False
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
