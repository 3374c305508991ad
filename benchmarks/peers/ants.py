"""Ant colony optimisation on a coarse grid, and its improvement by Li and Zhang.

The basic algorithm is the ant system of M. Dorigo, V. Maniezzo and A. Colorni (IEEE Trans. SMC-B 26(1),
1996), as in the paper's reference [6]: an ant goes to a neighbouring cell that it has not visited, with
probability ∝ τ^α η^β, where η falls with the distance from there to the goal; ants that arrive lay
pheromone by the shortness of their path, and all of it evaporates by a fixed share. Reference [8] improves
the state transition, here the pseudo-random proportional rule that now and then takes the best cell outright
and prefers not to turn, and lets the share that evaporates follow a Gaussian function of the iteration: much
while ants explore, little at the end.
"""

import contextlib
import math
import random
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

from benchmarks.peers.interface import Deadline, NoPath, Path, Sea
from companion.core.geo import Point
from mission_tools.planning.expansion import STRAIGHT, EightNeighbours
from mission_tools.planning.grid import Grid

CELLS = (1600, 6400, 25_600)  # as coarse as joins start and goal
ANTS = 30
ITERATIONS = 60
_ALPHA = 1.0
_BETA = 9.0
_FIRST_PHEROMONE = 1.0
_LAST_PHEROMONE = 1e-3  # never less, so that no cell is closed for good


@dataclass(frozen=True, slots=True)
class Habits:
    """What tells one colony from another.

    evaporation: share by iteration, 0 to 1. greed: probability of the best cell outright. turn: factor on η
    for each 45° of a turn.
    """

    evaporation: Callable[[float], float]
    greed: float = 0.0
    turn: float = 1.0


_BASIC = Habits(lambda _: 0.3)
_IMPROVED = Habits(lambda t: 0.05 + 0.4 * math.exp(-0.5 * (t / 0.4) ** 2), greed=0.1, turn=0.95)


def ant_colony(sea: Sea, start: Point, goal: Point, seed: int, deadline: Deadline) -> Path:
    """The basic ant system."""
    return colony(sea, start, goal, seed, deadline, _BASIC)


def improved_ant_colony(sea: Sea, start: Point, goal: Point, seed: int, deadline: Deadline) -> Path:
    """With a better transition rule and Gaussian evaporation."""
    return colony(sea, start, goal, seed, deadline, _IMPROVED)


def colony(sea: Sea, start: Point, goal: Point, seed: int, deadline: Deadline, habits: Habits) -> Path:
    """The best path of any ant.

    Raises:
        NoPath: no ant arrived.
    """
    draw = random.Random(seed)
    grid, first, last = _coarsest(sea, start, goal)
    trails = _Trails(grid, last)
    best: tuple[float, list[int]] = (math.inf, [])
    for iteration in range(ITERATIONS):
        arrived = []
        for _ in range(ANTS):
            deadline.check()
            way = trails.walk(first, draw, habits)
            if way is not None:
                arrived.append((trails.length(way), way))
        best = min([best, *arrived], key=lambda one: one[0])
        trails.evaporate(habits.evaporation(iteration / ITERATIONS))
        if not arrived:
            continue
        for length, way in [*arrived, best]:
            trails.lay(way, best[0] / length / len(arrived))
    if not best[1]:
        raise NoPath(f"none of {ANTS * ITERATIONS} ants arrived")
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
        self._eighths = _eighths(grid.columns)
        self._pheromone: dict[tuple[int, int], float] = {}
        self._level = _FIRST_PHEROMONE  # of the steps that no ant has taken
        row, column = divmod(goal, grid.columns)
        self._visibility = [
            (1.0 / (1.0 + math.hypot(cell // grid.columns - row, cell % grid.columns - column)))
            for cell in range(self._expansion.size)
        ]

    def walk(self, start: int, draw: random.Random, habits: Habits) -> list[int] | None:
        """The cells of one ant; None where it got stuck."""
        way, visited, last = [start], {start}, 0
        while way[-1] != self._goal:
            here = way[-1]
            steps = [delta for delta, _ in self._expansion.moves(here) if here + delta not in visited]
            if not steps:
                return None
            nearest = max(self._visibility[here + delta] for delta in steps)
            weights = []
            for delta in steps:
                eta = self._visibility[here + delta] / nearest
                if habits.turn < 1.0 and last:
                    eta *= habits.turn ** self._eighths[last, delta]
                weights.append(self._pheromone.get((here, delta), self._level) ** _ALPHA * eta**_BETA)
            if habits.greed and draw.random() < habits.greed:
                last = steps[weights.index(max(weights))]
            else:
                last = draw.choices(steps, weights)[0]
            way.append(here + last)
            visited.add(here + last)
        return way

    def length(self, way: list[int]) -> float:
        """In cell sides."""
        total = 0
        for here, there in pairwise(way):
            total += next(cost for delta, cost in self._expansion.moves(here) if here + delta == there)
        return total / STRAIGHT

    def evaporate(self, share: float) -> None:
        """On all steps."""
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


def _eighths(columns: int) -> dict[tuple[int, int], int]:
    """The turn between any two steps, in 45°."""
    ring = [1, columns + 1, columns, columns - 1, -1, -columns - 1, -columns, 1 - columns]
    return {(a, b): min((n - m) % 8, (m - n) % 8) for m, a in enumerate(ring) for n, b in enumerate(ring)}
