"""The fence as water between shores, the shortest way through it, and its route leg by leg.

The boat must be inside every inclusion area and outside every exclusion area. Circles become polygons that
keep them: inscribed to an inclusion circle, circumscribed about an exclusion circle. What the boat has seen
itself are more shores, with a clearance of their own.
"""

import math
from collections.abc import Callable, Generator, Sequence
from typing import NamedTuple

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point, distance_m, path_length_m
from companion.core.state import NavState
from companion.core.steps import finished
from companion.geofence.fence import Fence
from companion.geofence.separation import Separation
from companion.guidance.leg import Leg
from companion.planning.area_shores import CIRCLE_ERROR_M, corners_of, outside_of
from companion.planning.segments import segment_distance2
from companion.planning.visibility import NoWay, Routes
from companion.planning.water import Shore, Water

_CORNER_SHARE = 0.5  # of the clearance: acceptance radius of a corner
_LEAST_CORNER = 1.5  # margins: what was seen asks for no smaller radius than this clearance
_CLEAR_SHARE = 0.95  # of the clearance at its ends: required along a straight leg


MARGIN_SHARES = (1.5, 0.75, 0.25)
"""Clearances of a way in shares of fence.margin_m, tried one after the other: the brake acts within 1."""
LEAST_SEEN = 0.6  # margins: half the hull's length and half a cell, as in `obstacles/planning/cost.py`
_AWAY_SHARE = 0.9  # of the squared distance: rounding
_LEAST_CLEARANCE_M = 0.05
_FRAME_M = 1.0  # between areas and the frame round them
_EXIT_RADII = (0.5, 1.0, 2.0, 4.0)  # clearances
_EXIT_BEARINGS = 16


class Seen(NamedTuple):
    """What the boat has seen, as straight stretches, and the margin to keep from it."""

    stretches: Sequence[tuple[Point, Point]]
    margin_m: float


ClearLeg = Callable[[Point, Point, float, float], bool]
"""Whether a straight leg keeps a clearance from the fence, and one from what was seen."""


class Way(NamedTuple):
    """Corners after the start; the last is the goal. clearance_m: from the lines, seen_m: from what was seen,
    except at the ends.
    """

    corners: tuple[Point, ...]
    length_m: float
    clearance_m: float
    seen_m: float = math.inf


class FenceWater:
    """The water inside a fence, all water without one, and what parts it."""

    def __init__(self, fence: Fence) -> None:
        held = [corners_of(area) for area in fence.areas if area.is_inclusion]
        barred = [corners_of(area) for area in fence.areas if not area.is_inclusion]
        self.water = Water([Shore(corners) for corners in held[:1]], is_open=not held)
        if fence.areas:
            frame = (
                min(area.south_m for area in fence.areas) - _FRAME_M,
                min(area.west_m for area in fence.areas) - _FRAME_M,
                max(area.north_m for area in fence.areas) + _FRAME_M,
                max(area.east_m for area in fence.areas) + _FRAME_M,
            )
            outsides = [outside_of(corners, frame) for corners in held[1:]]
            self.water = self.water.with_shores([*outsides, *(Shore(corners) for corners in barred)])
        self._rings = [*held, *barred]
        self._separations: dict[float, Separation] = {}

    def routes(self, clearance_m: float, seen: Seen | None, seen_m: float) -> Routes:
        """The routes of a clearance; seen_m: the clearance from what was seen."""
        if seen is None:
            return self.water.routes(clearance_m)
        return self.water.with_shores([Shore(one, seen_m) for one in seen.stretches]).routes(clearance_m)

    def prepare(self, margin_m: float) -> None:
        """Find out in one call for each clearance what parts its water, so that no later call takes all that
        time; nothing once that is known.
        """
        for share in MARGIN_SHARES:
            clearance_m = _clearance_m(share, margin_m)
            if clearance_m not in self._separations:
                self.separation(clearance_m)
                return

    def separation(self, clearance_m: float) -> Separation:
        """What parts the water of a clearance."""
        known = self._separations.get(clearance_m)
        if known is None:
            known = self._separations[clearance_m] = Separation(self._rings, clearance_m)
        return known


def way_to_nearest(
    fence: Fence,
    water: FenceWater,
    here: Point,
    goals: Sequence[Point],
    margin_m: float,
    shares: Sequence[float] = MARGIN_SHARES,
) -> Way | None:
    """The shortest way to one of the goals with the largest clearance that lets any be reached.

    Where the boat or a goal has less than the clearance, a straight leg joins it to water that has it.
    """
    return finished(searching_way(fence, water, here, goals, margin_m, shares))


def searching_way(
    fence: Fence,
    water: FenceWater,
    here: Point,
    goals: Sequence[Point],
    margin_m: float,
    shares: Sequence[float] = MARGIN_SHARES,
    seen: Seen | None = None,
) -> Generator[None, None, Way | None]:
    """The same, clear of what was seen as well, a part of the search at a time."""
    for share in shares:
        clearance_m = _clearance_m(share, margin_m)
        best: Way | None = None
        seen_m = math.inf if seen is None else max(share, LEAST_SEEN) * seen.margin_m
        routes = water.routes(clearance_m, seen, seen_m)
        start: Point | None = None
        for away_m, goal in sorted((distance_m(here, goal), goal) for goal in goals):
            if best is not None and away_m >= best.length_m:
                break
            start = start or _with_clearance(fence, routes, here, goal, clearance_m, seen)
            end = _with_clearance(fence, routes, goal, here, clearance_m, seen)
            if start is None or end is None:
                continue
            if not routes.is_clear(start, end) and water.separation(clearance_m).parts(start, end):
                continue  # sooner known than by a search, which would look everywhere
            try:
                route = yield from routes.searching(start, end)
            except NoWay:
                continue
            length_m = distance_m(here, start) + route.length_m + distance_m(end, goal)
            if best is None or length_m < best.length_m:
                corners = (*route.points[start == here :], *((goal,) if end != goal else ()))
                best = Way(corners, length_m, clearance_m, seen_m)
        if best is not None:
            return best
    return None


def _clearance_m(share: float, margin_m: float) -> float:
    return max(share * margin_m, _LEAST_CLEARANCE_M)


def _with_clearance(
    fence: Fence, routes: Routes, at: Point, towards: Point, clearance_m: float, seen: Seen | None = None
) -> Point | None:
    """A place with the clearance, in a straight line inside the fence unless `at` is outside: the nearest,
    else one of those a little farther off. The line leads away from what was seen.
    """
    if routes.is_free(at):
        return at
    is_outside = not fence.allows(at)
    stretches = () if seen is None else seen.stretches

    def is_exit(place: Point) -> bool:
        if not routes.is_free(place) or not (is_outside or not fence.crosses(at, place)):
            return False
        return all(_leads_away(at, place, one) for one in stretches)

    nearest = fence.inside(at, clearance_m + CIRCLE_ERROR_M)
    if is_exit(nearest):
        return nearest
    for radius in _EXIT_RADII:
        bearings = [math.tau * number / _EXIT_BEARINGS for number in range(_EXIT_BEARINGS)]
        radius_m = radius * clearance_m
        around = [at.moved(bearing, radius_m) for bearing in bearings]
        found = [place for place in around if is_exit(place)]
        if found:
            return min(found, key=lambda place: distance_m(place, towards))
    return None


def _leads_away(at: Point, place: Point, stretch: tuple[Point, Point]) -> bool:
    """Whether a straight leg comes no nearer to a stretch than it begins."""
    start, end = stretch
    return segment_distance2(*at, *place, *start, *end) >= _AWAY_SHARE * segment_distance2(
        *at, *at, *start, *end
    )


class WaterRoute:
    """leg: the present one, to the farthest corner in a straight line from its start. clearance_m: from the
    fence's lines, seen_m: from what was seen.
    """

    def __init__(self, is_clear: ClearLeg, start: Point, way: Way, config: BoatConfig) -> None:
        """way: with one corner or more; the last is the end."""
        self._is_clear = is_clear
        self._corners = way.corners
        self.clearance_m = way.clearance_m
        self.seen_m = way.seen_m
        self._at = 0
        self.leg = self._leg_from(start, 0, config)

    @property
    def corners_left(self) -> Sequence[Point]:
        """Where the boat is still to pass."""
        return self._corners[self._at :]

    def left_m(self, here: Point) -> float:
        """Length of the rest."""
        return path_length_m((here, *self.corners_left))

    @property
    def end(self) -> Point:
        return self._corners[-1]

    @property
    def is_straight(self) -> bool:
        """Whether it is one straight leg."""
        return len(self._corners) == 1

    @property
    def is_last(self) -> bool:
        """Whether the present leg is the last."""
        return self._at == len(self._corners) - 1

    def advance(self, nav: NavState, config: BoatConfig) -> bool:
        """Change to the next leg at each corner; returns whether the end is reached. A boat that was carried
        past a corner sails on from where it is: the corner is no place to be.
        """
        start = self.leg.start
        while self.leg.has_ended(nav, config.guidance.waypoint_radius_m):
            if self.is_last:
                return True
            self.leg = self._leg_from(self.leg.end, self._at + 1, config)
            start = self.leg.start
        if self.leg.start != start and not self.is_last:
            self.leg = self._leg_from(nav.point, self._at, config)
        return False

    def _leg_from(self, start: Point, first: int, config: BoatConfig) -> Leg:
        """The next leg: to the farthest corner, from `first` on, in a straight line."""
        self._at = at = self._farthest(start, first)
        corners = self._corners
        if self.is_last:
            return Leg(start, corners[at])
        onward = corners[self._farthest(corners[at], at + 1)]
        clearance_m = min(self.clearance_m, max(self.seen_m, _LEAST_CORNER * config.avoidance.margin_m))
        radius_m = min(config.guidance.waypoint_radius_m, _CORNER_SHARE * clearance_m)
        return Leg(start, corners[at], onward, radius_m)

    def _farthest(self, start: Point, first: int) -> int:
        """The farthest corner in a straight line; the first one in any case."""
        last = len(self._corners) - 1
        ahead, room_m = range(last, first, -1), (self.clearance_m, self.seen_m)
        return next((at for at in ahead if self._is_clear(start, self._corners[at], *room_m)), first)


def is_clear(fence: Fence, start: Point, end: Point, clearance_m: float) -> bool:
    """Whether a straight leg keeps the clearance of its ends, at most clearance_m."""
    least_m = min(fence.margin_m(start), fence.margin_m(end), clearance_m)
    return least_m > 0.0 and fence.is_clear(start, end, _CLEAR_SHARE * least_m)
