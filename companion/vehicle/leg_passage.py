"""Rounds on a mode's leg what was seen there, and returns onto the leg as soon as it is free.

The leg is left where something bars it within sight. What is rounded within less than a sight more is left to
the local planner. The way round leads to the end of the leg (`surroundings.py`). As in Bug2 (V. Lumelsky and
A. Stepanov, *Path-planning strategies for a point mobile automaton*, Algorithmica 2, 1987) the line itself is
sailed on from where it is met beyond the obstacle.
"""

import math

from companion.config.boat_config import BoatConfig
from companion.core.geo import Line, Point, distance_m
from companion.core.intent import FollowLeg
from companion.core.state import NavState
from companion.geofence.water_route import WaterRoute
from companion.vehicle.passage import CHECK_S, Passage
from companion.vehicle.surroundings import Surroundings


class LegPassage:
    """is_led: the boat sails another way to the end of the leg. is_shut: none is clear of what was seen."""

    def __init__(self, surroundings: Surroundings) -> None:
        self._surroundings = surroundings
        self._passage = Passage(surroundings)
        self.restart()

    def restart(self) -> None:
        """Start from wherever the boat is."""
        self._passage.restart()
        self._end: Point | None = None
        self._check_s = -math.inf
        self.sail_on()

    def sail_on(self) -> None:
        """Sail the leg itself, until something bars it."""
        self._passage.aim_anew()
        self._is_barred = self.is_led = self._is_ordered = False
        self._joins_m: float | None = None  # where the boat comes back onto the line

    def lead(self, end: Point, way: WaterRoute) -> None:
        """Sail this way to the end of a leg whose line does not count."""
        self.sail_on()
        self._end, self.is_led, self._is_ordered = end, True, True
        self._passage.way = way

    @property
    def is_shut(self) -> bool:
        return self._passage.is_shut

    @property
    def way(self) -> WaterRoute | None:
        """The way that the boat sails instead of the leg."""
        return self._passage.way if self.is_led else None

    def left_m(self, here: Point) -> float | None:
        """The rest of that way; None where the boat sails the leg."""
        return self._passage.left_m(here) if self.is_led else None

    def update(
        self, wanted: FollowLeg, nav: NavState, config: BoatConfig, now_s: float, end: Point | None = None
    ) -> FollowLeg:
        """The leg to sail. end: sail there by whatever line, and not back onto that of the leg."""
        keeps_line, goal = end is None, end or wanted.end
        if goal != self._end:
            self._end = goal
            self.sail_on()
            if not keeps_line:
                self._passage.sail_straight(nav.point, goal, config)
        if keeps_line:
            self._check(wanted, nav, config, now_s)
            if not self._is_barred:
                return self._back_on(wanted, nav, config)
        self._passage.leads_back = not keeps_line  # a leg may lead along the track
        self._passage.update(nav, [goal], config, now_s)
        way = self._passage.way
        if way is None or way.is_straight:
            return wanted
        way.advance(nav, config)  # also the corners that the local planner has taken the boat past
        sight_m, away_m = config.avoidance.lookahead_m, distance_m(nav.point, goal)
        off_m = abs(wanted.line.along_and_cross_track_m(nav.point)[1]) if keeps_line else 0.0
        is_long = self.is_led or off_m + way.left_m(nav.point) > away_m + sight_m
        self.is_led = self._is_ordered or (is_long and away_m > sight_m)
        return way.leg.intent(wanted.speed_m_s) if self.is_led else wanted

    def _check(self, wanted: FollowLeg, nav: NavState, config: BoatConfig, now_s: float) -> None:
        """Whether the leg is barred, or free again: where the boat is on it, as far as it sees."""
        if now_s < self._check_s:
            return
        self._check_s = now_s + CHECK_S
        along_m, cross_m = wanted.line.along_and_cross_track_m(nav.point)
        joins_m = along_m + max(abs(cross_m), config.guidance.lookahead_m)
        left = [nav.point, wanted.end]
        if joins_m < wanted.line.length_m:
            on_m = joins_m + config.avoidance.lookahead_m
            left[1:] = [_at(wanted.line, joins_m), _at(wanted.line, min(on_m, wanted.line.length_m))]
        is_barred = self._surroundings.is_barred(left, wanted.end, config, has_left=self._is_barred)
        if is_barred is not self._is_barred:
            self.sail_on()
            self._is_barred = is_barred

    def _back_on(self, wanted: FollowLeg, nav: NavState, config: BoatConfig) -> FollowLeg:
        """The leg; beside something seen that the boat gave way to, up to where it is back on the line: the
        local planner takes the shortest way to the end of a leg.
        """
        along_m, cross_m = wanted.line.along_and_cross_track_m(nav.point)
        off_m, lookahead_m = abs(cross_m), config.guidance.lookahead_m
        joins_m = along_m + off_m + lookahead_m
        if self._joins_m is None and off_m > lookahead_m and joins_m < wanted.line.length_m:
            if self._surroundings.voyage.is_near(nav.point, off_m + config.avoidance.lookahead_m):
                self._joins_m = joins_m
        elif self._joins_m is not None and (off_m < 0.5 * lookahead_m or along_m > self._joins_m):
            self._joins_m = None
        if self._joins_m is None:
            return wanted
        return FollowLeg(wanted.start, _at(wanted.line, self._joins_m), wanted.speed_m_s, wanted.end)


def _at(line: Line, along_m: float) -> Point:
    return line.start.towards(line.end, max(along_m, 0.0) / line.length_m)
