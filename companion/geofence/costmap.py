"""Grid of the allowed water: the cells that the boat may pass through, computed in small steps."""

import math
from collections.abc import Sequence

from companion.core.geo import Point
from companion.geofence.fence import Fence

_MOST_FREE = 16_000  # cells of water, about: bounds memory and computing time
_MOST_CELLS = 400_000  # including land
_LEAST_CELL_M = 0.05
_CELLS_PER_CLEARANCE = 3.0  # finer cells would add nothing
_PADDING_M = 30.0  # around exclusion areas in open water
_LEAP_CELLS = 8  # range of the distance query


class Costmap:
    """Cells whose centres keep `clearance_m` from every line, with a border of blocked cells.

    The clearance is at least three quarters of a cell, so no line passes between the centres of two free
    neighbours, diagonal ones included: their midpoint is √½ cells from either.
    """

    def __init__(self, fence: Fence, within: Sequence[Point], clearance_m: float) -> None:
        """within: points that the grid must contain if no inclusion area limits it."""
        self._fence = fence
        south, west, north, east, area_m2 = _extent(fence, within)
        cell_m = max(
            math.sqrt(area_m2 / _MOST_FREE),
            math.sqrt((north - south) * (east - west) / _MOST_CELLS),
            clearance_m / _CELLS_PER_CLEARANCE,
            _LEAST_CELL_M,
        )
        self.cell_m = cell_m
        self.clearance_m = max(clearance_m, 0.75 * cell_m)
        self.south_m, self.west_m = south - cell_m, west - cell_m
        self.rows = math.ceil((north - south) / cell_m) + 2
        self.columns = math.ceil((east - west) / cell_m) + 2
        self.free = bytearray(self.rows * self.columns)
        self._row = self._column = 1  # next cell to compute

    @property
    def is_complete(self) -> bool:
        """Whether every cell is computed."""
        return self._row > self.rows - 2

    def advance(self, looks: int) -> None:
        """Continue for a number of fence queries.

        The margin of a cell bounds those of its neighbours, so a query settles that many cells.
        """
        free, columns, cell_m = self.free, self.columns, self.cell_m
        leap_m = self.clearance_m + _LEAP_CELLS * cell_m
        row, column = self._row, self._column
        for _ in range(looks):
            if column > columns - 2:
                row, column = row + 1, 1
            if row > self.rows - 2:
                break
            north_m = self.south_m + (row + 0.5) * cell_m
            east_m = self.west_m + (column + 0.5) * cell_m
            spare_m = self._fence.margin_within_m(north_m, east_m, leap_m) - self.clearance_m
            alike = min(int(abs(spare_m) / cell_m) + 1, columns - 1 - column)
            if spare_m >= 0.0:
                start = row * columns + column
                free[start : start + alike] = b"\x01" * alike
            column += alike
        self._row, self._column = row, column

    def centre(self, cell: int) -> Point:
        """Centre of a cell."""
        row, column = divmod(cell, self.columns)
        return Point(self.south_m + (row + 0.5) * self.cell_m, self.west_m + (column + 0.5) * self.cell_m)

    def cell(self, point: Point) -> int:
        """The cell of a point, or the nearest one inside the border."""
        row = math.floor((point.north_m - self.south_m) / self.cell_m)
        column = math.floor((point.east_m - self.west_m) / self.cell_m)
        row = min(max(row, 1), self.rows - 2)
        return row * self.columns + min(max(column, 1), self.columns - 2)

    def around(self, point: Point, cells: int) -> list[int]:
        """The free cells within this many rows and columns."""
        row, column = divmod(self.cell(point), self.columns)
        west, east = max(column - cells, 1), min(column + cells, self.columns - 2)
        found: list[int] = []
        for at in range(max(row - cells, 1), min(row + cells, self.rows - 2) + 1):
            start = at * self.columns
            found += [cell for cell in range(start + west, start + east + 1) if self.free[cell]]
        return found


def _extent(fence: Fence, within: Sequence[Point]) -> tuple[float, float, float, float, float]:
    """South, west, north, east, and the approximate area of water."""
    held = [area for area in fence.areas if area.is_inclusion]
    if held:
        south, west = max(area.south_m for area in held), max(area.west_m for area in held)
        north, east = min(area.north_m for area in held), min(area.east_m for area in held)
        north, east = max(north, south), max(east, west)
        most_m2 = (north - south) * (east - west)
        return south, west, north, east, min(most_m2, *(area.area_m2 for area in held))
    norths = [edge for area in fence.areas for edge in (area.south_m, area.north_m)]
    easts = [edge for area in fence.areas for edge in (area.west_m, area.east_m)]
    norths += [point.north_m for point in within]
    easts += [point.east_m for point in within]
    south, north = min(norths) - _PADDING_M, max(norths) + _PADDING_M
    west, east = min(easts) - _PADDING_M, max(easts) + _PADDING_M
    return south, west, north, east, (north - south) * (east - west)
