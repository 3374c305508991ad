"""Shores grown by the clearance: which cells of a grid a boat may use.

A cell is free if its middle keeps √(clearance² + cell²/2) from everything that is not navigable. Then every
step between two free cells keeps the clearance itself: a step is at most √2 cells long, and what is at least
r from both its ends is at least √(r² − (step/2)²) from the step.
"""

import math

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy import ndimage

from mission_tools.errors import UsageError
from mission_tools.maps.chart import Chart
from mission_tools.planning.grid import BORDER, Grid

MAX_GRID_CELLS = 30_000_000
Bounds = tuple[float, float, float, float]
"""West, south, east, north, metres."""


def occupancy(chart: Chart, bounds: Bounds, cell_m: float, clearance_m: float) -> Grid:
    """Rasterise the navigable water within bounds, grown inwards by the clearance.

    A Euclidean distance transform of the cells that a shore runs through settles nearly all cells; the few
    for which its error of less than a cell matters are measured against the true shore.

    Raises:
        UsageError: the cells are so small that the grid would not fit in memory.
    """
    west, south, east, north = bounds
    columns, rows = (math.ceil(span / cell_m) + 2 * BORDER for span in (east - west, north - south))
    if columns * rows > MAX_GRID_CELLS:
        raise UsageError(f"cells of {cell_m:g} m make a grid of {columns} × {rows}: choose larger cells")
    blocked = np.zeros((rows, columns), dtype=np.bool_)
    empty = Grid(blocked, west - BORDER * cell_m, south - BORDER * cell_m, cell_m)
    eastings, northings = empty.centres()
    free: NDArray[np.bool_] = shapely.contains_xy(
        chart.navigable, eastings[np.newaxis, :], northings[:, np.newaxis]
    )
    free[:BORDER] = free[-BORDER:] = False
    free[:, :BORDER] = free[:, -BORDER:] = False
    needed_m = math.hypot(clearance_m, cell_m / math.sqrt(2.0))
    if not chart.shores.is_empty:
        free &= _keeps_off(chart, empty, needed_m, free)
    return Grid(free, empty.west_m, empty.south_m, cell_m)


def _keeps_off(chart: Chart, grid: Grid, needed_m: float, inside: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Whether each cell's middle is at least this far from every shore; exact for the cells inside."""
    cell_m = grid.cell_m
    spacing_m = 0.5 * cell_m
    samples = shapely.get_coordinates(shapely.segmentize(chart.shores, spacing_m))
    row = np.floor((samples[:, 1] - grid.south_m) / cell_m).astype(np.intp)
    column = np.floor((samples[:, 0] - grid.west_m) / cell_m).astype(np.intp)
    on_grid = (row >= 0) & (row < grid.rows) & (column >= 0) & (column < grid.columns)
    shoreless = np.ones((grid.rows, grid.columns), dtype=np.bool_)
    shoreless[row[on_grid], column[on_grid]] = False
    if shoreless.all():
        return shoreless
    estimate_m = ndimage.distance_transform_edt(shoreless, sampling=cell_m)
    # A shore point is within half a spacing of a sample, that within half a diagonal of its middle.
    error_m = cell_m / math.sqrt(2.0) + 0.5 * spacing_m
    keeps_off: NDArray[np.bool_] = estimate_m >= needed_m + error_m
    doubtful = np.nonzero(inside & ~keeps_off & (estimate_m >= needed_m - error_m))
    eastings, northings = grid.centres()
    middles = shapely.points(eastings[doubtful[1]], northings[doubtful[0]])
    keeps_off[doubtful] = shapely.distance(chart.shores, middles) >= needed_m
    return keeps_off
