"""Heading for a boat in a current faster than itself: the one that stays clear of the fence for longest."""

import math
from typing import Final, Protocol

from companion.core.geo import Point
from companion.core.state import Demand, NavState

_COURSES: Final = 24
_REACH_S: Final = 120.0  # lines farther off are ignored
_AGAIN_S: Final = 2.0  # time between two choices
_ROOM_M: Final = 8.0  # from a line: a boat that steers with one motor swings to and fro


class Lines(Protocol):
    """The fence, as far as it counts here."""

    def room_m(self, point: Point, course_rad: float, reach_m: float) -> float:
        """Free distance along a course, at most reach_m."""

    def is_near(self, point: Point, reach_m: float) -> bool:
        """Whether some line may be nearer than reach_m."""


class DriftHeading:
    """Replaces the demand where the boat cannot hold it: near a line, or in a faster current."""

    def __init__(self) -> None:
        self._demand: Demand | None = None
        self._due_s = 0.0

    def update(self, wanted: Demand, nav: NavState, fence: Lines, speed_m_s: float, now_s: float) -> Demand:
        """What to hold for now. speed_m_s: the speed through the water that the boat reaches."""
        is_slow = math.hypot(nav.current_north_m_s, nav.current_east_m_s) <= speed_m_s
        if is_slow and not fence.is_near(nav.point, _ROOM_M):
            self._demand = None
            return wanted
        if self._demand is None or now_s >= self._due_s:
            self._due_s = now_s + _AGAIN_S
            self._demand = drift_demand(nav, fence, speed_m_s)
        return self._demand


def drift_demand(nav: NavState, bounds: Lines, speed_m_s: float) -> Demand:
    """The heading, at speed_m_s through the water, that stays clear of lines for longest.

    Ties go to the first candidate; the first is the bow into the current.
    """
    current_n, current_e = nav.current_north_m_s, nav.current_east_m_s
    upstream = math.atan2(-current_e, -current_n)
    best, longest_s = upstream, -1.0
    here = Point(nav.north_m, nav.east_m)
    for number in range(_COURSES):
        heading = upstream + math.tau * ((number + 1) // 2) / _COURSES * (1.0 if number % 2 else -1.0)
        north_m_s = current_n + speed_m_s * math.cos(heading)
        east_m_s = current_e + speed_m_s * math.sin(heading)
        ground_m_s = math.hypot(north_m_s, east_m_s)
        reach_m = ground_m_s * _REACH_S
        room_s = (
            _REACH_S
            if ground_m_s < 1e-3
            else bounds.room_m(here, math.atan2(east_m_s, north_m_s), reach_m) / ground_m_s
        )
        if room_s > longest_s + 0.5:
            best, longest_s = heading, room_s
    along_m_s = current_n * math.cos(best) + current_e * math.sin(best)
    return Demand(math.remainder(best, math.tau), speed_m_s + along_m_s)
