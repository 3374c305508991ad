"""The way around what blocks the path, kept as long as it is free and no other is much shorter."""

import math
from itertools import pairwise
from typing import Final

from companion.core.geo import Line, Point, distance_m
from companion.obstacles.planning.clearance import ClearanceField
from companion.obstacles.planning.route import find_route
from companion.obstacles.planning.way_ahead import places_on

_SEARCH_S: Final = 0.5  # between two searches: the boat moves half a hull
_BETTER: Final = 0.85  # of the present route's length: a new one this short replaces it
_PROGRESS: Final = 2.0  # margins nearer to the goal than ever: the length counts from here
_FAILED: Final = 3  # searches without a route: then there is none


class Detour:
    """route: corners from the boat on, None without one; length_m: sailed since the last progress."""

    def __init__(self) -> None:
        self.route: list[Point] | None = None
        self.length_m = 0.0
        self._searched_s = -math.inf
        self._failed = 0
        self._best_m = math.inf
        self._last: Point | None = None

    def update(
        self,
        here: Point,
        goal: Point,
        field: ClearanceField,
        margin_m: float,
        hull_m: float,
        now_s: float,
        *,
        is_certain: bool,
    ) -> bool:
        """Keep or find the route; False: there is none. is_certain: not only single echoes are in the way."""
        if self._last is not None and is_certain:
            self.length_m += distance_m(self._last, here)
        self._last = here
        away_m = distance_m(here, goal)
        if away_m < self._best_m - _PROGRESS * margin_m:
            self._best_m, self.length_m = away_m, 0.0
        route = self.route
        if route is not None:
            while len(route) > 1 and distance_m(here, route[1]) < margin_m:
                del route[0]
            route[0] = here
            if len(route) < 2 or blocked_m(route, field, hull_m) < math.inf:
                route = None
        if route is not None and now_s < self._searched_s + _SEARCH_S:
            return True
        self._searched_s = now_s
        found = find_route(field, here, goal, margin_m, hull_m + field.cell_m)
        if found is None:
            self.route = route
            self._failed += is_certain
            return self._failed < _FAILED
        self._failed = 0
        if route is None or _length_m(found, goal) < _BETTER * _length_m(route, goal):
            self.route = found
        return True

    def aside_m(self) -> float:
        """The farthest that the route leaves the line to its end, positive to starboard; 0 without one."""
        route = self.route
        if route is None or len(route) < 2:
            return 0.0
        line = Line(route[0], route[-1])
        return max((line.along_and_cross_track_m(at)[1] for at in route), key=abs)

    def target(self, here: Point, field: ClearanceField, reach_m: float, hull_m: float) -> Point | None:
        """The farthest place on the route, within reach, to which the straight line is free."""
        route = self.route
        if route is None:
            return None
        step_m = 2.0 * field.cell_m
        for at in reversed(places_on(route, step_m, math.ceil(reach_m / step_m))):
            if blocked_m([here, at], field, hull_m + field.cell_m) == math.inf:
                return at
        return route[min(1, len(route) - 1)]


def blocked_m(way: list[Point], field: ClearanceField, clear_m: float) -> float:
    """Distance along a path to the first place nearer than clear_m to something; infinite for none.

    What the boat is near already does not count, unless the path comes nearer.
    """
    step_m = 2.0 * field.cell_m
    reach_m = min(_length_m(way, way[-1]), 1.5 * field.half * field.cell_m)
    here_m = field.distance_m(*way[0])
    clear_m = min(clear_m, here_m - 0.5 * field.cell_m)
    for number, at in enumerate(places_on(way, step_m, math.ceil(reach_m / step_m))):
        if field.distance_m(*at) < clear_m:
            return number * step_m
    return math.inf


def _length_m(way: list[Point], goal: Point) -> float:
    """Of a path, and from its end straight to the goal."""
    return sum(distance_m(a, b) for a, b in pairwise(way)) + distance_m(way[-1], goal)
