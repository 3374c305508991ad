"""Entry cells of the planning grid for start and goal, and errors that name the obstacle."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from companion.core.geo import Point
from mission_tools.errors import GoalBlocked, NoRouteError, StartBlocked
from mission_tools.maps.chart import Chart
from mission_tools.planning.grid import Grid
from mission_tools.planning.wording import nearest_free, place

NEAREST_CELLS = 400


@dataclass(frozen=True, slots=True)
class EntryCells:
    """The cells that connect a position to the grid: for each region the nearest with a clear leg.

    is_relaxed: the leg there may be nearer to a shore than the clearance.
    """

    cells: dict[int, int]
    is_relaxed: bool = False


class FreeWater:
    """The free cells of a grid by region; cells of one region can reach each other, of two they cannot.

    Positions are those that `check_stops` lets pass.
    """

    def __init__(self, chart: Chart, grid: Grid, clearance_m: float) -> None:
        self._chart = chart
        self._grid = grid
        self._clearance_m = clearance_m
        # Joined by sides only: a diagonal step needs both cells beside it, so it joins nothing more.
        self._regions: NDArray[np.int32] = ndimage.label(grid.free)[0]
        self._rows, self._columns = np.nonzero(grid.free)

    def entry_from_start(self, start: Point) -> EntryCells:
        """Entry cells of the start, relaxed within the clearance of a shore. Raises StartBlocked: shut in."""
        is_free = self._chart.clearance_m(start) >= self._clearance_m
        return self._entry_cells(start, "start", StartBlocked, self._clearance_m if is_free else 0.0)

    def entry_to_stop(self, stop: Point, name: str) -> EntryCells:
        """Entry cells of the goal or a via point, as named. Raises GoalBlocked: shut in."""
        return self._entry_cells(stop, name, GoalBlocked, self._clearance_m)

    def no_route(self, start: Point, goal: Point) -> str:
        """The message when no region holds both."""
        return (
            f"no route from {self._at(start)} to {self._at(goal)}: no way between them keeps "
            f"{self._clearance_m:g} m clear of the shores (seen in cells of {self._grid.cell_m:.3g} m): "
            f"choose a smaller clearance, or another goal"
        )

    def _entry_cells(
        self, point: Point, name: str, blocked: type[NoRouteError], clearance_m: float
    ) -> EntryCells:
        cells: dict[int, int] = {}
        for cell in self._nearest_cells(point):
            region = int(self._regions.flat[cell])
            if region not in cells and self._chart.is_clear(point, self._grid.centre(cell), clearance_m):
                cells[region] = cell
        if not cells:
            raise blocked(
                f"{name} {self._at(point)} is shut in: no straight way out keeps the clearance of "
                f"{self._clearance_m:g} m: {self._nearest_free(point)}"
            )
        return EntryCells(cells, is_relaxed=clearance_m < self._clearance_m)

    def _nearest_cells(self, point: Point) -> list[int]:
        """The nearest free cells, nearest first."""
        grid = self._grid
        north = grid.south_m + (self._rows + 0.5) * grid.cell_m - point.north_m
        east = grid.west_m + (self._columns + 0.5) * grid.cell_m - point.east_m
        squared = north * north + east * east
        count = min(NEAREST_CELLS, squared.size)
        nearest = np.argpartition(squared, count - 1)[:count] if count else np.empty(0, dtype=np.intp)
        nearest = nearest[np.argsort(squared[nearest], kind="stable")]
        cells: list[int] = (self._rows[nearest] * grid.columns + self._columns[nearest]).tolist()
        return cells

    def _nearest_free(self, point: Point) -> str:
        cells = self._nearest_cells(point)
        free = self._grid.centre(cells[0]) if cells else None
        return nearest_free(self._chart, point, free, self._clearance_m)

    def _at(self, point: Point) -> str:
        return place(self._chart, point)
