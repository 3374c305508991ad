"""Shortest routes of one clearance among shores, and where to begin when the start has less.

The kernel finds straight legs and arcs round corners of the land. A route replaces each arc by circumscribed
legs, so few that the route is at most `MAX_EXCESS` longer, and each of them is tested against the shores.
"""

import math
from array import array
from collections.abc import Callable, Generator, Iterator, Sequence
from typing import TYPE_CHECKING, Literal, NamedTuple

from companion.core.geo import Point, distance_m, path_length_m
from companion.core.steps import finished
from companion.planning import kernels
from companion.planning.arcs import ARC_STEP_RAD, GRAZE_M, ROUNDING_M
from companion.planning.exits import exits

if TYPE_CHECKING:
    from companion.planning.arcs import Arcs
    from companion.planning.segments import Segments
    from companion.planning.tangent_search import TangentSearch

MAX_EXCESS = 5e-5
"""Half of the 0.01 % that a route may be longer than with true arcs; where there is no room for large steps
the arcs are followed in the kernel's, which are 0.01 % longer than the arc alone."""
MAX_STEP_RAD = math.radians(30.0)
TURN, TURN_BACK = 16, 2
"""Tangents that the searches from the start and from the goal follow by turns: an eighth for what is found
only where no route joins them."""

_arcs = kernels.load("_arcs", "arcs")
_view = kernels.load("_view", "view")
_tangents = kernels.load("_tangents", "tangents")
_tangent_search = kernels.load("_tangent_search", "tangent_search")


class Route(NamedTuple):
    """A route, start and goal included. expanded: tangents that the search followed."""

    points: tuple[Point, ...]
    length_m: float
    expanded: int


class NoWay(Exception):  # noqa: N818  (a search's answer)
    """No route. nearest: for a start or goal without the clearance, the nearest water that has it."""

    def __init__(self, reason: Literal["start", "goal", "unconnected"], nearest: Point | None = None) -> None:
        super().__init__(reason)
        self.reason = reason
        self.nearest = nearest


class Routes:
    """The tangent graph of one clearance, built as queries need it."""

    def __init__(
        self,
        is_water: Callable[[Point], bool],
        segments: "Segments | None",
        following: "array[int]",
        left: "array[int]",
        limit: "array[float]",
    ) -> None:
        self._is_water = is_water
        self._segments = segments
        self._given = (following, left, limit)
        self._limit = limit
        self._limit2 = array("d", [(value - ROUNDING_M) ** 2 for value in limit])
        self._reach_m = max(limit, default=0.0)
        self._arcs: Arcs | None = None
        self._searches: tuple[TangentSearch, TangentSearch] | None = None

    def is_clear(self, start: Point, end: Point) -> bool:
        """Whether a straight leg keeps its clearance from every shore."""
        return self._segments is None or self._segments.is_clear(
            start.east_m, start.north_m, end.east_m, end.north_m, self._limit2, self._reach_m
        )

    def is_free(self, at: Point) -> bool:
        """Whether a point is in the water and has the clearance."""
        is_finite = math.isfinite(at.north_m) and math.isfinite(at.east_m)
        return is_finite and self._is_water(at) and self.is_clear(at, at)

    def route(self, start: Point, goal: Point) -> Route:
        """The shortest route; the same there and back.

        Raises:
            NoWay: start or goal is no water or nearer to a shore than the clearance, or no route joins them.
        """
        return finished(self.searching(start, goal))

    def searching(self, start: Point, goal: Point) -> Generator[None, None, Route]:
        """The same, a part of the search at a time.

        Raises:
            NoWay: as `route`.
        """
        for place, reason in ((start, "start"), (goal, "goal")):
            if not self.is_free(place):
                raise NoWay(
                    "start" if reason == "start" else "goal", next(self.exits(place, is_afloat=False), None)
                )
        if self.is_clear(start, goal):
            return Route((start, goal), distance_m(start, goal), 0)
        if goal < start:
            there = yield from self._search(goal, start)
            return Route(there.points[::-1], there.length_m, there.expanded)
        return (yield from self._search(start, goal))

    def lengths_m(self, start: Point, goals: Sequence[Point]) -> list[float]:
        """Length of the route to each goal; infinite where there is none."""
        lengths: list[float] = []
        for goal in goals:
            try:
                lengths.append(self.route(start, goal).length_m)
            except NoWay:
                lengths.append(math.inf)
        return lengths

    def exits(self, at: Point, *, is_afloat: bool = True) -> Iterator[Point]:
        """Points with the clearance round one that has none, the nearest first.

        is_afloat: only those that a straight leg reaches without touching a shore.
        """
        if self._segments is None or not (math.isfinite(at.north_m) and math.isfinite(at.east_m)):
            return
        radii_m = [limit_m + GRAZE_M for limit_m in self._limit]
        for candidate in exits(self._segments, radii_m, at, self.is_free):
            if not is_afloat or self._segments.distance2(
                at.east_m, at.north_m, candidate.east_m, candidate.north_m
            ):
                yield candidate

    def _search(self, start: Point, goal: Point) -> Generator[None, None, Route]:
        """The shortest route by a search from the start and a slower one from the goal, whichever ends first.

        A goal in water of its own, as a rule a small cove, is found unconnected without a search of the lake.
        """
        if self._arcs is None or self._searches is None:
            self._arcs = _arcs.Arcs(self._segments, *self._given)
            graph = _tangents.Tangents(self._arcs, _view.View(self._arcs))
            self._searches = (_tangent_search.TangentSearch(graph), _tangent_search.TangentSearch(graph))
        search, back = self._searches
        search.begin(start.east_m, start.north_m, goal.east_m, goal.north_m)
        if search.is_done(TURN):
            return _route(self._arcs, search, start, goal)
        back.begin(goal.east_m, goal.north_m, start.east_m, start.north_m)
        while not back.is_done(TURN_BACK):
            yield
            if search.is_done(TURN):
                return _route(self._arcs, search, start, goal)
        there = _route(self._arcs, back, goal, start)
        return there._replace(points=there.points[::-1])


def _route(arcs: "Arcs", search: "TangentSearch", start: Point, goal: Point) -> Route:
    """What a search has found, as legs."""
    if math.isinf(search.bound):
        raise NoWay("unconnected")
    turns = search.turns()
    turned_m = sum(arcs.radius[node >> 1] * (left_at - at) for node, at, left_at in turns)
    step_rad = MAX_STEP_RAD
    if turned_m > 0.0:  # a circumscribed step is step²/12 longer than its arc
        step_rad = min(step_rad, math.sqrt(12.0 * MAX_EXCESS * search.bound / turned_m))
    points = [start]
    for node, at, left_at in turns:
        points += _corners(arcs, node, at, left_at, step_rad)
    points.append(goal)
    return Route(tuple(points), path_length_m(points), search.expanded)


def _corners(arcs: "Arcs", node: int, at: float, left_at: float, step_rad: float) -> list[Point]:
    """An arc as the corners of circumscribed legs, the fewest that are clear."""
    turn = max(left_at - at, 0.0)
    proven = int(turn / ARC_STEP_RAD) + 1  # what the search has tested
    legs = min(math.ceil(turn / step_rad), proven) or 1
    while legs < proven and not arcs.is_walk_clear(node, at, left_at, legs):
        legs = min(2 * legs, proven)
    step = turn / legs
    radius_m = arcs.radius[node >> 1] / math.cos(0.5 * step)
    places = [at + (n + 0.5) * step for n in range(legs)]
    return [
        Point(arcs.point_y(node, place, radius_m), arcs.point_x(node, place, radius_m)) for place in places
    ]
