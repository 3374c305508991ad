"""Shortest paths on a grid of square cells.

Cells are numbered row by row from 0. A step goes to one of the eight neighbours; a diagonal one only if both
cells beside it are free, so that no corner is cut. `shortest_path` minimises the octile length; among
paths of equal length the choice is fixed but arbitrary.

    GridMap → shortest_path → GridPath
    GridInputError (ValueError)  a map or cell that cannot be used; names it
    NoGridPath                   start and goal are free, but no path joins them
"""

from collections.abc import Callable
from functools import cached_property
from itertools import pairwise
from typing import Any, Final, NamedTuple

from companion.planning.jump_points import DIAGONAL, STRAIGHT
from companion.planning.kernels import load

__all__ = [
    "DIAGONAL",
    "STRAIGHT",
    "GridInputError",
    "GridMap",
    "GridPath",
    "NoGridPath",
]

MAX_CELLS: Final = 1 << 25
"""Costs have 54 bits: the longest path of so many cells, half of them walls, still fits."""

_searcher: Callable[..., Any] = load("_jump_points", "jump_points").Searcher


class GridInputError(ValueError):
    """A map or cell that cannot be used."""


class NoGridPath(Exception):  # noqa: N818  (says what happened)
    """Start and goal are free, but no path joins them. expanded: cells the search expanded."""

    def __init__(self, message: str, expanded: int) -> None:
        super().__init__(message)
        self.expanded = expanded


class GridPath(NamedTuple):
    """A path from start to goal.

    corners: the cells where it turns, start and goal included. length: in cell sides. width: columns of the
    map. expanded: cells that the search expanded.
    """

    corners: tuple[int, ...]
    length: float
    width: int
    expanded: int

    @property
    def cells(self) -> tuple[int, ...]:
        """Every cell on the way, start and goal included."""
        cells = [self.corners[0]]
        for a, b in pairwise(self.corners):
            across, along = b % self.width - a % self.width, b // self.width - a // self.width
            steps = max(abs(across), abs(along))
            cells += range(a, b, (along * self.width + across) // steps)[1:]
            cells.append(b)
        return tuple(cells)


class GridMap:
    """Free and blocked cells."""

    def __init__(self, free: bytes, width: int, height: int) -> None:
        """free: one byte a cell, row by row; 0 is blocked.

        Raises:
            GridInputError: no cells, too many, or a number of bytes that is not width × height.
        """
        if width < 1 or height < 1:
            raise GridInputError(f"grid map of {width} × {height} cells: expected at least one")
        if len(free) != width * height:
            raise GridInputError(
                f"grid map of {width} × {height} cells has {len(free)} bytes: expected {width * height}"
            )
        if width * height > MAX_CELLS:
            raise GridInputError(f"grid map of {width} × {height} cells: expected at most {MAX_CELLS}")
        self.free = bytes(free)
        self.width = width
        self.height = height

    @cached_property
    def searcher(self) -> Any:  # noqa: ANN401  (of the kernel or its twin)
        """The map as the search wants it, made once."""
        return _searcher(self.free, self.width, self.height)

    def cell_at(self, column: int, row: int) -> int:
        """The number of a cell.

        Raises:
            GridInputError: outside the map.
        """
        if not (0 <= column < self.width and 0 <= row < self.height):
            raise GridInputError(f"column {column}, row {row} is outside the map{self._size()}")
        return row * self.width + column

    def check_ends(self, start: int, goal: int) -> None:
        """Check that both cells are on the map and free.

        Raises:
            GridInputError: names the cell and what is wrong.
        """
        for name, cell in (("start", start), ("goal", goal)):
            if not 0 <= cell < len(self.free):
                raise GridInputError(f"{name} cell {cell} is outside the map{self._size()}")
            if not self.free[cell]:
                raise GridInputError(f"{name} {self.describe(cell)} is blocked")

    def describe(self, cell: int) -> str:
        """For messages."""
        return f"cell {cell} (column {cell % self.width}, row {cell // self.width})"

    def _size(self) -> str:
        return f" of {self.width} × {self.height} cells"


def shortest_path(grid: GridMap, start: int, goal: int) -> GridPath:
    """The path of the least octile length, by jump point search.

    Raises:
        GridInputError: start or goal is blocked or outside.
        NoGridPath: no path joins them.
    """
    grid.check_ends(start, goal)
    if start == goal:
        return GridPath((start,), 0.0, grid.width, 0)
    corners, cost, expanded = grid.searcher.shortest(start, goal)
    if corners is None:
        raise _no_path(grid, start, goal, expanded)
    return GridPath(tuple(corners), cost / STRAIGHT, grid.width, expanded)


def _no_path(grid: GridMap, start: int, goal: int, expanded: int) -> NoGridPath:
    return NoGridPath(f"no path from {grid.describe(start)} to {grid.describe(goal)}", expanded)
