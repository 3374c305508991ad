"""A* in the steps of the paper this project implements (section 3.3), F = G + H.

1. Open holds the start, closed nothing. 2. The start's G is 0. 3. While open is not empty: (a) move the cell
of lowest F from open to closed; (b) generate its successors; (c) skip those in closed, work out the tentative
G of the others, add the new ones to open, and lower G of those in open that are now reached more cheaply.
4. An empty open list means that there is no path.

We part from the paper in one point: the goal ends the search when it is taken from open, not when it is first
generated, because only then is no cheaper way to it left (Hart, Nilsson and Raphael, *A Formal Basis for the
Heuristic Determination of Minimum Cost Paths*, 1968). Of equal F the cell nearer to the goal goes first. A
cell whose G fell is pushed again, and its stale entry is passed over when it comes up.
"""

import heapq
import math
from array import array
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from mission_tools.errors import NoRoute
from mission_tools.planning.grid import DIAGONAL, STRAIGHT, EightNeighbours, Grid
from mission_tools.planning.plan_settings import HeuristicName

_UNSEEN = (1 << 63) - 1
_CLOSED = -1


@dataclass(frozen=True, slots=True)
class SearchResult:
    """A path from start to goal, both included. cost: in the expansion's units; expanded: cells closed."""

    cells: tuple[int, ...]
    cost: int
    expanded: int

    @property
    def length(self) -> float:
        """In cell sides, good to 3e-10 of itself."""
        return self.cost / STRAIGHT


def astar(expansion: EightNeighbours, estimates: Sequence[int], start: int, goal: int) -> SearchResult:
    """Find the cheapest path between two cells (if the estimates are consistent; else a valid one).

    expansion: the map as steps and costs. estimates: H for each cell, in the expansion's units. start, goal:
    numbers of cells. Raises NoRoute: the open list ran empty.
    """
    moves = expansion.moves
    push, pop = heapq.heappush, heapq.heappop
    # G, and _CLOSED once the cell is closed: then no tentative G is lower, and closed cells skip themselves.
    open_g = array("q", [_UNSEEN]) * expansion.size
    parent = array("q", [_CLOSED]) * expansion.size
    expanded = 0

    open_g[start] = 0
    open_list = [(estimates[start], estimates[start], start)]
    while open_list:
        f, h, cell = pop(open_list)
        g = open_g[cell]
        if g != f - h:
            continue  # stale: closed since, or pushed again with a lower G
        expanded += 1
        if cell == goal:
            return SearchResult(walk_back(parent, start, goal), g, expanded)
        open_g[cell] = _CLOSED
        for delta, cost in moves(cell):
            successor = cell + delta
            known = open_g[successor]
            if known == _CLOSED:
                continue
            tentative = g + cost
            if tentative < known:
                open_g[successor] = tentative
                parent[successor] = cell
                estimate = estimates[successor]
                push(open_list, (tentative + estimate, estimate, successor))
    raise NoRoute(f"no route: all {expanded} cells that can be reached were looked at")


def walk_back(parent: Sequence[int] | NDArray[np.intp], start: int, goal: int) -> tuple[int, ...]:
    """The cells from start to goal. parent: for each cell the one before it."""
    cells = [goal]
    while cells[-1] != start:
        cells.append(int(parent[cells[-1]]))
    return tuple(reversed(cells))


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


def estimates(name: HeuristicName, grid: Grid, goal: int) -> Estimates:
    """The heuristic's value for every cell of a grid, in the expansion's cost units.

    octile: the true cost on an empty grid, the tightest that is consistent. euclidean: the straight line,
    consistent, expands more. manhattan: over-estimates diagonals, so the path is valid but may be longer.
    """
    row, column = divmod(goal, grid.columns)
    rows = np.abs(np.arange(grid.rows, dtype=np.int64) - row)[:, np.newaxis]
    columns = np.abs(np.arange(grid.columns, dtype=np.int64) - column)[np.newaxis, :]
    table = np.broadcast_to(_FORMULAS[name](rows, columns), (grid.rows, grid.columns))
    return array("q", np.ascontiguousarray(table).tobytes())
