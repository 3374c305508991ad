"""What may still lie ahead: lower bounds on the cost from a cell to the goal, in the expansion's units.

| name | is | with eight neighbours |
|---|---|---|
| octile | the true cost on an empty grid | admissible and consistent, the tightest of the three |
| euclidean | the straight line | admissible and consistent, expands more |
| manhattan | rows plus columns | over-estimates diagonals: the path is valid but may be longer |
"""

import math
from array import array
from collections.abc import Callable
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from mission_tools.planning.expansion import DIAGONAL, STRAIGHT
from mission_tools.planning.grid import Grid

HeuristicName = Literal["octile", "euclidean", "manhattan"]
Estimates: TypeAlias = "array[int]"
"""One whole number for each cell."""

_Formula = Callable[[NDArray[np.int64], NDArray[np.int64]], NDArray[np.int64]]


def _octile(rows: NDArray[np.int64], columns: NDArray[np.int64]) -> NDArray[np.int64]:
    shorter, longer = np.minimum(rows, columns), np.maximum(rows, columns)
    cost: NDArray[np.int64] = (longer - shorter) * STRAIGHT + shorter * DIAGONAL
    return cost


def _euclidean(rows: NDArray[np.int64], columns: NDArray[np.int64]) -> NDArray[np.int64]:
    # Scaled to the rounded √2, so that a diagonal step never costs less than the line it covers.
    cost: NDArray[np.int64] = (np.hypot(rows, columns) * (DIAGONAL / math.sqrt(2.0))).astype(np.int64)
    return cost


def _manhattan(rows: NDArray[np.int64], columns: NDArray[np.int64]) -> NDArray[np.int64]:
    cost: NDArray[np.int64] = (rows + columns) * STRAIGHT
    return cost


_FORMULAS: dict[HeuristicName, _Formula] = {
    "octile": _octile,
    "euclidean": _euclidean,
    "manhattan": _manhattan,
}
HEURISTICS: tuple[HeuristicName, ...] = tuple(_FORMULAS)


def estimates(name: HeuristicName, grid: Grid, goal: int) -> Estimates:
    """The heuristic's value for every cell of a grid, in the expansion's cost units.

    Raises:
        ValueError: no such heuristic.
    """
    if name not in _FORMULAS:
        raise ValueError(f"no heuristic called {name!r}; there are {', '.join(HEURISTICS)}")
    row, column = divmod(goal, grid.columns)
    rows = np.abs(np.arange(grid.rows, dtype=np.int64) - row)[:, np.newaxis]
    columns = np.abs(np.arange(grid.columns, dtype=np.int64) - column)[np.newaxis, :]
    table = np.broadcast_to(_FORMULAS[name](rows, columns), (grid.rows, grid.columns))
    return array("q", np.ascontiguousarray(table).tobytes())
