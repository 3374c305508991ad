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
from collections.abc import Sequence
from dataclasses import dataclass

from mission_tools.errors import NoRoute, SearchBudgetExceeded
from mission_tools.planning.expansion import STRAIGHT, Expansion

_UNSEEN = (1 << 63) - 1
_CLOSED = -1


@dataclass(frozen=True, slots=True)
class SearchMetrics:
    """What a search cost.

    expanded: cells moved to closed. generated: successors looked at that were not closed. updated: cells in
    open whose G fell. max_open: most entries in open at one time, stale ones included. No cell is ever taken
    back out of closed: the paper skips them, and a consistent heuristic has no need of it.
    """

    expanded: int
    generated: int
    updated: int
    max_open: int

    def __add__(self, other: "SearchMetrics") -> "SearchMetrics":
        """The cost of two searches after each other."""
        return SearchMetrics(
            self.expanded + other.expanded,
            self.generated + other.generated,
            self.updated + other.updated,
            max(self.max_open, other.max_open),
        )


@dataclass(frozen=True, slots=True)
class SearchResult:
    """A path from start to goal, both included. cost is in the expansion's units."""

    cells: tuple[int, ...]
    cost: int
    metrics: SearchMetrics

    @property
    def length(self) -> float:
        """In cell sides, good to 3e-10 of itself."""
        return self.cost / STRAIGHT


def astar(
    expansion: Expansion, estimates: Sequence[int], start: int, goal: int, budget: int | None = None
) -> SearchResult:
    """Find the cheapest path between two cells (if the estimates are consistent; else a valid one).

    Args:
        expansion: the map as steps and costs.
        estimates: H for each cell, in the expansion's units.
        start: number of the first cell.
        goal: number of the last cell.
        budget: most cells to expand; None for no limit.

    Raises:
        NoRoute: the open list ran empty.
        SearchBudgetExceeded: the budget was spent first.
    """
    moves = expansion.moves
    push, pop = heapq.heappush, heapq.heappop
    # G, and _CLOSED once the cell is closed: then no tentative G is lower, and closed cells skip themselves.
    open_g = array("q", [_UNSEEN]) * expansion.size
    parent = array("q", [_CLOSED]) * expansion.size
    limit = math.inf if budget is None else budget
    expanded = generated = updated = max_open = 0

    open_g[start] = 0
    open_list = [(estimates[start], estimates[start], start)]
    while open_list:
        max_open = max(max_open, len(open_list))
        f, h, cell = pop(open_list)
        g = open_g[cell]
        if g != f - h:
            continue  # stale: closed since, or pushed again with a lower G
        if expanded >= limit:
            raise SearchBudgetExceeded(
                f"no route within {budget} cells looked at: allow more, or larger cells"
            )
        expanded += 1
        if cell == goal:
            metrics = SearchMetrics(expanded, generated, updated, max_open)
            return SearchResult(_walk_back(parent, start, goal), g, metrics)
        open_g[cell] = _CLOSED
        for delta, cost in moves(cell):
            successor = cell + delta
            known = open_g[successor]
            if known == _CLOSED:
                continue
            generated += 1
            tentative = g + cost
            if tentative < known:
                if known != _UNSEEN:
                    updated += 1
                open_g[successor] = tentative
                parent[successor] = cell
                estimate = estimates[successor]
                push(open_list, (tentative + estimate, estimate, successor))
    raise NoRoute(f"no route: all {expanded} cells that can be reached were looked at")


def _walk_back(parent: Sequence[int], start: int, goal: int) -> tuple[int, ...]:
    cells = [goal]
    while cells[-1] != start:
        cells.append(parent[cells[-1]])
    return tuple(reversed(cells))
