"""Which cells can be reached from a cell, and at what cost. No corner is cut.

Costs are whole numbers, `STRAIGHT` for a step along a row or column and `DIAGONAL` for √2 of it rounded down,
so sums are exact and equal costs are equal. Two paths would have to differ by a thousand million steps before
the rounding could change which is the shorter.
"""

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from mission_tools.planning.grid import Grid

STRAIGHT = 1_000_000_000
DIAGONAL = 1_414_213_562

Move = tuple[int, int]
"""What to add to the cell's number, and the cost of going there."""


class Expansion(Protocol):
    """What the search needs to know about a map."""

    @property
    def size(self) -> int:
        """Number of cells; they are numbered from 0."""

    def moves(self, cell: int) -> Sequence[Move]:
        """The steps out of a cell."""


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
