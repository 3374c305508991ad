"""Distance to home by water, from everywhere inside the fence.

The distance to the nearest goal solves the eikonal equation |∇d| = 1 in the allowed water. The fast marching
method (J. A. Sethian, "A fast marching level set method", PNAS 93, 1996) propagates a front from the goals
over the grid and visits each cell once. It runs in steps of constant cost, so no tick waits for it.
"""

import heapq
import math
from collections.abc import Sequence

from companion.core.geo import Point, distance_m
from companion.geofence.costmap import Costmap
from companion.geofence.fence import Fence

_LOOKS_A_STEP = 12
_CELLS_A_STEP = 150
_EXACT_CELLS = 10  # near a goal the distance is exact
_REACH_CELLS = 12  # search radius for a free cell


class DistanceField:
    """Distances over a grid, for goals inside the fence. Query it once it `is_complete`."""

    def __init__(self, fence: Fence, goals: Sequence[Point], grid: Costmap) -> None:
        """grid: of the same fence; a complete one can be reused."""
        self._fence = fence
        self.goals = tuple(goals)
        self.grid = grid
        self.arrival_m = [math.inf] * len(grid.free)
        self._front: list[tuple[float, int]] = []
        self._is_begun = False

    @property
    def is_complete(self) -> bool:
        """Whether the front has finished."""
        return self._is_begun and not self._front

    def advance(self) -> None:
        """Do one step of the computation."""
        if not self.grid.is_complete:
            self.grid.advance(_LOOKS_A_STEP)
        elif not self._is_begun:
            self._is_begun = True
            for goal in self.goals:
                self._begin_at(goal)
        else:
            self._march(_CELLS_A_STEP)

    def distance_m(self, point: Point) -> float:
        """Distance to a goal by water; infinite if there is no path."""
        cell = self._entry(point)
        return math.inf if cell is None else self.arrival_m[cell] + distance_m(point, self.grid.centre(cell))

    def way(self, point: Point) -> list[Point]:
        """Path from the entry cell to a goal, cell by cell; empty if there is none."""
        cell = self._entry(point)
        if cell is None:
            return []
        arrival_m, columns, cells = self.arrival_m, self.grid.columns, [cell]
        around = (1, -1, columns, -columns, columns + 1, columns - 1, 1 - columns, -1 - columns)
        while True:
            following = min((cell + step for step in around), key=arrival_m.__getitem__)
            if arrival_m[following] >= arrival_m[cell]:
                break
            cell = following
            cells.append(cell)
        last = self.grid.centre(cell)
        points = [self.grid.centre(one) for one in cells]
        return [*points, min(self.goals, key=lambda goal: distance_m(goal, last))]

    def _entry(self, point: Point) -> int | None:
        """The first cell of the path: the own one, else the best in a straight line."""
        grid, arrival_m = self.grid, self.arrival_m
        own = grid.cell(point)
        if arrival_m[own] < math.inf and distance_m(point, grid.centre(own)) <= grid.cell_m:
            return own
        found = [cell for cell in grid.around(point, _REACH_CELLS) if arrival_m[cell] < math.inf]
        found.sort(key=lambda cell: arrival_m[cell] + distance_m(point, grid.centre(cell)))
        is_outside = self._fence.is_outside(point)
        for cell in found:
            if is_outside or not self._fence.crosses(point, grid.centre(cell)):
                return cell
        return None

    def _begin_at(self, goal: Point) -> None:
        """Straight-line distances near a goal; farther off if it has no free cell near."""
        grid, margin_m = self.grid, self._fence.margin_m(goal)
        for cells in (_EXACT_CELLS, _REACH_CELLS):
            for cell in grid.around(goal, cells):
                centre = grid.centre(cell)
                away_m = distance_m(goal, centre)
                is_clear = away_m < margin_m or not self._fence.crosses(goal, centre)
                if away_m < self.arrival_m[cell] and is_clear:
                    self.arrival_m[cell] = away_m
                    heapq.heappush(self._front, (away_m, cell))
            if self._front:
                return

    def _march(self, cells: int) -> None:
        front, arrival_m, free = self._front, self.arrival_m, self.grid.free
        columns, cell_m = self.grid.columns, self.grid.cell_m
        for _ in range(cells):
            if not front:
                return
            reached_m, cell = heapq.heappop(front)
            if reached_m > arrival_m[cell]:
                continue  # reached by a shorter path meanwhile
            for beside in (cell - 1, cell + 1, cell - columns, cell + columns):
                if not free[beside] or arrival_m[beside] <= reached_m:
                    continue
                across_m = min(arrival_m[beside - 1], arrival_m[beside + 1])
                along_m = min(arrival_m[beside - columns], arrival_m[beside + columns])
                apart_m = abs(across_m - along_m)
                if apart_m < cell_m:
                    at_m = 0.5 * (across_m + along_m + math.sqrt(2.0 * cell_m * cell_m - apart_m * apart_m))
                else:
                    at_m = min(across_m, along_m) + cell_m
                if at_m < arrival_m[beside]:
                    arrival_m[beside] = at_m
                    heapq.heappush(front, (at_m, beside))
