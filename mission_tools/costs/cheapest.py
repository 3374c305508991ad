"""The cheapest route where metres differ in cost: in a current, in slow zones, near shores.

Dijkstra's search over a lattice of the water with sixteen directions finds on which side of what the cheapest
route passes. Straight legs then replace its steps wherever that costs no more (dynamic programming over its
points), and each corner moves to where its two legs cost least. The shortest route is polished in the same
way: the cheaper of the two is never dearer than the shortest.
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
from mission_tools.costs.travel import Floats, Travel
from mission_tools.errors import NoRoute
from mission_tools.maps.chart import Chart
from mission_tools.planning.exact_planner import own_clearances, water_of
from mission_tools.planning.grid import Grid, occupancy

LATTICE_CELLS = 60_000
DETOUR = 0.35
"""Of the shortest route's length: how far beyond its extent the lattice reaches."""
LEG_SHARE = 0.001
"""Of the whole cost: what a corner more has to save, so that a curve is not cut into dozens of legs."""
_LEAST_SAMPLES, _MOST_SAMPLES = 16, 400
"""Along a leg; in between one a cell."""
_MOST_POINTS = 120
"""Of a path that legs are laid along: dynamic programming tries every pair."""
_PASSES = 6
_ROUND = ((0, 0), *((up, right) for up in (-1, 0, 1) for right in (-1, 0, 1) if up or right))
_STEPS = ((0, 1), (1, 0), (1, 1), (1, -1), (1, 2), (2, 1), (2, -1), (1, -2))
"""Rows and columns; with their opposites sixteen directions, 18 to 27° apart."""
_FARTHEST_STEP_CELLS = math.sqrt(5.0)


@dataclass(frozen=True, slots=True)
class CheapestRoute:
    """Start and goal included. cost, shortest_cost: in the travel's unit; infinite: cannot be sailed."""

    points: tuple[Point, ...]
    cost: float
    shortest_cost: float


def route_cost(travel: Travel, points: Sequence[Point], spacing_m: float = 1.0) -> float:
    """Cost of all legs, with samples about spacing_m apart."""
    return sum(float(_leg_costs(travel, [a], [b], spacing_m)[0]) for a, b in pairwise(points))


def _leg_costs(travel: Travel, starts: Sequence[Point], ends: Sequence[Point], spacing_m: float) -> Floats:
    """Cost of straight legs by the midpoint rule; a single start or end belongs to every leg."""
    begin, to = np.asarray(starts, dtype=np.float64), np.asarray(ends, dtype=np.float64)
    north, east = (to - begin).T
    length = np.hypot(north, east)
    number = int(np.clip(length.max() / spacing_m, _LEAST_SAMPLES, _MOST_SAMPLES))
    share = (np.arange(number, dtype=np.float64)[:, np.newaxis] + 0.5) / number
    course = np.broadcast_to(np.arctan2(east, north), (number, len(length)))
    per_m = travel.per_m(
        begin[:, 0] + share * north, begin[:, 1] + share * east, course, np.zeros_like(course)
    )
    return np.where(length > 0.0, per_m.mean(axis=0) * length, 0.0)


def cheapest_route(
    chart: Chart, shortest: Sequence[Point], clearance_m: float, travel: Travel
) -> CheapestRoute:
    """Improve on a shortest route: from its first to its last point, with the same clearance.

    Where the shortest route begins nearer to a shore than the clearance, its first leg stays. Raises NoRoute:
    every route meets a current that cannot be stemmed; names the place.
    """
    points = tuple(shortest)
    way_out: tuple[Point, ...] = ()
    if len(points) > 2 and chart.clearance_m(points[0]) < clearance_m:
        way_out, points = points[:1], points[1:]
    grid = _lattice(chart, points, clearance_m)
    polish = _Polish(chart, clearance_m, travel, grid.cell_m)
    shortest_cost = polish.cost(points)
    candidates = [points] if math.isfinite(shortest_cost) else []
    found = _search(grid, travel, points[0], points[-1], polish.is_clear)
    if found is not None:
        candidates.append(found)
    improved = [path for path in map(polish.improved, candidates) if polish.is_sailable(path)]
    if not improved and not math.isfinite(shortest_cost):
        raise NoRoute(_swept(chart, travel, points))
    best = min((*improved, points), key=polish.cost)
    return CheapestRoute((*way_out, *best), polish.cost(best), shortest_cost)


def _lattice(chart: Chart, points: Sequence[Point], clearance_m: float) -> Grid:
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
    cell_m = max(math.sqrt((east - west) * (north - south) / LATTICE_CELLS), 0.25)
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
    grid: Grid, travel: Travel, start: Point, goal: Point, is_clear: Callable[[Point, Point], bool]
) -> tuple[Point, ...] | None:
    """The cheapest path over the lattice; None if it does not join start and goal."""
    first, last = (_nearest_cell(grid, place, is_clear) for place in (start, goal))
    if first is None or last is None:
        return None
    rows, columns = grid.free.shape
    number = np.arange(rows * columns).reshape(rows, columns)
    east, north = grid.centres()
    tails, heads, costs = [], [], []
    for up, right in (*_STEPS, *((-up, -right) for up, right in _STEPS)):
        here = (slice(max(0, -up), rows - max(0, up)), slice(max(0, -right), columns - max(0, right)))
        there = (slice(max(0, up), rows - max(0, -up)), slice(max(0, right), columns - max(0, -right)))
        both = grid.free[here] & grid.free[there]
        tail, head = number[here][both], number[there][both]
        middle_n = north[tail // columns] + 0.5 * up * grid.cell_m
        middle_e = east[tail % columns] + 0.5 * right * grid.cell_m
        course = np.full(middle_n.shape, math.atan2(right, up))
        cost = (
            travel.per_m(middle_n, middle_e, course, np.zeros_like(course))
            * grid.cell_m
            * math.hypot(up, right)
        )
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
    cells = [last]
    while cells[-1] != first:
        cells.append(int(before[cells[-1]]))
    return (start, *(grid.centre(cell) for cell in reversed(cells)), goal)


def _nearest_cell(grid: Grid, place: Point, is_clear: Callable[[Point, Point], bool]) -> int | None:
    """The nearest free cell that a clear straight leg joins to a place."""
    east, north = grid.centres()
    free: NDArray[np.intp] = np.flatnonzero(grid.free)
    away = np.hypot(north[free // grid.columns] - place.north_m, east[free % grid.columns] - place.east_m)
    for index in np.argsort(away, kind="stable")[:64]:
        if is_clear(place, grid.centre(int(free[index]))):
            return int(free[index])
    return None


class _Polish:
    """Fewer and better placed corners for a path, by cost."""

    def __init__(self, chart: Chart, clearance_m: float, travel: Travel, cell_m: float) -> None:
        self._routes = water_of(chart).routes(clearance_m)
        self._travel, self._cell_m = travel, cell_m

    def is_clear(self, start: Point, end: Point) -> bool:
        """Whether a leg may be sailed."""
        return self._routes.is_clear(start, end)

    def is_sailable(self, path: Sequence[Point]) -> bool:
        """Whether every leg may be sailed: the lattice knows no clearance that a feature asks for itself."""
        return all(self.is_clear(a, b) for a, b in pairwise(path))

    def cost(self, points: Sequence[Point]) -> float:
        """Of a whole path."""
        return route_cost(self._travel, points, self._cell_m)

    def improved(self, path: tuple[Point, ...]) -> tuple[Point, ...]:
        """The same way with straight legs and better corners."""
        most = _MOST_POINTS
        while not self.is_sailable(_thinned(path, most)) and most < len(path):
            most *= 2
        best = self._laid(_thinned(path, most))
        for halving in range(_PASSES):
            best = self._laid(self._moved(best, 2.0 * self._cell_m * 0.5**halving))
        return best

    def _legs(self, starts: Sequence[Point], ends: Sequence[Point]) -> Floats:
        return _leg_costs(self._travel, starts, ends, self._cell_m)

    def _are_clear(self, start: Point, ends: Sequence[Point]) -> NDArray[np.bool_]:
        return np.array([self.is_clear(start, end) for end in ends], dtype=np.bool_)

    def _laid(self, path: Sequence[Point]) -> tuple[Point, ...]:
        """The cheapest chain of clear legs through some of the path's points; each leg more has to pay."""
        number = len(path)
        corner = LEG_SHARE * self.cost(path)
        cheapest = np.full(number, np.inf)
        before = np.zeros(number, dtype=np.intp)
        cheapest[0] = 0.0
        for here in range(number - 1):
            if not math.isfinite(cheapest[here]):
                continue
            ends = path[here + 1 :]
            cost = cheapest[here] + self._legs([path[here]], ends) + corner
            cheaper = np.flatnonzero(cost < cheapest[here + 1 :])
            cheaper = cheaper[self._are_clear(path[here], [ends[int(index)] for index in cheaper])]
            cheapest[here + 1 + cheaper] = cost[cheaper]
            before[here + 1 + cheaper] = here
        if not math.isfinite(cheapest[-1]):
            return tuple(path)
        chain = [number - 1]
        while chain[-1]:
            chain.append(int(before[chain[-1]]))
        return tuple(path[index] for index in reversed(chain))

    def _moved(self, points: tuple[Point, ...], by_m: float) -> tuple[Point, ...]:
        """Every corner, and the middle of every leg, moved to the cheapest of nine places by_m apart."""
        path = list(_with_middles(points, 4.0 * self._cell_m))
        for index in range(1, len(path) - 1):
            a, here, b = path[index - 1 : index + 2]
            tried = [Point(here.north_m + up * by_m, here.east_m + right * by_m) for up, right in _ROUND]
            costs = self._legs([a], tried) + self._legs(tried, [b])
            clear = self._are_clear(a, tried) & self._are_clear(b, tried)
            clear[0] = True  # as it is
            path[index] = tried[int(np.argmin(np.where(clear, costs, np.inf)))]
        return tuple(path)


def _thinned(path: tuple[Point, ...], most: int) -> tuple[Point, ...]:
    """At most so many points of a path, evenly; first and last stay."""
    if len(path) <= most:
        return path
    return tuple(path[round(index)] for index in np.linspace(0, len(path) - 1, most))


def _with_middles(points: tuple[Point, ...], least_m: float) -> tuple[Point, ...]:
    """The path with the middle of every leg longer than this."""
    path = [points[0]]
    for a, b in pairwise(points):
        if distance_m(a, b) > least_m:
            path.append(Point(0.5 * (a.north_m + b.north_m), 0.5 * (a.east_m + b.east_m)))
        path.append(b)
    return tuple(path)


def _swept(chart: Chart, travel: Travel, points: Sequence[Point]) -> str:
    """Where the shortest route first meets a current that the boat cannot stem."""
    line = shapely.LineString([(p.east_m, p.north_m) for p in points])
    for a, b in pairwise(points):
        course = np.full(1, math.atan2(b.east_m - a.east_m, b.north_m - a.north_m))
        for share in np.linspace(0.0, 1.0, 64):
            north = a.north_m + share * (b.north_m - a.north_m)
            east = a.east_m + share * (b.east_m - a.east_m)
            if not np.isfinite(travel.per_m(np.full(1, north), np.full(1, east), course, np.zeros(1))).all():
                at = chart.frame.to_global(Point(north, east))
                along_m = line.project(shapely.Point(east, north))
                return (
                    f"the current is too strong for the boat on every way: first at {at.lat_deg:.6f},"
                    f"{at.lon_deg:.6f}, {along_m:.0f} m along the shortest one"
                )
    return "the current is too strong for the boat on every way"
