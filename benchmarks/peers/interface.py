"""What every comparison planner gets and gives, and the check that no invalid path leaves."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import TypeAlias

from companion.core.geo import Point, path_length_m
from companion.planning.water import Water
from mission_tools.errors import NoRouteError
from mission_tools.maps.chart import Chart
from mission_tools.planning.entry_cells import FreeWater
from mission_tools.planning.exact_planner import water_of
from mission_tools.planning.grid import Grid, occupancy

Path: TypeAlias = tuple[Point, ...]
Planner: TypeAlias = Callable[["Sea", Point, Point, int, "Deadline", float], Path]


class NoPath(Exception):  # noqa: N818  (a planner's answer)
    """A planner found no path; says why."""


@dataclass(frozen=True, slots=True)
class Planned:
    """A path from start to goal whose legs all keep the clearance, and the CPU time it took."""

    points: Path
    length_m: float
    cpu_s: float


@dataclass(frozen=True, slots=True)
class Failed:
    """No path, or one that does not keep the clearance, and why."""

    reason: str
    cpu_s: float


class Deadline:
    """The end of a planner's time. Paths of a seed are the same as long as it is not reached."""

    def __init__(self, budget_s: float) -> None:
        self._end_s = time.thread_time() + budget_s

    @property
    def is_over(self) -> bool:
        """Whether the time is over."""
        return time.thread_time() > self._end_s

    def check(self) -> None:
        """Raises NoPath when the time is over."""
        if self.is_over:
            raise NoPath("out of time")


@dataclass(frozen=True, eq=False)
class Sea:
    """A chart and the clearance to keep from its shores."""

    chart: Chart
    clearance_m: float

    @cached_property
    def water(self) -> Water:
        """The exact geometry."""
        return water_of(self.chart)

    def is_clear(self, start: Point, end: Point) -> bool:
        """Whether a leg keeps the clearance."""
        return self.water.is_clear(start, end, self.clearance_m)

    def is_free(self, at: Point) -> bool:
        """Whether a point is on the water and keeps the clearance."""
        return self.water.is_water(at) and self.water.distance_m(at) >= self.clearance_m

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """West, south, east and north of the navigable water."""
        west, south, east, north = self.chart.navigable.bounds
        return west, south, east, north

    @lru_cache(maxsize=4)  # noqa: B019  (a few grids of one sea, as long as it lives)
    def grid(self, cells: int) -> Grid:
        """About so many cells, each step between two free ones clear; never finer than a quarter
        clearance."""
        cell_m = max(math.sqrt(self.chart.navigable.area / cells), self.clearance_m / 4.0)
        return occupancy(self.chart, self.bounds, cell_m, self.clearance_m)

    def entries(self, grid: Grid, start: Point, goal: Point) -> tuple[int, int]:
        """A cell near the start and one near the goal in the same region. Raises NoPath: there are none."""
        try:
            water = FreeWater(self.chart, grid, self.clearance_m)
            out, into = water.entry_from_start(start).cells, water.entry_to_stop(goal, "goal").cells
        except NoRouteError as error:
            raise NoPath(str(error)) from error
        for region, cell in out.items():
            if region in into:
                return cell, into[region]
        raise NoPath(f"start and goal lie in different water in cells of {grid.cell_m:.2g} m")


def plan(
    planner: Planner,
    sea: Sea,
    start: Point,
    goal: Point,
    seed: int,
    budget_s: float,
    effort: float = 1.0,
) -> Planned | Failed:
    """Run a planner, and check its path against the true shores: an invalid one is a failure.

    effort: its work, 1 is as usual.
    """
    began_s = time.thread_time()
    try:
        points = planner(sea, start, goal, seed, Deadline(budget_s), effort)
    except NoPath as error:
        return Failed(str(error), time.thread_time() - began_s)
    cpu_s = time.thread_time() - began_s
    if points[0] != start or points[-1] != goal:
        return Failed("the path does not join start and goal", cpu_s)
    if not all(sea.is_clear(a, b) for a, b in pairwise(points)):
        return Failed("the path does not keep the clearance", cpu_s)
    return Planned(points, path_length_m(points), cpu_s)
