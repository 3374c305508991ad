"""Dijkstra's algorithm and Theta* on the planner's grid.

E. W. Dijkstra, *A Note on Two Problems in Connexion with Graphs* (1959): A* without a heuristic. A. Nash,
K. Daniel, S. Koenig and A. Felner, *Theta\\*: Any-Angle Path Planning on Grids* (AAAI 2007): A* whose cells
take their parent's parent where it sees them.
"""

import heapq
import math
from array import array

from benchmarks.peers.interface import Deadline, NoPath, Path, Sea
from companion.core.geo import Point, distance_m
from mission_tools.planning.astar import astar
from mission_tools.planning.grid import EightNeighbours

CELLS = 40_000


def dijkstra(sea: Sea, start: Point, goal: Point, seed: int, deadline: Deadline, effort: float) -> Path:  # noqa: ARG001
    """The shortest path from cell to cell."""
    grid = sea.grid(round(effort * CELLS))
    first, last = sea.entries(grid, start, goal)
    expansion = EightNeighbours(grid)
    found = astar(expansion, array("q", bytes(8 * expansion.size)), first, last)
    deadline.check()
    return (start, *map(grid.centre, found.cells), goal)


def theta_star(sea: Sea, start: Point, goal: Point, seed: int, deadline: Deadline, effort: float) -> Path:  # noqa: ARG001
    """Basic Theta*; the line of sight is tested against the true shores, not the grid."""
    grid = sea.grid(round(effort * CELLS))
    first, last = sea.entries(grid, start, goal)
    expansion = EightNeighbours(grid)
    places = {first: grid.centre(first)}
    costs, parents, closed = {first: 0.0}, {first: first}, set()
    end = grid.centre(last)
    open_list = [(distance_m(places[first], end), first)]
    while open_list:
        deadline.check()
        _, cell = heapq.heappop(open_list)
        if cell in closed:
            continue
        closed.add(cell)
        if cell == last:
            return (start, *_walk_back(parents, places, cell), goal)
        for delta, _ in expansion.moves(cell):
            successor = cell + delta
            if successor in closed:
                continue
            place = places.setdefault(successor, grid.centre(successor))
            parent = parents[cell]
            if parent != cell and not sea.is_clear(places[parent], place):
                parent = cell
            tentative = costs[parent] + distance_m(places[parent], place)
            if tentative < costs.get(successor, math.inf):
                costs[successor], parents[successor] = tentative, parent
                heapq.heappush(open_list, (tentative + distance_m(place, end), successor))
    raise NoPath("the open list ran empty")


def _walk_back(parents: dict[int, int], places: dict[int, Point], cell: int) -> Path:
    points = [places[cell]]
    while parents[cell] != cell:
        cell = parents[cell]
        points.append(places[cell])
    return tuple(reversed(points))
