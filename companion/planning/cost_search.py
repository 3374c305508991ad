"""A* on a grid whose steps cost what the place and the direction ask: the Python twin of `_cost_search.pyx`.

Each cell has a class, and a table gives for each class what a step of the eight directions costs in it; a
step costs the mean of both its cells. So one search serves a preference for open water, speed zones and
currents.

Costs are real numbers, the open list a row of stacks by F (R. B. Dial, *Algorithm 360: Shortest-path forest
with topological ordering*, CACM 12(11), 1969). The order within a stack is no order of F: a cell that is
reached more cheaply later is expanded again, and the goal ends the search only when no entry is left below
its cost. So the path is optimal whatever the width of a stack.

H is the cost of the straight line at the least that any class asks for each direction: the gauge of the
convex hull of the points that one unit of cost reaches, the greatest of its facets' linear forms. It is
consistent.
"""

import math
from collections.abc import Sequence
from heapq import heappop, heappush

STEPS = ((1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1))
"""Column and row of a step, by direction. Odd directions are diagonal."""
_BLOCKED = -1
_START = -1


class Search:
    """A grid with costs, for one search."""

    def __init__(
        self,
        cells: bytes,
        width: int,
        height: int,
        classes: Sequence[int],
        table: Sequence[float],
        facets: Sequence[tuple[float, float]],
        bucket_width: float,
        ring: int,  # noqa: ARG002  what the kernel's ring of stacks needs
    ) -> None:
        """cells: one byte a cell, row by row; 0 is blocked. table: eight costs a class, inf for never.

        facets: linear forms of H. bucket_width: range of F in one stack. ring: number of stacks in use at
        once.
        """
        self._stride = stride = width + 2
        self._classes = [_BLOCKED] * (stride * (height + 2))
        for y in range(height):
            row = [
                kind if cell else _BLOCKED
                for cell, kind in zip(
                    cells[width * y : width * (y + 1)], classes[width * y : width * (y + 1)], strict=True
                )
            ]
            at = (y + 1) * stride + 1
            self._classes[at : at + width] = row
        self._half = [0.5 * cost for cost in table]
        self._facets = facets
        self._per_width = 1.0 / bucket_width
        self._goal = (0, 0)
        self._expanded = 0

    def cheapest(
        self, start_x: int, start_y: int, goal_x: int, goal_y: int
    ) -> tuple[list[int] | None, float, int]:
        """The cells where the cheapest path turns, ends included, its cost, and how many cells were expanded.

        Both must be free, and not the same. None and inf where there is no path.
        """
        stride = self._stride
        start, goal = (start_y + 1) * stride + start_x + 1, (goal_y + 1) * stride + goal_x + 1
        self._goal = goal_x + 1, goal_y + 1
        cost, arrivals = self._run(start, goal)
        if math.isinf(cost):
            return None, cost, self._expanded
        turns, at, last = [goal], goal, None
        while at != start:
            direction = arrivals[at]
            if last not in (None, direction):
                turns.append(at)
            last = direction
            at -= STEPS[direction][1] * stride + STEPS[direction][0]
        outer = [(at // stride - 1) * (stride - 2) + at % stride - 1 for at in (start, *turns[::-1])]
        return outer, cost, self._expanded

    def _run(self, start: int, goal: int) -> tuple[float, dict[int, int]]:
        """The cost of the goal, and each reached cell's direction of arrival."""
        stride, classes, half = self._stride, self._classes, self._half
        deltas = [step_y * stride + step_x for step_x, step_y in STEPS]
        costs, arrivals, best = {start: 0.0}, {start: _START}, math.inf
        estimate = self._estimate(start % stride, start // stride)
        current = int(estimate * self._per_width)
        stacks = {current: [(estimate, 0.0, start)]}
        buckets = [current]
        while buckets:
            current = buckets[0]
            if not stacks[current]:
                del stacks[heappop(buckets)]
                continue
            total, cost, cell = stacks[current].pop()
            if total >= best:
                if current > int(best * self._per_width):
                    break
                continue
            if cost != costs[cell]:
                continue  # stale: reached more cheaply since
            self._expanded += 1
            y, x = divmod(cell, stride)
            for direction, delta in enumerate(deltas):
                successor = cell + delta
                if classes[successor] == _BLOCKED:
                    continue
                step_x, step_y = STEPS[direction]
                if direction & 1 and _BLOCKED in (classes[cell + step_x], classes[cell + step_y * stride]):
                    continue  # it would cut a corner
                step = half[8 * classes[cell] + direction] + half[8 * classes[successor] + direction]
                tentative = cost + step
                if math.isinf(tentative) or tentative >= costs.get(successor, math.inf):
                    continue
                total = tentative + self._estimate(x + step_x, y + step_y)
                if total >= best:
                    continue
                costs[successor] = tentative
                arrivals[successor] = direction
                if successor == goal:
                    best = tentative
                    continue
                bucket = max(int(total * self._per_width), current)
                if bucket not in stacks:
                    stacks[bucket] = []
                    heappush(buckets, bucket)
                stacks[bucket].append((total, tentative, successor))
        return best, arrivals

    def _estimate(self, x: int, y: int) -> float:
        across, along = float(self._goal[0] - x), float(self._goal[1] - y)
        return max([0.0, *(nx * across + ny * along for nx, ny in self._facets)])
