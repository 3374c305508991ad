"""What has been tried on the way to one goal: where detours began, on which side, and what they came to.

A side once taken is kept until it has brought the boat clearly nearer to the goal than any detour began, for
a boat that changes its mind halfway sails to and fro between two ends of one thing. Only a detour that has
led back to where it began, no nearer, speaks against its side.
"""

import math

from companion.core.geo import Point, bearing_rad, distance_m
from companion.obstacles.planning.detour import Detour, choose_side, open_course_rad
from companion.obstacles.planning.free_space import FreeSpace

_MOST = 16
_SAME_SPOT = 1.5  # margins: a beginning so near another one has come round in a circle,
_GAIN = 0.3  # unless it is by as many nearer to the goal
_PROGRESS = 2.0  # margins nearer to the goal than any beginning before: all that was tried is behind


class DetourHistory:
    """roamed_m: how far detours have led since there was progress; last_side: the side taken last, 0 none."""

    __slots__ = ("_nearest_m", "_starts", "detour_length_m", "last_side")

    def __init__(self) -> None:
        self._starts: list[tuple[Point, int, float]] = []  # where, side, and how far from the goal
        self._nearest_m = math.inf
        self.last_side = 0
        self.detour_length_m = 0.0

    def forget(self) -> None:
        """Another goal, or another day."""
        self._starts.clear()
        self._nearest_m, self.last_side, self.detour_length_m = math.inf, 0, 0.0

    def start_detour(
        self, here: Point, goal: Point, water: FreeSpace, sight_m: float, margin_m: float
    ) -> Detour | None:
        """A detour on the better side; None where there is none that is open and untried."""
        to_goal_m = distance_m(here, goal)
        if to_goal_m < self._nearest_m - _PROGRESS * margin_m:
            self._starts.clear()
            self._nearest_m, self.last_side, self.detour_length_m = to_goal_m, 0, 0.0
        chosen = self._choose(here, goal, water, sight_m, margin_m)
        if chosen is None:
            return None
        side, course = chosen
        self.record(here, side, goal)
        return Detour(here, goal, side, course)

    def record(self, here: Point, side: int, goal: Point) -> None:
        """A side is taken at a place."""
        del self._starts[: -(_MOST - 1)]
        self._starts.append((here, side, distance_m(here, goal)))
        self.last_side = side

    def has_tried(self, side: int) -> bool:
        """Whether a side was taken since there was progress."""
        return any(taken == side for _, taken, _ in self._starts)

    def _choose(
        self, here: Point, goal: Point, water: FreeSpace, sight_m: float, margin_m: float
    ) -> tuple[int, float] | None:
        wanted, to_goal_m = bearing_rad(here, goal), distance_m(here, goal)
        if not self.last_side:
            return choose_side(water, wanted, sight_m)
        failed = {
            side
            for place, side, was_m in self._starts
            if was_m - to_goal_m < _GAIN * margin_m and distance_m(place, here) < _SAME_SPOT * margin_m
        }
        for side in (self.last_side, -self.last_side):
            if side not in failed:
                course = open_course_rad(water, wanted, side, sight_m)
                if course is not None:
                    return side, course
        return None
