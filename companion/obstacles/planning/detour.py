"""A way round something: along its edge, always on one side, until the own way is open again nearer the goal.

This is the boundary following of the Bug algorithms with the leaving condition of I. Kamon and E. Rivlin,
*Sensory-Based Motion Planning with Global Proofs*, IEEE Transactions on Robotics and Automation 13(6), 1997:
the boat leaves only for water that is nearer to the goal than it has been since it met the thing, and so no
two detours can undo each other.
"""

import math
from collections.abc import Sequence

from companion.core.geo import Point, bearing_rad, distance_m
from companion.core.units import wrap_pi
from companion.obstacles.planning.free_space import FreeSpace

STARBOARD, PORT = 1, -1
_ALIKE_RAD = 0.35  # sides that differ by less are alike, and starboard it is
_ABAFT_RAD, _AHEAD_RAD = 1.9, 0.7  # what is followed lies between these, measured from the course to its side
_NEEDS = (1.0, 0.5, 0.25)  # of the sight: how far a course should be open, the most first


class Detour:
    """Keeps the thing on the other hand than `side`. goal: where the boat wants to get to."""

    __slots__ = ("_has_left", "_last", "best_m", "course_rad", "goal", "length_m", "met", "side")

    def __init__(self, met: Point, goal: Point, side: int, course_rad: float) -> None:
        self.met = met
        self.goal = goal
        self.side = side
        self.course_rad = course_rad
        self.best_m = distance_m(met, goal)  # the nearest that it has been to the goal
        self.length_m = 0.0
        self._last = met
        self._has_left = False

    def advance(self, here: Point, scale_m: float) -> None:
        """The boat has come here."""
        self.length_m += distance_m(self._last, here)
        self._last = here
        self.best_m = min(self.best_m, distance_m(here, self.goal))
        self._has_left = self._has_left or distance_m(here, self.met) > 3.0 * scale_m

    def has_progressed(self, here: Point, clear_m: float, gain_m: float) -> bool:
        """Whether so much open water towards the goal gets the boat nearer to it than it has ever been."""
        return distance_m(here, self.goal) - clear_m < self.best_m - gain_m

    def has_returned(self, here: Point, scale_m: float) -> bool:
        """Whether it is back where it began: the goal cannot be reached."""
        return self._has_left and distance_m(here, self.met) < scale_m

    def steer(self, here: Point, obstacles: Sequence[Point], water: FreeSpace, sight_m: float) -> bool:
        """Choose the course along the edge. False when there is none on this side."""
        course = open_course_rad(water, self._edge_rad(here, obstacles), self.side, sight_m)
        if course is not None:
            self.course_rad = course
        return course is not None

    def reverse(self) -> None:
        """Try the other side."""
        self.side = -self.side
        self.course_rad = wrap_pi(self.course_rad + math.pi)

    def _edge_rad(self, here: Point, obstacles: Sequence[Point]) -> float:
        """Where the nearest part of what is followed lies; where the goal lies if nothing does."""
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
    """The first open course on one side, open as far as can be had."""
    for share in _NEEDS:
        course = water.first_open_rad(from_rad, side, share * sight_m)
        if course is not None:
            return course
    return None


def choose_side(water: FreeSpace, course_rad: float, sight_m: float) -> tuple[int, float] | None:
    """The side that asks for the smaller turn, and its course; starboard when they are alike.

    None when neither side is open.
    """
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
