"""The sailed track since arming, in few points: SMART_RTL's way home.

A point is kept only where the track leaves a straight line: from the last kept point, every position narrows
a sector, so that any line within it passes all of them within the accuracy (J. Williams, "An efficient
algorithm for the piecewise linear approximation of planar curves", Computer Graphics and Image Processing 8,
1978). Where the track crosses itself, the loop is removed.
"""

import math
from collections.abc import Callable, Sequence
from itertools import pairwise

from companion.core.geo import Line, Point, bearing_rad, distance_m
from companion.core.units import wrap_pi
from companion.planning.segments import point_distance2

MOST_POINTS = 5000  # upper limit of SRTL_POINTS
CONTINUES_WITHIN_M = 100.0  # a boat armed further from the end of its stored track was carried there
_STEP_SHARE = 0.25  # of the accuracy: smaller movements are ignored


class SailedTrack:
    """Points from where the boat was armed to where it last turned. Never more than max_points."""

    def __init__(self) -> None:
        self.points: list[Point] = []
        self.is_incomplete = False  # there were more points than allowed
        self.is_restored = False  # from storage, after a power loss; the next arming continues it
        self.latest: Point | None = None
        self._axis_rad: float | None = None
        self._left_rad = self._right_rad = 0.0  # the sector, seen from its axis
        self._reach_m = 0.0

    def restart(self, at: Point | None) -> None:
        """Start a new track, here or at the first position; or continue a restored one that ends near."""
        if at is None or not self.continues_from(at):
            self.points = []
        self.is_restored = self.is_incomplete = False
        if at is not None:
            self.points.append(at)
        self.resume_at(at)

    def restore(self, points: Sequence[Point]) -> None:
        """Use a stored track, oldest point first."""
        self.points = list(points)
        self.is_restored, self.is_incomplete = bool(points), False
        self.resume_at(points[-1] if points else None)

    def continues_from(self, at: Point) -> bool:
        """Whether this is a restored track that ends near a point."""
        return self.is_restored and distance_m(self.points[-1], at) <= CONTINUES_WITHIN_M

    def back_to(
        self,
        here: Point,
        goals: Sequence[Point],
        unsailed: float,
        is_open: Callable[[Point, Point], bool],
    ) -> tuple[list[Point], float] | None:
        """The way back along the track to a goal, from where it is best joined, and its length, that of the
        last leg, from the beginning of the track, `unsailed` times; None without a track that is joined
        and left by open straight ways.
        """
        points = self.points if self.latest is None else [*self.points, self.latest]
        if len(points) < 2 or not goals or self.is_incomplete:
            return None
        goal = min(goals, key=lambda goal: distance_m(points[0], goal))
        if not is_open(points[0], goal):
            return None
        sailed_m, least_m = unsailed * distance_m(points[0], goal), math.inf
        best: tuple[list[Point], float] | None = None
        for number, (before, after) in enumerate(pairwise(points)):
            line = Line(before, after)
            along_m = min(max(line.along_and_cross_track_m(here)[0], 0.0), line.length_m)
            joins = before.towards(after, along_m / max(line.length_m, 1e-9))
            back_m = along_m + sailed_m
            if unsailed * distance_m(here, joins) + back_m < least_m and is_open(here, joins):
                least_m = unsailed * distance_m(here, joins) + back_m
                best = [joins, *points[number::-1], goal], back_m
            sailed_m += line.length_m
        return best

    def resume_at(self, at: Point | None) -> None:
        """Continue recording here, after part of the track was sailed back."""
        self.latest, self._axis_rad = at, None

    def add(self, at: Point, accuracy_m: float, max_points: int) -> None:
        """Record a position. accuracy_m: how far a position may lie off the kept line."""
        latest = self.latest
        if latest is None or not self.points:
            self.points.append(at)
            self.latest = at
            return
        if abs(at.north_m - latest.north_m) + abs(at.east_m - latest.east_m) < _STEP_SHARE * accuracy_m:
            return
        if self.is_incomplete:
            return
        if not self._narrow(at, accuracy_m):
            self._keep(latest, accuracy_m)
            if len(self.points) >= max_points:
                self.is_incomplete = True
                return
            self._axis_rad = None
            self._narrow(at, accuracy_m)
        self.latest = at

    def _narrow(self, at: Point, accuracy_m: float) -> bool:
        """Whether a straight line from the last kept point to here passes every position between."""
        anchor = self.points[-1]
        away_m = distance_m(anchor, at)
        if away_m <= accuracy_m:
            return self._axis_rad is None or self._reach_m - away_m <= accuracy_m
        bearing, half = bearing_rad(anchor, at), math.asin(accuracy_m / away_m)
        if self._axis_rad is None:
            self._axis_rad, self._reach_m = bearing, away_m
            self._left_rad, self._right_rad = -half, half
            return True
        off = wrap_pi(bearing - self._axis_rad)
        if not self._left_rad <= off <= self._right_rad or self._reach_m - away_m > accuracy_m:
            return False
        self._left_rad, self._right_rad = max(self._left_rad, off - half), min(self._right_rad, off + half)
        self._reach_m = max(self._reach_m, away_m)
        return True

    def _keep(self, at: Point, accuracy_m: float) -> None:
        """Keep a point, and remove the loop that it closes."""
        came_from = self.points[-1]
        for index in range(len(self.points) - 2):
            before, after = self.points[index], self.points[index + 1]
            if (crossing := _crossing(Line(before, after), Line(came_from, at))) is not None:
                self.points[index + 1 :] = [crossing, at]
                return
            if point_distance2(*at, *before, *after) <= accuracy_m * accuracy_m:
                self.points[index + 1 :] = [at]
                return
        self.points.append(at)


def _crossing(one: Line, other: Line) -> Point | None:
    """The intersection of two line segments."""
    start_m, start_off_m = one.along_and_cross_track_m(other.start)
    end_m, end_off_m = one.along_and_cross_track_m(other.end)
    if start_off_m * end_off_m >= 0.0:
        return None
    share = start_off_m / (start_off_m - end_off_m)
    along_m = start_m + share * (end_m - start_m)
    if not 0.0 <= along_m <= one.length_m:
        return None
    return other.start.towards(other.end, share)
