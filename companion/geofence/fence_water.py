"""The fence as water between shores, and the shortest way through it.

The boat must be inside every inclusion area and outside every exclusion area. Circles become polygons that
keep them: inscribed to an inclusion circle, circumscribed about an exclusion circle.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

from companion.core.geo import Point, distance_m
from companion.geofence.fence import Fence
from companion.geofence.separation import Separation
from companion.planning.area_shores import CIRCLE_ERROR_M, corners_of, outside_of
from companion.planning.visibility import NoWay, Routes
from companion.planning.water import Shore, Water

MARGIN_SHARES = (1.5, 0.75, 0.25)
"""Clearances of a way in shares of fence.margin_m, tried one after the other: the brake acts within 1."""
_LEAST_CLEARANCE_M = 0.05
_FRAME_M = 1.0  # between areas and the frame round them
_EXIT_RADII = (0.5, 1.0, 2.0, 4.0)  # clearances
_EXIT_BEARINGS = 16


class Way(NamedTuple):
    """Corners after the start; the last is the goal. clearance_m: from the lines, except at the ends."""

    corners: tuple[Point, ...]
    length_m: float
    clearance_m: float


class FenceWater:
    """The allowed water of an active fence, and what parts it."""

    def __init__(self, fence: Fence) -> None:
        held = [corners_of(area) for area in fence.areas if area.is_inclusion]
        barred = [corners_of(area) for area in fence.areas if not area.is_inclusion]
        frame = (
            min(area.south_m for area in fence.areas) - _FRAME_M,
            min(area.west_m for area in fence.areas) - _FRAME_M,
            max(area.north_m for area in fence.areas) + _FRAME_M,
            max(area.east_m for area in fence.areas) + _FRAME_M,
        )
        water = Water([Shore(corners) for corners in held[:1]], is_open=not held)
        outsides = [outside_of(corners, frame) for corners in held[1:]]
        self.water = water.with_shores([*outsides, *(Shore(corners) for corners in barred)])
        self._rings = [*held, *barred]
        self._separations: dict[float, Separation] = {}

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
    for share in shares:
        clearance_m = _clearance_m(share, margin_m)
        best: Way | None = None
        routes = water.water.routes(clearance_m)
        start: Point | None = None
        for away_m, goal in sorted((distance_m(here, goal), goal) for goal in goals):
            if best is not None and away_m >= best.length_m:
                break
            start = start or _with_clearance(fence, routes, here, goal, clearance_m)
            end = _with_clearance(fence, routes, goal, here, clearance_m)
            if start is None or end is None:
                continue
            if not routes.is_clear(start, end) and water.separation(clearance_m).parts(start, end):
                continue  # sooner known than by a search, which would look everywhere
            try:
                route = routes.route(start, end)
            except NoWay:
                continue
            length_m = distance_m(here, start) + route.length_m + distance_m(end, goal)
            if best is None or length_m < best.length_m:
                corners = (*route.points[start == here :], *((goal,) if end != goal else ()))
                best = Way(corners, length_m, clearance_m)
        if best is not None:
            return best
    return None


def _clearance_m(share: float, margin_m: float) -> float:
    return max(share * margin_m, _LEAST_CLEARANCE_M)


def _with_clearance(
    fence: Fence, routes: Routes, at: Point, towards: Point, clearance_m: float
) -> Point | None:
    """A place with the clearance, in a straight line inside the fence unless `at` is outside: the nearest,
    else one of those a little farther off.
    """
    if routes.is_free(at):
        return at
    is_outside = not fence.allows(at)

    def is_exit(place: Point) -> bool:
        return routes.is_free(place) and (is_outside or not fence.crosses(at, place))

    nearest = fence.inside(at, clearance_m + CIRCLE_ERROR_M)
    if is_exit(nearest):
        return nearest
    for radius in _EXIT_RADII:
        bearings = [math.tau * number / _EXIT_BEARINGS for number in range(_EXIT_BEARINGS)]
        radius_m = radius * clearance_m
        around = [
            Point(at.north_m + radius_m * math.cos(b), at.east_m + radius_m * math.sin(b)) for b in bearings
        ]
        found = [place for place in around if is_exit(place)]
        if found:
            return min(found, key=lambda place: distance_m(place, towards))
    return None
