"""The way around an obstacle without a known end: its side, and when it is given up.

The boat cannot know how long a wall is. It chooses a side after a full sweep, assumes that the wall goes on
to the other side wherever no ranger has seen free water, and turns back when it has followed it for a sight
without passing it. Each further try goes twice as far: no strategy needs fewer than nine times the
shortest way in the worst case (R. Baeza-Yates, J. Culberson, G. Rawlins, *Searching in the plane*,
Information and Computation 106, 1993). The side outlives a new goal behind the same obstacle.
"""

import math
from typing import Final

from companion.core.geo import Point, distance_m
from companion.core.units import wrap_pi
from companion.obstacles.perception.occupancy import SWEEP_S
from companion.obstacles.planning.cost_to_go import CostToGo

_PROBE_M: Final = 1.5  # beside the boat, where the ways on both sides are compared
_ELSEWHERE_RAD: Final = math.radians(60.0)  # between the courses to goals behind the same obstacle, at most


class Detour:
    """side: 1 to starboard of the way to the goal, −1 to port, 0 not chosen."""

    def __init__(self) -> None:
        self._among = Point(0.0, 0.0), math.inf  # where and when the boat came among obstacles,
        self._certain_s = -math.inf  # and when it was last told so
        self._end()

    def _end(self) -> None:
        self.side = 0
        self._at: Point | None = None  # on the wall
        self._since_s = 0.0
        self._course_rad = self._most_m = 0.0
        self._north, self._east = 1.0, 0.0

    def forget(self) -> None:
        """Try again with whatever side."""
        self._certain_s = -math.inf
        self._end()

    def aim(self, course_rad: float) -> None:
        """There is another goal."""
        if abs(wrap_pi(course_rad - self._course_rad)) > _ELSEWHERE_RAD:
            self._end()

    def begin(self, at: Point, course_rad: float, sight_m: float, now_s: float) -> None:
        """An obstacle at a place on the way; nothing if there is one already."""
        if self._at is None:
            self._at, self._since_s, self._most_m = at, now_s, sight_m
            self._course_rad, self._north, self._east = course_rad, math.cos(course_rad), math.sin(course_rad)

    def is_new(self, now_s: float) -> bool:
        """Whether it was met less than a full sweep ago."""
        return self._at is not None and now_s < self._since_s + SWEEP_S

    def update(self, here: Point, to_go: CostToGo, now_s: float) -> bool:
        """Choose or change the side; whether it did."""
        if self._at is None or self.is_new(now_s):
            return False
        if self.side:
            if self.side * self._abeam_m(*here) < self._most_m:
                return False
            self.side, self._most_m = -self.side, 2.0 * self._most_m
            return True
        port_m, starboard_m = (
            to_go.at(here.north_m - side_m * self._east, here.east_m + side_m * self._north)
            for side_m in (-_PROBE_M, _PROBE_M)
        )
        self.side = -1 if port_m < starboard_m else 1
        return True

    def is_too_long(
        self, here: Point, detour_m: float, slowest_m_s: float, now_s: float, *, is_certain: bool
    ) -> bool:
        """Whether the boat has been among obstacles, nearer than a detour to one place, for as long as that
        takes at the slowest speed, whatever its goals were. Ends the detour behind the obstacle, and where
        nothing was certain for two sweeps.
        """
        is_met_anew = now_s > self._certain_s + 2.0 * SWEEP_S  # as long as the grid keeps a suspect
        if is_met_anew or not self.is_before(here):
            self._end()
        if is_met_anew or not is_certain or distance_m(here, self._among[0]) > detour_m:
            self._among = here, now_s
        if is_certain:
            self._certain_s = now_s
        return now_s > self._among[1] + detour_m / slowest_m_s

    def is_before(self, here: Point) -> bool:
        """Whether the boat has not yet passed the obstacle."""
        at = self._at
        return (
            at is not None
            and (here.north_m - at.north_m) * self._north + (here.east_m - at.east_m) * self._east < 0.0
        )

    def shuts(self, north_m: float, east_m: float) -> bool:
        """Whether a place is this side of the wall and on the side that is not taken."""
        return self.side * self._abeam_m(north_m, east_m) < 0.0 and self.is_before(Point(north_m, east_m))

    def _abeam_m(self, north_m: float, east_m: float) -> float:
        """Distance of a place to starboard of where the wall was met."""
        at = self._at or Point(0.0, 0.0)
        return (east_m - at.east_m) * self._north - (north_m - at.north_m) * self._east
