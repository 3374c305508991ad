"""Detour around an obstacle: follow its edge on one side until the direct path is free and nearer to the
goal.

This is the boundary following of the Bug algorithms with the leaving condition of I. Kamon and E. Rivlin,
*Sensory-Based Motion Planning with Global Proofs*, IEEE Transactions on Robotics and Automation 13(6), 1997:
the boat leaves the edge only for water nearer to the goal than it has been since it met the obstacle, so two
detours cannot undo each other.
"""

import math
from collections.abc import Sequence

from companion.core.geo import Point, bearing_rad, distance_m
from companion.core.units import wrap_pi
from companion.obstacles.planning.free_space import FreeSpace

STARBOARD, PORT = 1, -1
_ALIKE_RAD = 0.35  # below this difference in turn, starboard is preferred
_ABAFT_RAD, _AHEAD_RAD = 1.9, 0.7  # the followed edge lies between these angles, from the course to its side
_NEEDS = (1.0, 0.5, 0.25)  # of the sight: required length of an open course, the longest first


class Detour:
    """Passes the obstacle on `side`. goal: the destination."""

    def __init__(self, met: Point, goal: Point, side: int, course_rad: float) -> None:
        self.met = met
        self.goal = goal
        self.side = side
        self.course_rad = course_rad
        self.best_m = distance_m(met, goal)  # least distance to the goal so far
        self.length_m = 0.0
        self._last = met
        self._has_left = False

    def advance(self, here: Point, scale_m: float) -> None:
        """Update with the present place."""
        self.length_m += distance_m(self._last, here)
        self._last = here
        self.best_m = min(self.best_m, distance_m(here, self.goal))
        self._has_left = self._has_left or distance_m(here, self.met) > 3.0 * scale_m

    def has_progressed(self, here: Point, clear_m: float, gain_m: float) -> bool:
        """Whether this much free water brings the boat nearer to the goal than ever before."""
        return distance_m(here, self.goal) - clear_m < self.best_m - gain_m

    def has_returned(self, here: Point, scale_m: float) -> bool:
        """Whether the boat is back at the start: the goal cannot be reached."""
        return self._has_left and distance_m(here, self.met) < scale_m

    def steer(self, here: Point, obstacles: Sequence[Point], water: FreeSpace, sight_m: float) -> bool:
        """Choose the course along the edge. False: there is none on this side."""
        course = open_course_rad(water, self._edge_rad(here, obstacles), self.side, sight_m)
        if course is not None:
            self.course_rad = course
        return course is not None

    def reverse(self) -> None:
        """Change to the other side."""
        self.side = -self.side
        self.course_rad = wrap_pi(self.course_rad + math.pi)

    def _edge_rad(self, here: Point, obstacles: Sequence[Point]) -> float:
        """Bearing of the nearest part of the edge, or of the goal."""
        nearest, edge = math.inf, bearing_rad(here, self.goal)
        for obstacle in obstacles:
            distance = distance_m(here, obstacle)
            if distance < nearest:
                bearing = bearing_rad(here, obstacle)
                ahead = self.side * wrap_pi(bearing - self.course_rad)
                if -_ABAFT_RAD < ahead < _AHEAD_RAD:
                    nearest, edge = distance, bearing
        return edge


def open_course_rad(water: FreeSpace, from_rad: float, side: int, sight_m: float) -> float | None:
    """The first open course on one side, with as much room as possible."""
    for share in _NEEDS:
        course = water.first_open_rad(from_rad, side, share * sight_m)
        if course is not None:
            return course
    return None


def choose_side(water: FreeSpace, course_rad: float, sight_m: float) -> tuple[int, float] | None:
    """The side with the smaller turn and its course; starboard if they are similar. None: no side is open."""
    turns: list[tuple[float, int, float]] = []
    for share in _NEEDS:
        for side in (STARBOARD, PORT):
            open_rad = water.first_open_rad(course_rad, side, share * sight_m)
            if open_rad is not None:
                turn = (side * (open_rad - course_rad)) % math.tau
                turns.append((turn - (_ALIKE_RAD if side == STARBOARD else 0.0), side, open_rad))
        if turns:
            break
    if not turns:
        return None
    _, side, open_rad = min(turns)
    return side, open_rad
