"""A grid of square cells over the local frame: which are free, and where they lie. Knows nothing of search.

Cells are numbered row by row from the south-west; a border of blocked cells all round spares the search every
bounds check.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from companion.core.geo import Point

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

    def is_free(self, cell: int) -> bool:
        """Whether a cell may be entered."""
        return bool(self.free.flat[cell])

    def centre(self, cell: int) -> Point:
        """The middle of a cell."""
        row, column = divmod(cell, self.columns)
        return Point(self.south_m + (row + 0.5) * self.cell_m, self.west_m + (column + 0.5) * self.cell_m)

    def centres(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """East of each column's and north of each row's middle, metres."""
        east = np.arange(self.columns, dtype=np.float64)
        north = np.arange(self.rows, dtype=np.float64)
        return self.west_m + (east + 0.5) * self.cell_m, self.south_m + (north + 0.5) * self.cell_m


def grid_from_rows(rows: list[str], passable: str = ".", cell_m: float = 1.0) -> Grid:
    """A grid from lines of text, the first line the northernmost; a blocked border is put round it.

    Raises:
        ValueError: no rows, or rows of different length.
    """
    if not rows or len({len(row) for row in rows}) != 1:
        raise ValueError("a grid needs rows of equal length")
    inner = np.array([[mark in passable for mark in row] for row in reversed(rows)], dtype=np.bool_)
    return Grid(np.pad(inner, BORDER), -BORDER * cell_m, -BORDER * cell_m, cell_m)
