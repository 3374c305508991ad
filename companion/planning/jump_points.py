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
_STEPS = ((1, 0), (-1, 0), (0, 1), (0, -1))
_ANY = -1
_UNREACHED = 1 << 62

Cell = tuple[int, int]
"""Column and row, from 1: a border of blocked cells surrounds the map."""
Reached = list[tuple[Cell, int]]
"""Jump points with the direction of arrival."""


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
        self._known: dict[tuple[Cell, int], Reached] = {}

    def shortest(self, start: int, goal: int) -> tuple[list[int] | None, int, int]:
        """The cells where a shortest path turns, ends included, its cost, and how many cells were expanded.

        Cells are numbered row by row; both must be free, and not the same. None where there is no path.
        """
        search = _Search(self, self._cell(goal))
        if not search.run(self._cell(start)):
            return None, 0, search.expanded
        turns = [(y - 1) * self._width + x - 1 for x, y in search.walk_back(self._cell(start))]
        return turns, search.goal_cost, search.expanded

    def _cell(self, number: int) -> Cell:
        return number % self._width + 1, number // self._width + 1

    def first_jumps(self, start: Cell) -> Reached:
        """The jump points that the start leads to."""
        reached = [self._straight(direction, start) for direction in (_EAST, _WEST, _SOUTH, _NORTH)]
        for along in (_SOUTH, _NORTH):
            for across in (_EAST, _WEST):
                reached += self._diagonal(across, along, start)
        return [jump for jump in reached if jump is not None]

    def jumps(self, cell: Cell, direction: int) -> Reached:
        """The jump points that one leads to which was reached in a direction.

        Straight on, and to the sides on which a wall ends.
        """
        if (cell, direction) not in self._known:
            reached = [self._straight(direction, cell)]
            for side in (_SOUTH, _NORTH) if direction <= _WEST else (_EAST, _WEST):
                if self.turns(direction, side, cell):
                    reached.append(self._straight(side, cell))
                    across, along = (direction, side) if direction <= _WEST else (side, direction)
                    reached += self._diagonal(across, along, cell)
            self._known[cell, direction] = [jump for jump in reached if jump is not None]
        return self._known[cell, direction]

    def turns(self, direction: int, side: int, cell: Cell) -> bool:
        """Whether a wall beside a jump point that was reached in a direction ends on this side."""
        beside = _moved(cell, side)
        behind = _moved(beside, direction, -1)
        return self._is_free(beside) and not self._is_free(behind)

    def is_open(self, cell: Cell, across: int, along: int) -> bool:
        """Whether a diagonal step is allowed: no corner is cut."""
        beside = _moved(cell, across)
        return all(map(self._is_free, (beside, _moved(cell, along), _moved(beside, along))))

    def stop(self, direction: int, cell: Cell) -> int:
        """The column or row of the first stop of a straight scan from a cell."""
        line, at = (cell[1], cell[0]) if direction <= _WEST else cell
        stops = self._stops[direction][line]
        if direction in (_EAST, _SOUTH):
            ahead = stops >> (at + 1)
            return at + (ahead & -ahead).bit_length()
        return (stops & ((1 << at) - 1)).bit_length() - 1

    def _straight(self, direction: int, cell: Cell) -> tuple[Cell, int] | None:
        """The jump point at the end of a scan; None where that is a blocked cell."""
        stop = self.stop(direction, cell)
        reached = (stop, cell[1]) if direction <= _WEST else (cell[0], stop)
        return (reached, direction) if self._is_free(reached) else None

    def _diagonal(self, across: int, along: int, cell: Cell) -> list[tuple[Cell, int] | None]:
        """Step by step as far as no corner is cut, with both straight scans at each step."""
        reached = []
        while self.is_open(cell, across, along):
            cell = _moved(_moved(cell, across), along)
            reached += [self._straight(across, cell), self._straight(along, cell)]
        return reached

    def _is_free(self, cell: Cell) -> bool:
        return bool(self._rows[cell[1]] >> cell[0] & 1)


class _Search:
    """One search: G and parents of the jump points reached, and the open list."""

    def __init__(self, searcher: Searcher, goal: Cell) -> None:
        self._map, self._goal = searcher, goal
        self._costs: dict[Cell, int] = {}
        self._parents: dict[Cell, Cell] = {}
        self._stacks: dict[int, list[tuple[int, Cell, int]]] = {}
        self._buckets: list[int] = []
        self.expanded = 1
        self.goal_cost = _UNREACHED

    def run(self, start: Cell) -> bool:
        """Whether the goal was reached."""
        self._costs[start] = 0
        self._reach_goal(start, _ANY, 0)
        self._expand(start, 0, self._map.first_jumps(start))
        while self._buckets:
            stack = self._stacks[self._buckets[0]]
            if not stack:
                del self._stacks[heappop(self._buckets)]
                continue
            total, cell, direction = stack.pop()
            if total >= self.goal_cost:
                if total >> _BUCKET_SHIFT > self.goal_cost >> _BUCKET_SHIFT:
                    break
                continue
            cost = total - _distance(cell, self._goal)
            if self._costs[cell] != cost:
                continue  # stale: reached more cheaply since
            self.expanded += 1
            self._reach_goal(cell, direction, cost)
            self._expand(cell, cost, self._map.jumps(cell, direction))
        return self.goal_cost < _UNREACHED

    def walk_back(self, start: Cell) -> list[Cell]:
        """The cells where the path turns, from start to goal, both included."""
        (x, y), turns, last = self._goal, [self._goal], None
        while (x, y) != start:
            before_x, before_y = self._parents[x, y]
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

    def _expand(self, cell: Cell, cost: int, jumps: Reached) -> None:
        """Lower G of the jump points that are reached more cheaply, and put them on the open list."""
        for reached, direction in jumps:
            tentative = cost + _distance(cell, reached)
            total = tentative + _distance(reached, self._goal)
            if tentative >= self._costs.get(reached, _UNREACHED) or total >= self.goal_cost:
                continue
            self._costs[reached] = tentative
            self._parents[reached] = cell
            bucket = total >> _BUCKET_SHIFT
            if bucket not in self._stacks:
                self._stacks[bucket] = []
                heappush(self._buckets, bucket)
            self._stacks[bucket].append((total, reached, direction))

    def _reach_goal(self, cell: Cell, direction: int, cost: int) -> None:
        tentative = cost + _distance(cell, self._goal)
        if tentative < self.goal_cost and self._sees_goal(cell, direction):
            self.goal_cost = tentative
            self._parents[self._goal] = cell

    def _sees_goal(self, cell: Cell, direction: int) -> bool:
        """Whether the goal lies on the way to a jump point: diagonally, then straight on, or part of it.

        direction: of arrival, or _ANY at the start.
        """
        goal_x, goal_y = self._goal
        across, along = goal_x - cell[0], goal_y - cell[1]
        ahead = [_EAST if across > 0 else _WEST] if across else []
        ahead += [_SOUTH if along > 0 else _NORTH] if along else []
        for way in ahead if direction != _ANY else ():
            is_side = (way <= _WEST) != (direction <= _WEST)
            if not (self._map.turns(direction, way, cell) if is_side else way == direction):
                return False
        for _ in range(min(abs(across), abs(along))):
            if not self._map.is_open(cell, ahead[0], ahead[1]):
                return False
            cell = _moved(_moved(cell, ahead[0]), ahead[1])
        if cell == self._goal:
            return True
        way = ahead[0] if cell[0] != goal_x else ahead[-1]
        stop, goal_at = self._map.stop(way, cell), goal_x if way <= _WEST else goal_y
        return stop >= goal_at if way in (_EAST, _SOUTH) else stop <= goal_at


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


def _moved(cell: Cell, direction: int, steps: int = 1) -> Cell:
    step_x, step_y = _STEPS[direction]
    return cell[0] + steps * step_x, cell[1] + steps * step_y


def _distance(a: Cell, b: Cell) -> int:
    """The octile distance: the cost on an empty map, and of every jump."""
    across, along = abs(a[0] - b[0]), abs(a[1] - b[1])
    return (max(across, along) - min(across, along)) * STRAIGHT + min(across, along) * DIAGONAL


def _sign(value: int) -> int:
    return (value > 0) - (value < 0)
