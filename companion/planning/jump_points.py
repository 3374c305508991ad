"""Jump point search on a grid of free and blocked cells: the Python twin of `_jump_points.pyx`.

D. Harabor and A. Grastien, *Online Graph Pruning for Pathfinding on Grid Maps* (AAAI 2011), with the block
scans and the pruning of intermediate turning points of *Improving Jump Point Search* (ICAPS 2014), in the
form for grids without corner cutting: a diagonal step needs both cells beside it to be free.

On such a grid a shortest path needs to turn only in the open, from a diagonal to a straight stretch, or
beside the end of a wall. So the search keeps only the cells beside the end of a wall ("jump points"),
reached by a diagonal stretch, which may be empty, and then a straight one. Each line of the map is a number
with a bit a cell, and a scan for the next jump point looks for the next bit that is set. A wall ends beside
a cell if the neighbour to the side is free and the one diagonally behind it is blocked.

Costs are whole numbers, STRAIGHT for a step along a row or column and DIAGONAL for √2 of it rounded down, so
that sums are exact. The open list is a row of stacks by F; entries of one stack are less than a third of a
step apart. The order in a stack is no order of F, so a goal ends the search only when no entry is left below
its cost.
"""

from collections.abc import Sequence
from heapq import heappop, heappush

STRAIGHT = 1_000_000_000
DIAGONAL = 1_414_213_562
_BUCKET_SHIFT = 28
_EAST, _WEST, _SOUTH, _NORTH = range(4)  # south: towards higher rows
_NOTHING = -1

Cell = tuple[int, int]
"""Column and row, from 1: a border of blocked cells surrounds the map."""


class Searcher:
    """A grid map as lines of bits, and shortest paths on it."""

    def __init__(self, cells: bytes, width: int, height: int) -> None:
        """cells: one byte a cell, row by row; 0 is blocked."""
        self._width = width
        self._rows = [0, *(_bits(cells[width * y : width * (y + 1)]) for y in range(height)), 0]
        self._columns = [0, *(_bits(cells[x::width]) for x in range(width)), 0]
        self._stops = (
            *_stops(self._rows, (1 << (width + 2)) - 1),
            *_stops(self._columns, (1 << (height + 2)) - 1),
        )
        self._search: _Search | None = None

    def shortest(self, start: int, goal: int) -> tuple[list[int] | None, int, int]:
        """The cells where a shortest path turns, ends included, its cost, and how many cells were expanded.

        Cells are numbered row by row; both must be free, and not the same. None where there is no path.
        """
        search = _Search(self._rows, self._columns, self._stops, self._cell(goal))
        found = search.run(self._cell(start))
        if not found:
            return None, 0, search.expanded
        turns = [(y - 1) * self._width + x - 1 for x, y in search.walk_back(self._cell(start))]
        return turns, search.goal_cost, search.expanded

    def _cell(self, number: int) -> Cell:
        return number % self._width + 1, number // self._width + 1


class _Search:
    """One search: G, directions of arrival and parents of the cells reached, and the open list."""

    def __init__(
        self, rows: Sequence[int], columns: Sequence[int], stops: Sequence[Sequence[int]], goal: Cell
    ) -> None:
        self._rows, self._columns, self._stops, self._goal = rows, columns, stops, goal
        self._costs: dict[Cell, int] = {}
        self._parents: dict[Cell, tuple[Cell, int]] = {}
        self._stacks: dict[int, list[tuple[int, Cell]]] = {}
        self._buckets: list[int] = []
        self.expanded = 1
        self.goal_cost = -1

    def run(self, start: Cell) -> bool:
        """Whether the goal was reached."""
        self._costs[start] = 0
        for direction in (_EAST, _WEST, _SOUTH, _NORTH):
            self._go_straight(direction, start, 0, start)
        for along in (_SOUTH, _NORTH):
            for across in (_EAST, _WEST):
                self._go_diagonally(across, along, start, 0, start)
        while self._buckets:
            stack = self._stacks[self._buckets[0]]
            if not stack:
                del self._stacks[heappop(self._buckets)]
                continue
            total, cell = stack.pop()
            if 0 <= self.goal_cost <= total:
                if total >> _BUCKET_SHIFT > self.goal_cost >> _BUCKET_SHIFT:
                    break
                continue
            cost = total - self._estimate(cell)
            if self._costs[cell] != cost:
                continue  # stale: reached more cheaply since
            self.expanded += 1
            self._expand(self._parents[cell][1], cell, cost)
        return self.goal_cost >= 0

    def walk_back(self, start: Cell) -> list[Cell]:
        """The cells where the path turns, from start to goal, both included."""
        (x, y), turns, last = self._goal, [self._goal], None
        while (x, y) != start:
            before_x, before_y = self._parents[x, y][0]
            across, along = before_x - x, before_y - y
            diagonal = min(abs(across), abs(along))
            step_x, step_y = _sign(across), _sign(along)
            straight = max(abs(across), abs(along)) - diagonal
            straight_step = (step_x, 0) if abs(across) > abs(along) else (0, step_y)
            # Backwards the straight stretch comes first.
            for step, count in ((straight_step, straight), ((step_x, step_y), diagonal)):
                if count:
                    if last not in (None, step):
                        turns.append((x, y))
                    last = step
                    x, y = x + step[0] * count, y + step[1] * count
        return [start, *turns[::-1]]

    def _expand(self, direction: int, cell: Cell, cost: int) -> None:
        """From a jump point go on straight, and to the sides on which a wall ends."""
        x, y = cell
        self._go_straight(direction, cell, cost, cell)
        if direction in (_EAST, _WEST):
            behind = x - 1 if direction == _EAST else x + 1
            for side, row in ((_SOUTH, self._rows[y + 1]), (_NORTH, self._rows[y - 1])):
                if row >> x & 1 and not row >> behind & 1:
                    self._go_straight(side, cell, cost, cell)
                    self._go_diagonally(direction, side, cell, cost, cell)
        else:
            behind = y - 1 if direction == _SOUTH else y + 1
            for side, column in ((_EAST, self._columns[x + 1]), (_WEST, self._columns[x - 1])):
                if column >> y & 1 and not column >> behind & 1:
                    self._go_straight(side, cell, cost, cell)
                    self._go_diagonally(side, direction, cell, cost, cell)

    def _go_straight(self, direction: int, cell: Cell, cost: int, parent: Cell) -> None:
        """Scan from a cell, which need not be a jump point itself, for the next jump point or the goal."""
        x, y = cell
        goal_x, goal_y = self._goal
        stops = self._stops[direction]
        if direction in (_EAST, _WEST):
            scan = _scan_up if direction == _EAST else _scan_down
            stop = scan(stops[y], self._rows[y], x, goal_x if y == goal_y else _NOTHING)
            reached, steps = (stop, y), abs(stop - x)
        else:
            scan = _scan_up if direction == _SOUTH else _scan_down
            stop = scan(stops[x], self._columns[x], y, goal_y if x == goal_x else _NOTHING)
            reached, steps = (x, stop), abs(stop - y)
        if stop != _NOTHING:
            self._reach(reached, direction, cost + steps * STRAIGHT, parent)

    def _go_diagonally(self, across: int, along: int, cell: Cell, cost: int, parent: Cell) -> None:
        """Step by step as far as no corner is cut, with both straight scans at each step."""
        x, y = cell
        step_x = 1 if across == _EAST else -1
        step_y = 1 if along == _SOUTH else -1
        while True:
            row, next_row = self._rows[y], self._rows[y + step_y]
            if not (row >> (x + step_x) & next_row >> x & next_row >> (x + step_x) & 1):
                return
            x, y, cost = x + step_x, y + step_y, cost + DIAGONAL
            if (x, y) == self._goal:
                self._reach((x, y), across, cost, parent)
                return
            self._go_straight(across, (x, y), cost, parent)
            self._go_straight(along, (x, y), cost, parent)

    def _reach(self, cell: Cell, direction: int, cost: int, parent: Cell) -> None:
        """Lower G of a jump point or of the goal, and put it on the open list."""
        total = cost + self._estimate(cell)
        if cost >= self._costs.get(cell, cost + 1) or 0 <= self.goal_cost <= total:
            return
        self._costs[cell] = cost
        self._parents[cell] = parent, direction
        if cell == self._goal:
            self.goal_cost = cost
        bucket = total >> _BUCKET_SHIFT
        if bucket not in self._stacks:
            self._stacks[bucket] = []
            heappush(self._buckets, bucket)
        self._stacks[bucket].append((total, cell))

    def _estimate(self, cell: Cell) -> int:
        """The octile distance to the goal: the cost on an empty map."""
        across, along = abs(cell[0] - self._goal[0]), abs(cell[1] - self._goal[1])
        return (max(across, along) - min(across, along)) * STRAIGHT + min(across, along) * DIAGONAL


def _bits(cells: bytes) -> int:
    """One bit a cell, the first cell as bit 1."""
    return int("".join("1" if cell else "0" for cell in reversed(cells)), 2) << 1


def _stops(lines: Sequence[int], whole: int) -> tuple[list[int], list[int]]:
    """Where a scan ends in rising and in falling order: blocked cells, and cells beside the end of a wall."""
    rising, falling = [], []
    for above, line, below in zip([0, *lines], lines, [*lines[1:], 0], strict=False):
        blocked = whole & ~line
        rising.append(blocked | above & ~(above << 1) | below & ~(below << 1))
        falling.append(blocked | above & ~(above >> 1) | below & ~(below >> 1))
    return rising, falling


def _scan_up(stops: int, cells: int, at: int, goal: int) -> int:
    """The next jump point or the goal in rising order; _NOTHING where a blocked cell comes first."""
    ahead = stops >> (at + 1)
    stop = at + (ahead & -ahead).bit_length()
    if at < goal <= stop:
        return goal
    return stop if cells >> stop & 1 else _NOTHING


def _scan_down(stops: int, cells: int, at: int, goal: int) -> int:
    """The same in falling order."""
    stop = (stops & ((1 << at) - 1)).bit_length() - 1
    if stop <= goal < at:
        return goal
    return stop if cells >> stop & 1 else _NOTHING


def _sign(value: int) -> int:
    return (value > 0) - (value < 0)
