"""Ant colony optimisation on a coarse grid, as in the paper's reference [6].

The ant system of M. Dorigo, V. Maniezzo and A. Colorni (IEEE Trans. SMC-B 26(1), 1996): an ant goes to a
neighbouring cell that it has not visited, with probability ∝ τ^α η^β, where η falls with the distance from
there to the goal; ants that arrive lay pheromone by the shortness of their path, and all of it evaporates by
a fixed share.
"""

import contextlib
import math
import random
from itertools import pairwise

from benchmarks.peers.interface import Deadline, NoPath, Path, Sea
from companion.core.geo import Point
from mission_tools.planning.grid import STRAIGHT, EightNeighbours, Grid

CELLS = (1600, 6400, 25_600)  # as coarse as joins start and goal
ANTS = 30
ITERATIONS = 60
EVAPORATION = 0.3
_ALPHA = 1.0
_BETA = 9.0
_FIRST_PHEROMONE = 1.0
_LAST_PHEROMONE = 1e-3  # never less, so that no cell is closed for good


def ant_colony(sea: Sea, start: Point, goal: Point, seed: int, deadline: Deadline, effort: float) -> Path:
    """The best path of any ant. Raises NoPath: no ant arrived."""
    draw, iterations = random.Random(seed), round(effort * ITERATIONS)
    grid, first, last = _coarsest(sea, start, goal)
    trails = _Trails(grid, last)
    best: tuple[float, list[int]] = (math.inf, [])
    for _ in range(iterations):
        arrived = []
        for _ in range(ANTS):
            deadline.check()
            way = trails.walk(first, draw)
            if way is not None:
                arrived.append((trails.length(way), way))
        best = min([best, *arrived], key=lambda one: one[0])
        trails.evaporate(EVAPORATION)
        if not arrived:
            continue
        for length, way in [*arrived, best]:
            trails.lay(way, best[0] / length / len(arrived))
    if not best[1]:
        raise NoPath(f"none of {ANTS * iterations} ants arrived")
    return (start, *map(grid.centre, best[1]), goal)


def _coarsest(sea: Sea, start: Point, goal: Point) -> tuple[Grid, int, int]:
    for cells in CELLS[:-1]:
        with contextlib.suppress(NoPath):
            return sea.grid(cells), *sea.entries(sea.grid(cells), start, goal)
    return sea.grid(CELLS[-1]), *sea.entries(sea.grid(CELLS[-1]), start, goal)


class _Trails:
    """Pheromone on the steps of a grid."""

    def __init__(self, grid: Grid, goal: int) -> None:
        self._expansion = EightNeighbours(grid)
        self._goal = goal
        self._pheromone: dict[tuple[int, int], float] = {}
        self._level = _FIRST_PHEROMONE  # of the steps that no ant has taken
        row, column = divmod(goal, grid.columns)
        self._visibility = [
            (1.0 / (1.0 + math.hypot(cell // grid.columns - row, cell % grid.columns - column)))
            for cell in range(self._expansion.size)
        ]

    def walk(self, start: int, draw: random.Random) -> list[int] | None:
        """The cells of one ant; None where it got stuck."""
        way, visited = [start], {start}
        while way[-1] != self._goal:
            here = way[-1]
            steps = [delta for delta, _ in self._expansion.moves(here) if here + delta not in visited]
            if not steps:
                return None
            nearest = max(self._visibility[here + delta] for delta in steps)
            weights = []
            for delta in steps:
                eta = self._visibility[here + delta] / nearest
                weights.append(self._pheromone.get((here, delta), self._level) ** _ALPHA * eta**_BETA)
            there = here + draw.choices(steps, weights)[0]
            way.append(there)
            visited.add(there)
        return way

    def length(self, way: list[int]) -> float:
        """In cell sides."""
        total = 0
        for here, there in pairwise(way):
            total += next(cost for delta, cost in self._expansion.moves(here) if here + delta == there)
        return total / STRAIGHT

    def evaporate(self, share: float) -> None:
        keep = 1.0 - share
        self._level = max(self._level * keep, _LAST_PHEROMONE)
        self._pheromone = {
            step: max(amount * keep, _LAST_PHEROMONE) for step, amount in self._pheromone.items()
        }

    def lay(self, way: list[int], amount: float) -> None:
        """On each step of a way."""
        for here, there in pairwise(way):
            step = here, there - here
            self._pheromone[step] = self._pheromone.get(step, self._level) + amount
