"""What is left of a mission, led round obstacles that the chart does not have.

Only the blocked legs change: the route round them joins the mission again at the first waypoint that is free.
Everything else, commands and holds included, stays as it was.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import Final, NamedTuple

import shapely
from shapely.geometry import MultiPolygon, Polygon

from companion.core.geo import Point, distance_m
from companion.planning.visibility import NoWay, Routes
from companion.planning.water import Shore, Water
from mission_tools.errors import NoRoute
from mission_tools.maps.chart import Chart
from mission_tools.mission.mission import Command, Mission, MissionItem

SIGHTED_CLEARANCE_M: Final = 2.0
"""Kept from what was seen: half a metre of boat, half a cell, and a receiver's wander of a metre."""
DETOUR_M: Final = 3.5
"""Planned from what was seen: what lies just beyond its edge then does not block the detour, too."""
_DETOURS: Final = 20  # in one mission; more are a chart that does not fit the water


class Remainder(NamedTuple):
    """What is left to do: items from the current one on, and where each leads; None for a command."""

    items: tuple[MissionItem, ...]
    points: tuple[Point | None, ...]


def remainder_of(items: Sequence[MissionItem], chart: Chart, current: int) -> Remainder:
    """The items from index `current` on (0: the first after home), after the last speed that was set before.
    Raises NoRoute: the mission jumps: what is left of it depends on how often it has.
    """
    if any(item.command == Command.DO_JUMP for item in items):
        raise NoRoute("the mission jumps (DO_JUMP): what is left of it cannot be planned anew")
    speeds = [item for item in items[:current] if item.command == Command.DO_CHANGE_SPEED]
    left = (*speeds[-1:], *items[current:])
    return Remainder(left, tuple(None if i.place is None else chart.frame.to_local(i.place) for i in left))


def is_blocked(here: Point, left: Remainder, seen: Polygon | MultiPolygon) -> bool:
    """Whether a leg that is left comes too near to what was seen."""
    return _first_blocked([here, *(point for point in left.points if point is not None)], seen) is not None


def around(
    chart: Chart, water: Water, here: Point, left: Remainder, seen: Polygon | MultiPolygon, clearance_m: float
) -> tuple[Mission, frozenset[int]]:
    """The mission that is left, from here, clear of what was seen; and the indices of the detours' items.
    Raises NoRoute: what was seen lies on the last waypoint, or closes every way.
    """
    wide = water.with_shores(_rings(seen, DETOUR_M)).routes(clearance_m)
    narrow = water.with_shores(_rings(seen, SIGHTED_CLEARANCE_M)).routes(clearance_m)
    items, points = list(left.items), list(left.points)
    added: list[MissionItem] = []
    for _ in range(_DETOURS):
        stops = [number for number, point in enumerate(points) if point is not None]
        path = [here, *(point for point in points if point is not None)]
        blocked = _first_blocked(path, seen)
        if blocked is None:
            inserted = frozenset(n for n, item in enumerate(items) if any(item is one for one in added))
            return Mission(tuple(items), home=chart.frame.to_global(here)), inserted
        joins = _first_free(path, blocked + 1, seen)
        if joins is None:
            raise NoRoute("an obstacle lies on the last waypoint: stop the boat, or choose another goal")
        try:
            way = _route(wide, path[blocked], path[joins])
        except NoRoute:
            way = _route(narrow, path[blocked], path[joins])
        way = _thinned(narrow, [path[blocked], *way, path[joins]])[1:-1]
        first = stops[blocked]  # the item that the blocked leg leads to
        dropped = [number for number in stops if first <= number < stops[joins - 1]]
        items = [item for number, item in enumerate(items) if number not in dropped]
        points = [point for number, point in enumerate(points) if number not in dropped]
        # Commands before the waypoint where it joins again are carried out on the way, as before
        detour = [MissionItem.at(chart.frame.to_global(point)) for point in way]
        added += detour
        items[first:first] = detour
        points[first:first] = list(way)
    raise NoRoute(f"more than {_DETOURS} detours: the chart does not fit what the boat sees")


def _first_blocked(path: Sequence[Point], seen: Polygon | MultiPolygon) -> int | None:
    """The index of the first leg's start that comes too near; the boat's own leg may lead away from it."""
    if seen.is_empty:
        return None
    for index, (a, b) in enumerate(pairwise(path)):
        leg = shapely.LineString([(a.east_m, a.north_m), (b.east_m, b.north_m)])
        gap_m = float(seen.distance(leg))
        if gap_m < SIGHTED_CLEARANCE_M - 1e-6 and not (index == 0 and _leads_away(a, b, seen, gap_m)):
            return index
    return None


def _leads_away(start: Point, end: Point, seen: Polygon | MultiPolygon, gap_m: float) -> bool:
    """Whether a leg is nearest to what was seen where it begins."""
    here = shapely.Point(start.east_m, start.north_m)
    return bool(
        gap_m > 0.0
        and seen.distance(here) <= gap_m + 1e-6
        and seen.distance(shapely.Point(end.east_m, end.north_m)) >= SIGHTED_CLEARANCE_M
    )


def _first_free(path: Sequence[Point], first: int, seen: Polygon | MultiPolygon) -> int | None:
    for index in range(first, len(path)):
        at = shapely.Point(path[index].east_m, path[index].north_m)
        if seen.distance(at) >= SIGHTED_CLEARANCE_M:
            return index
    return None


def _rings(seen: Polygon | MultiPolygon, by_m: float) -> list[Shore]:
    """The outlines of what was seen; water that it encloses is no way through."""
    outlines = [part.exterior.coords[:-1] for part in shapely.get_parts(seen)]
    return [Shore([Point(north, east) for east, north in outline], by_m) for outline in outlines]


def _route(routes: Routes, start: Point, goal: Point) -> list[Point]:
    """Corners between two places; a boat too near leaves by the shortest way. Raises NoRoute: no way."""
    way_out: list[Point] = []
    if not routes.is_free(start):
        free = next(routes.exits(start), None)
        if free is None:
            raise NoRoute("the boat is shut in by what it sees")
        way_out, start = [free], free
    try:
        return [*way_out, *routes.route(start, goal).points[1:-1]]
    except NoWay as error:
        if error.reason == "goal":  # the mission's own waypoint has less than the clearance: leave it so
            free = error.nearest
            if free is not None and distance_m(free, goal) < SIGHTED_CLEARANCE_M:
                return [*way_out, *_route(routes, start, free), free]
        raise NoRoute("no water is left between the boat and its next waypoints") from None


def _thinned(routes: Routes, path: list[Point]) -> list[Point]:
    """The path without the corners that its neighbours can do without."""
    kept, at = [path[0]], 0
    while at < len(path) - 1:
        clear = [n for n in range(at + 2, len(path)) if routes.is_clear(path[at], path[n])]
        at = max(clear, default=at + 1)
        kept.append(path[at])
    return kept
