"""Random grid maps, and an oracle: Dijkstra's algorithm on the rules as they are written."""

import heapq
import math
import random
from collections.abc import Callable
from itertools import pairwise

from companion.planning.grid import GridMap

STEPS = ((1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1))
"""Column and row of a step, by direction. Odd directions are diagonal."""

StepCost = Callable[[int, int, int], float]
"""From a cell, to a cell, direction."""


def random_grid(draw: random.Random) -> tuple[GridMap, int, int]:
    """Noise or boxes, most of them small, some wider or higher than a word of 64 cells; start and goal
    differ."""
    long_side = draw.randint(2, 150) if draw.random() < 0.1 else draw.randint(2, 16)
    width, height = draw.sample([long_side, draw.randint(1, 16)], 2)
    if draw.random() < 0.6:
        share = draw.choice((0.0, 0.1, 0.2, 0.3, 0.4, 0.5))
        free = bytearray(draw.random() >= share for _ in range(width * height))
    else:
        free = bytearray(b"\1" * (width * height))
        for _ in range(draw.randint(1, 8)):
            left, top = draw.randrange(width), draw.randrange(height)
            right, bottom = left + draw.randint(1, 12), top + draw.randint(1, 12)
            for row in range(top, min(bottom, height)):
                for column in range(left, min(right, width)):
                    free[row * width + column] = 0
    start, goal = draw.sample(range(width * height), 2)
    free[start] = free[goal] = 1
    return GridMap(bytes(free), width, height), start, goal


def steps_from(grid: GridMap, cell: int) -> list[tuple[int, int]]:
    """Direction and cell of every step that the rules allow."""

    def is_free(column: int, row: int) -> bool:
        inside = 0 <= column < grid.width and 0 <= row < grid.height
        return inside and bool(grid.free[row * grid.width + column])

    column, row = cell % grid.width, cell // grid.width
    return [
        (direction, cell + along * grid.width + across)
        for direction, (across, along) in enumerate(STEPS)
        if is_free(column + across, row + along)
        and is_free(column + across, row)
        and is_free(column, row + along)
    ]


def least_cost(grid: GridMap, start: int, goal: int, step_cost: StepCost) -> float:
    """The cost of the cheapest path; infinite where there is none."""
    costs = {start: 0.0}
    open_list = [(0.0, start)]
    while open_list:
        cost, cell = heapq.heappop(open_list)
        if cell == goal:
            return cost
        if cost > costs[cell]:
            continue
        for direction, successor in steps_from(grid, cell):
            tentative = cost + step_cost(cell, successor, direction)
            if tentative < costs.get(successor, math.inf):
                costs[successor] = tentative
                heapq.heappush(open_list, (tentative, successor))
    return math.inf


def path_cost(grid: GridMap, cells: tuple[int, ...], step_cost: StepCost) -> float:
    """The cost of a path, each step of which the rules must allow."""
    total = 0.0
    for cell, successor in pairwise(cells):
        direction = next(way for way, reached in steps_from(grid, cell) if reached == successor)
        total += step_cost(cell, successor, direction)
    return total
