"""The cheapest route where metres differ in cost: in a current, in slow zones, near shores.

Dijkstra's search over a lattice of the water with sixteen directions finds on which side of what the cheapest
route passes. Straight legs then replace its steps wherever that costs no more (dynamic programming over its
points), and each corner moves to where its two legs cost least. The shortest route is polished in the same
way: the cheaper of the two is never dearer than the shortest.

In a current that changes, both the search (`time_search.py`) and the legs (`legs.py`) are timed. Where it has
to wait for the current, the boat leaves later: by FIFO that costs no time against waiting under way.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from companion.core.geo import Point, distance_m, path_length_m
from mission_tools.costs.legs import leg_costs, route_costs
from mission_tools.costs.polish import Polish
from mission_tools.costs.time_search import LONGEST_WAIT_S, cheapest_cells
from mission_tools.costs.travel import Travel
from mission_tools.errors import NoRoute
from mission_tools.maps.chart import Chart
from mission_tools.planning.astar import walk_back
from mission_tools.planning.exact_planner import own_clearances
from mission_tools.planning.grid import Grid, occupancy

LATTICE_CELLS = 60_000
DETOUR = 0.35
"""Of the shortest route's length: how far beyond its extent the lattice reaches."""
_STEPS = ((0, 1), (1, 0), (1, 1), (1, -1), (1, 2), (2, 1), (2, -1), (1, -2))
"""Rows and columns; with their opposites sixteen directions, 18 to 27° apart."""
_DIRECTIONS = (*_STEPS, *((-up, -right) for up, right in _STEPS))
_FARTHEST_STEP_CELLS = math.sqrt(5.0)


@dataclass(frozen=True, slots=True)
class CheapestRoute:
    """Start and goal included. cost, shortest_cost: in the travel's unit; infinite: cannot be sailed.

    wait_s: how much later than asked the boat leaves; a cost in seconds contains it. arrive_s: at the goal.
    Both only where the travel changes with time.
    """

    points: tuple[Point, ...]
    cost: float
    shortest_cost: float
    wait_s: float = 0.0
    arrive_s: float = 0.0


def cheapest_route(
    chart: Chart,
    shortest: Sequence[Point],
    clearance_m: float,
    travel: Travel,
    depart_s: float = 0.0,
    coarser: float = 1.0,
) -> CheapestRoute:
    """Improve on a shortest route: from its first to its last point, with the same clearance.

    Where the shortest route begins nearer to a shore than the clearance, its first leg stays. coarser: times
    the side of the lattice's cells. Raises NoRoute: every route meets a current that cannot be stemmed; names
    the place.
    """
    points = tuple(shortest)
    way_out: tuple[Point, ...] = ()
    if len(points) > 2 and chart.clearance_m(points[0]) < clearance_m:
        way_out, points = points[:1], points[1:]
    grid = _lattice(chart, points, clearance_m, coarser)
    polish = Polish(chart, clearance_m, travel, grid.cell_m)
    begin_s = depart_s
    if way_out:
        begin_s += float(leg_costs(travel, way_out, points[:1], grid.cell_m, depart_s)[1][0])
    shortest_cost = polish.cost(points, begin_s)
    paths = [(points, begin_s)] if math.isfinite(shortest_cost) else []
    found = _search(grid, travel, points[0], points[-1], polish.is_clear, begin_s)
    if found is not None:
        paths.append((found[0], polish.leave_s(found[0], begin_s, found[1])))
    improved = [(polish.improved(path, leave_s), leave_s) for path, leave_s in paths]
    timed = [
        (path, polish.leave_s(path, begin_s, at_s)) for path, at_s in improved if polish.is_sailable(path)
    ]
    if not timed and not math.isfinite(shortest_cost):
        raise NoRoute(_swept(chart, travel, points, begin_s))

    def cost(path: Sequence[Point], leave_s: float) -> float:
        return polish.cost(path, leave_s) + (leave_s - begin_s if travel.unit == "s" else 0.0)

    best, leave_s = min((*timed, (points, begin_s)), key=lambda one: cost(*one))
    wait_s = leave_s - begin_s
    arrive_s = float(route_costs(travel, best, grid.cell_m, np.array([leave_s]))[1][-1, 0])
    return CheapestRoute((*way_out, *best), cost(best, leave_s), shortest_cost, wait_s, arrive_s)


def _lattice(chart: Chart, points: Sequence[Point], clearance_m: float, coarser: float = 1.0) -> Grid:
    """Free water round the shortest route; each step of any of the directions keeps the clearance."""
    norths, easts = [p.north_m for p in points], [p.east_m for p in points]
    length = path_length_m(points)
    beyond = DETOUR * length + 2.0 * clearance_m
    west, south, east, north = min(easts), min(norths), max(easts), max(norths)
    west, south, east, north = west - beyond, south - beyond, east + beyond, north + beyond
    if not chart.is_open:
        inner = chart.navigable.bounds
        west, south = max(west, inner[0]), max(south, inner[1])
        east, north = min(east, inner[2]), min(north, inner[3])
    cell_m = max(coarser * math.sqrt((east - west) * (north - south) / LATTICE_CELLS), 0.25)
    # `occupancy` allows for steps of √2 cells; these are longer
    longer = math.sqrt(clearance_m**2 + 0.25 * (_FARTHEST_STEP_CELLS**2 - 2.0) * cell_m**2)
    grid = occupancy(chart, (west, south, east, north), cell_m, longer)
    step_m = _FARTHEST_STEP_CELLS * cell_m
    easts_m, norths_m = grid.centres()
    for shape, own_m in own_clearances(chart):
        if own_m > clearance_m:
            row, column = np.nonzero(grid.free)
            off_m = shapely.distance(shapely.points(easts_m[column], norths_m[row]), shape)
            near = off_m < math.hypot(own_m, 0.5 * step_m)
            grid.free[row[near], column[near]] = False
    return grid


def _search(
    grid: Grid,
    travel: Travel,
    start: Point,
    goal: Point,
    is_clear: Callable[[Point, Point], bool],
    depart_s: float = 0.0,
) -> tuple[tuple[Point, ...], float] | None:
    """The cheapest path over the lattice and when it arrives, waits included; None if there is none.

    Where the travel does not change with time, that is depart_s.
    """
    first, last = (_nearest_cell(grid, place, is_clear) for place in (start, goal))
    if first is None or last is None:
        return None
    if travel.varies:
        found = cheapest_cells(grid, travel, _DIRECTIONS, first, last, depart_s)
        return found and ((start, *map(grid.centre, found[0]), goal), found[1])
    rows, columns = grid.free.shape
    number = np.arange(rows * columns).reshape(rows, columns)
    east, north = grid.centres()
    tails, heads, costs = [], [], []
    for up, right in _DIRECTIONS:
        here = (slice(max(0, -up), rows - max(0, up)), slice(max(0, -right), columns - max(0, right)))
        there = (slice(max(0, up), rows - max(0, -up)), slice(max(0, right), columns - max(0, -right)))
        both = grid.free[here] & grid.free[there]
        tail, head = number[here][both], number[there][both]
        middle_n = north[tail // columns] + 0.5 * up * grid.cell_m
        middle_e = east[tail % columns] + 0.5 * right * grid.cell_m
        course = np.full(middle_n.shape, math.atan2(right, up))
        per_m = travel.per_m(middle_n, middle_e, course, np.zeros_like(course))
        cost = per_m * grid.cell_m * math.hypot(up, right)
        can = np.isfinite(cost)
        tails.append(tail[can])
        heads.append(head[can])
        costs.append(cost[can])
    size = rows * columns
    graph = coo_matrix(
        (np.concatenate(costs), (np.concatenate(tails), np.concatenate(heads))), shape=(size, size)
    ).tocsr()
    cost_to, before = dijkstra(graph, indices=first, return_predecessors=True)
    if not math.isfinite(cost_to[last]):
        return None
    return (start, *map(grid.centre, walk_back(before, first, last)), goal), depart_s


def _nearest_cell(grid: Grid, place: Point, is_clear: Callable[[Point, Point], bool]) -> int | None:
    """The nearest free cell that a clear straight leg joins to a place."""
    east, north = grid.centres()
    free: NDArray[np.intp] = np.flatnonzero(grid.free)
    away = np.hypot(north[free // grid.columns] - place.north_m, east[free % grid.columns] - place.east_m)
    for index in np.argsort(away, kind="stable")[:64]:
        if is_clear(place, grid.centre(int(free[index]))):
            return int(free[index])
    return None


def _swept(chart: Chart, travel: Travel, points: Sequence[Point], begin_s: float) -> str:
    """Where the shortest route first meets what the boat cannot stem."""
    waiting = ""
    if travel.varies and travel.unit == "s":
        waiting = f", also after {LONGEST_WAIT_S / 3600.0:.0f} h of waiting"
    line = shapely.LineString([(p.east_m, p.north_m) for p in points])
    now_s = begin_s
    for a, b in pairwise(points):
        course = np.full(1, math.atan2(b.east_m - a.east_m, b.north_m - a.north_m))
        for share in np.linspace(0.0, 1.0, 64):
            north = a.north_m + share * (b.north_m - a.north_m)
            east = a.east_m + share * (b.east_m - a.east_m)
            at = np.full(1, north), np.full(1, east), course, np.full(1, now_s)
            if not np.isfinite(travel.per_m(*at)).all():
                place = chart.frame.to_global(Point(north, east))
                along_m = line.project(shapely.Point(east, north))
                return (
                    f"current or wind is too strong for the boat on every way{waiting}: first at "
                    f"{place.lat_deg:.6f},{place.lon_deg:.6f}, {along_m:.0f} m along the shortest one"
                )
            now_s += float(travel.pace.per_m(*at)[0]) * distance_m(a, b) / 63.0
    return f"current or wind is too strong for the boat on every way{waiting}"
