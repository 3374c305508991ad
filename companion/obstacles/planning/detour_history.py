"""History of the detours towards one goal: where they began, on which side, and with what result.

A side is kept until it has brought the boat clearly nearer to the goal than the start of any detour;
otherwise the boat could oscillate between the two ends of an obstacle. A side is excluded only if its detour
has returned to its start without progress.
"""

import math
from collections import deque
from collections.abc import Sequence

from companion.core.geo import Point, bearing_rad, distance_m
from companion.obstacles.planning.detour import Detour, choose_side, open_course_rad
from companion.obstacles.planning.free_space import FreeSpace

_POINTS = 24
_STEP = 0.5  # of the margin
_MOST = 16
_SAME_SPOT = 1.5  # margins: a start this near an earlier one is a closed loop,
_GAIN = 0.3  # unless it is this many margins nearer to the goal
_PROGRESS = 2.0  # margins nearer to the goal than any start: the history is cleared


class DetourHistory:
    """detour_length_m: length of the detours since the last progress; last_side: latest side, 0 none."""

    def __init__(self) -> None:
        self._starts: list[tuple[Point, int, float]] = []  # place, side, and distance to the goal
        self._nearest_m = math.inf
        self.last_side = 0
        self.detour_length_m = 0.0

    def forget(self) -> None:
        """Clear the history for a new goal."""
        self._starts.clear()
        self._nearest_m, self.last_side, self.detour_length_m = math.inf, 0, 0.0

    def start_detour(
        self, here: Point, goal: Point, water: FreeSpace, sight_m: float, margin_m: float
    ) -> Detour | None:
        """A detour on the better side; None if no open side is left."""
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
        """Record the choice of a side."""
        del self._starts[: -(_MOST - 1)]
        self._starts.append((here, side, distance_m(here, goal)))
        self.last_side = side

    def has_tried(self, side: int) -> bool:
        """Whether a side was tried since the last progress."""
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


class Breadcrumbs:
    """Recent places, half a margin apart."""

    def __init__(self) -> None:
        self._places: deque[Point] = deque(maxlen=_POINTS)

    def add(self, here: Point, margin_m: float) -> None:
        """Add the present place."""
        if not self._places or distance_m(self._places[-1], here) > _STEP * margin_m:
            self._places.append(here)

    def last_with_room(self, here: Point, obstacles: Sequence[Point], margin_m: float) -> Point:
        """The last place with the margin around it, or the present one."""
        for place in reversed(self._places):
            if all(distance_m(place, obstacle) > margin_m for obstacle in obstacles):
                return place
        return here
