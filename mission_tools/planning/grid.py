"""A grid of square cells over the local frame: which are free, where they lie, and the steps between them.

Cells are numbered row by row from the south-west; a border of blocked cells all round spares the search every
bounds check. A cell is free if its middle keeps √(clearance² + cell²/2) from everything that is not
navigable. Then every step between two free cells keeps the clearance itself: a step is at most √2 cells long,
and what is at least r from both its ends is at least √(r² − (step/2)²) from the step. No corner is cut.

Costs are whole numbers, `STRAIGHT` for a step along a row or column and `DIAGONAL` for √2 of it rounded down,
so sums are exact and equal costs are equal. Two paths would have to differ by a thousand million steps before
the rounding could change which is the shorter.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy import ndimage

from companion.core.geo import Point
from mission_tools.errors import UsageError
from mission_tools.maps.chart import Chart

BORDER = 1


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """Occupancy: `free[row, column]`, rows towards north, columns towards east, the blocked border included.

    west_m, south_m: the outer corner of cell 0. cell_m: side of a cell.
    """

    free: NDArray[np.bool_]
    west_m: float
    south_m: float
    cell_m: float

    def __post_init__(self) -> None:
        edges: tuple[Any, ...] = (self.free[0], self.free[-1], self.free[:, 0], self.free[:, -1])
        if any(edge.any() for edge in edges):
            raise ValueError("a grid's border cells must be blocked")
        if not self.cell_m > 0.0:
            raise ValueError(f"cell_m must be positive, not {self.cell_m}")

    @property
    def rows(self) -> int:
        """Number of rows, border included."""
        return int(self.free.shape[0])

    @property
    def columns(self) -> int:
        """Number of columns, border included."""
        return int(self.free.shape[1])

    def centre(self, cell: int) -> Point:
        """The middle of a cell."""
        row, column = divmod(cell, self.columns)
        return Point(self.south_m + (row + 0.5) * self.cell_m, self.west_m + (column + 0.5) * self.cell_m)

    def centres(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """East of each column's and north of each row's middle, metres."""
        east = np.arange(self.columns, dtype=np.float64)
        north = np.arange(self.rows, dtype=np.float64)
        return self.west_m + (east + 0.5) * self.cell_m, self.south_m + (north + 0.5) * self.cell_m


STRAIGHT = 1_000_000_000
DIAGONAL = 1_414_213_562

Move = tuple[int, int]
"""What to add to the cell's number, and the cost of going there."""


# Bit of the code, row step, column step. A diagonal bit is set only if both cells beside it are free.
_STRAIGHTS = ((0, 1, 0), (1, 0, 1), (2, -1, 0), (3, 0, -1))
_DIAGONALS = ((4, 1, 1), (5, -1, 1), (6, -1, -1), (7, 1, -1))


class EightNeighbours:
    """Steps to the eight neighbours of a grid's cell.

    A diagonal step needs both cells beside it to be free: a boat that cut the corner would sail over it. The
    256 possible sets of steps are worked out once, and each cell keeps one byte that names its set.
    """

    __slots__ = ("_codes", "_moves", "size")

    def __init__(self, grid: Grid) -> None:
        self.size = grid.rows * grid.columns
        self._codes = _codes(grid)
        steps = [(bit, drow * grid.columns + dcol, STRAIGHT) for bit, drow, dcol in _STRAIGHTS]
        steps += [(bit, drow * grid.columns + dcol, DIAGONAL) for bit, drow, dcol in _DIAGONALS]
        self._moves = tuple(
            tuple((delta, cost) for bit, delta, cost in steps if code >> bit & 1) for code in range(256)
        )

    def moves(self, cell: int) -> Sequence[Move]:
        """The steps out of a cell; none out of a blocked one."""
        return self._moves[self._codes[cell]]


def _codes(grid: Grid) -> bytes:
    free = grid.free
    codes = np.zeros(free.shape, dtype=np.uint8)
    inner = codes[1:-1, 1:-1]

    def shifted(drow: int, dcol: int) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
        return free[1 + drow : grid.rows - 1 + drow, 1 + dcol : grid.columns - 1 + dcol]

    here = shifted(0, 0)
    for bit, drow, dcol in _STRAIGHTS:
        inner |= (here & shifted(drow, dcol)).astype(np.uint8) << bit
    for bit, drow, dcol in _DIAGONALS:
        reachable = here & shifted(drow, dcol) & shifted(drow, 0) & shifted(0, dcol)
        inner |= reachable.astype(np.uint8) << bit
    return codes.tobytes()


MAX_GRID_CELLS = 30_000_000
Bounds = tuple[float, float, float, float]
"""West, south, east, north, metres."""


def occupancy(chart: Chart, bounds: Bounds, cell_m: float, clearance_m: float) -> Grid:
    """Rasterise the navigable water within bounds, grown inwards by the clearance.

    A Euclidean distance transform of the cells that a shore runs through settles nearly all cells; the few
    for which its error of less than a cell matters are measured against the true shore. Raises UsageError:
    the cells are so small that the grid would not fit in memory.
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
