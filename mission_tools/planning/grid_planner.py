"""Routes on a grid of square cells: search, string pulling, and what to say when it fails."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import shapely

from companion.core.geo import Point, bearing_rad, distance_m, path_length_m
from companion.core.units import wrap_pi
from mission_tools.errors import NoRoute
from mission_tools.maps.chart import Chart
from mission_tools.planning.astar import astar, estimates
from mission_tools.planning.entry_cells import EntryCells, FreeWater
from mission_tools.planning.exact_planner import check_stops, water_of
from mission_tools.planning.grid import Bounds, EightNeighbours, Grid, occupancy
from mission_tools.planning.plan_settings import Plan, PlanSettings
from mission_tools.planning.smooth import (
    CORNER_CLEARANCES,
    MIN_LEG_CLEARANCES,
    merge_short_legs,
    pull_taut,
    widen_corners,
)
from mission_tools.planning.wording import stop_names, way_out_note

DEFAULT_WATER_CELLS = 200_000
DEFAULT_CELLS_PER_CLEARANCE = 4.0
REFINEMENTS = 2
"""How often the default cell is halved when it shows no route, so that a narrow passage is not overlooked."""
MAX_REFINED_GRID_CELLS = 16_000_000
MAX_PULL_POINTS = 600
MIN_LEG_CELLS = 3.0


def plan_on_grid(chart: Chart, stops: Sequence[Point], settings: PlanSettings) -> Plan:
    """Plan with the whole margin, in finer and finer cells. Raises what `plan` raises."""
    check_stops(chart, water_of(chart).routes(settings.required_m), stops, settings.required_m)
    bounds = _bounds(chart, stops, settings.required_m)
    sizes = [settings.cell_m] if settings.cell_m else _default_cells_m(chart, bounds, settings.required_m)
    failure: NoRoute | None = None
    for cell_m in sizes:
        try:
            return _Planner(chart, occupancy(chart, bounds, cell_m, settings.required_m), settings).plan(
                stops
            )
        except NoRoute as error:
            failure = error
    raise failure or NoRoute("no cell size to try")


def _bounds(chart: Chart, stops: Sequence[Point], clearance_m: float) -> Bounds:
    if not chart.is_open:
        west, south, east, north = chart.navigable.bounds
        return west, south, east, north
    outlines = [shapely.Point(stop.east_m, stop.north_m) for stop in stops]
    outlines += [feature.shape for feature in chart.features]
    west, south, east, north = shapely.union_all(outlines).bounds
    margin_m = 10.0 * clearance_m + 0.1 * math.hypot(east - west, north - south) + 1e-3
    return west - margin_m, south - margin_m, east + margin_m, north + margin_m


def _default_cells_m(chart: Chart, bounds: Bounds, clearance_m: float) -> list[float]:
    """A quarter of the clearance, or what the extent of the water allows; then finer ones to try."""
    west, south, east, north = bounds
    extent_m2 = (east - west) * (north - south)
    area_m2 = min(chart.navigable.area, extent_m2)
    first = max(clearance_m / DEFAULT_CELLS_PER_CLEARANCE, math.sqrt(area_m2 / DEFAULT_WATER_CELLS))
    finer = [first / 2**n for n in range(1, REFINEMENTS + 1)]
    return [first, *(cell_m for cell_m in finer if extent_m2 / cell_m**2 <= MAX_REFINED_GRID_CELLS)]


class _Planner:
    """One grid, and the legs planned on it."""

    def __init__(self, chart: Chart, grid: Grid, settings: PlanSettings) -> None:
        self._chart = chart
        self._grid = grid
        self._settings = settings
        self._expansion = EightNeighbours(grid)
        self._water = FreeWater(chart, grid, settings.required_m)

    def plan(self, stops: Sequence[Point]) -> Plan:
        water, settings = self._water, self._settings
        entries = [water.entry_from_start(stops[0])]
        named = zip(stops[1:], stop_names(stops), strict=True)
        entries += [water.entry_to_stop(stop, name) for stop, name in named]
        notes: list[str] = []
        legs = [self._leg(stops[n : n + 2], entries[n], entries[n + 1]) for n in range(len(stops) - 1)]
        min_clearance_m = min(
            self._chart.leg_clearance_m(a, b) for leg in legs for a, b in pairwise(leg.points)
        )
        points: tuple[Point, ...] = (*(point for leg in legs for point in leg.points[:-1]), stops[-1])
        here_m = self._chart.clearance_m(stops[0])
        if here_m < settings.clearance_m:
            way_out = legs[0].points[0]
            points = (stops[0], *points)
            notes.append(way_out_note(self._chart, stops[0], way_out, settings.clearance_m))
        return Plan(
            points=points,
            found=tuple(point for leg in legs for point in leg.grid_path),
            length_m=path_length_m(points),
            straight_m=path_length_m(stops),
            min_clearance_m=min_clearance_m,
            cell_m=self._grid.cell_m,
            expanded=sum(leg.expanded for leg in legs),
            settings=settings,
            notes=tuple(notes),
        )

    def _leg(self, ends: Sequence[Point], out: EntryCells, into: EntryCells) -> "_Leg":
        start, goal = ends
        shared = out.cells.keys() & into.cells.keys()
        if not shared:
            raise NoRoute(self._water.no_route(start, goal))
        grid = self._grid
        region = min(
            shared,
            key=lambda r: (
                distance_m(start, grid.centre(out.cells[r])) + distance_m(goal, grid.centre(into.cells[r]))
            ),
        )
        first, last = out.cells[region], into.cells[region]
        ahead = estimates(self._settings.heuristic or "octile", grid, last)
        found = astar(self._expansion, ahead, first, last)
        centres = [grid.centre(cell) for cell in found.cells]
        path = tuple(centres) if out.is_relaxed else (start, *centres)
        path = (*path, goal)
        return _Leg(self._smoothed(path) if self._settings.smooth else _corners(path), path, found.expanded)

    def _smoothed(self, path: tuple[Point, ...]) -> tuple[Point, ...]:
        clearance_m = self._settings.required_m

        def is_clear(a: Point, b: Point) -> bool:
            return self._chart.is_clear(a, b, clearance_m)

        length_m = path_length_m(path)
        spacing_m = max(self._grid.cell_m, length_m / MAX_PULL_POINTS)
        taut = pull_taut(path, is_clear, spacing_m)
        min_leg_m = max(MIN_LEG_CLEARANCES * clearance_m, MIN_LEG_CELLS * self._grid.cell_m)
        merged = merge_short_legs(taut, is_clear, min_leg_m, length_m)
        return widen_corners(merged, is_clear, CORNER_CLEARANCES * clearance_m, length_m)


@dataclass(frozen=True, slots=True)
class _Leg:
    points: tuple[Point, ...]
    grid_path: tuple[Point, ...]
    expanded: int


def _corners(path: tuple[Point, ...]) -> tuple[Point, ...]:
    """The same path without the points on its straight stretches."""
    kept = [path[0]]
    for before, here, after in zip(path, path[1:], path[2:], strict=False):
        if abs(wrap_pi(bearing_rad(here, after) - bearing_rad(before, here))) > 1e-9:
            kept.append(here)
    return (*kept, path[-1])
