"""The way that is left from every place around the boat to the goal, around all known obstacles.

A navigation function (O. Brock, O. Khatib, *High-speed navigation using the global dynamic window approach*,
ICRA 1999): a wave from the goal over the free cells. Its only minimum is the goal, so a boat that follows it
neither stays in a pocket nor changes its mind between two sides. The wave grows by a cell a step, squares and
diamonds in turn (octagons, within 8 % of circles), as shifts of one large integer with a bit for each cell.
It enters cells within the margin of an obstacle only at every second step, so that a narrow gap is taken only
where the way around is long. For a goal beyond the grid waves begin on the edge, each
as late as the goal is far from there. Nor does it enter water that no ranger has seen at more than that pace:
a way that was seen free is taken before one that is only hoped for.
"""

from collections.abc import Callable
from typing import Final

from companion.core.geo import Point, distance_m
from companion.obstacles.planning.clearance import (
    COARSE,
    FENCE,
    LEVEL,
    LEVELS,
    SOLID,
    UNSEEN,
    ClearanceField,
    grown,
)

_MOST_STEPS: Final = 250  # with _INSIDE a byte's worth: 100 m
UNSEEN_COST: Final = 2  # steps to enter a cell within the margin, or one that no ranger has seen
_FARTHER: Final = 0.5  # of half the grid: where the boat leaves it, it may be farther from the goal by this
_INSIDE: Final = 3  # steps of the last wave, over all cells: what lies within an obstacle's margin


class CostToGo:
    """Computed once for a map and a goal."""

    def __init__(
        self,
        field: ClearanceField,
        here: Point,
        goal: Point,
        margin_m: float,
        hull_m: float,
        shuts: Callable[[float, float], bool] | None = None,
    ) -> None:
        """hull_m: nearest distance of the boat's centre. shuts: where no way leads on over water that was not
        seen. is_open: whether a way leads to the goal.
        """
        self._width = width = field.width // COARSE
        self.side_m = COARSE * field.cell_m
        self._south_m, self._west_m = field.south_m, field.west_m
        free, wide = (
            self._open(field, hull_m, SOLID | FENCE),
            self._open(field, margin_m, SOLID | FENCE | UNSEEN),
        )
        if shuts is not None:
            free &= ~self._shut(field, shuts)
            wide &= free
        reached, waves = 0, list[int]()
        late = self._seeds(here, goal, free, width)
        near = 1 << self._cell(here)
        for _ in range(_INSIDE):
            near = grown(near, width, 1, 1)
        still = 0
        for steps in range(1, _MOST_STEPS + 1):
            before = reached
            passable = free if steps % UNSEEN_COST == 0 else wide
            reached |= (grown(reached, width, steps // UNSEEN_COST, 1) & passable) | late.pop(steps, 0)
            waves.append(reached)
            still = 0 if reached != before else still + 1
            if still > 2 * UNSEEN_COST and not late:
                break
        self.is_open = bool(reached & near)
        everywhere = (1 << width * width) - 1
        for step in range(_INSIDE):
            reached |= grown(reached, width, step, 1) & everywhere
            waves.append(reached)
        self.steps = len(waves)
        self.cells = _counted(waves, width * width)

    def at(self, north_m: float, east_m: float) -> float:
        """The way that is left, in m, interpolated; at the edge of the grid that of the nearest cell."""
        most = self._width - 2
        row = min(max((north_m - self._south_m) / self.side_m - 0.5, 0.0), most - 0.001)
        column = min(max((east_m - self._west_m) / self.side_m - 0.5, 0.0), most - 1.001)
        south, west = int(row), int(column)
        up, right = row - south, column - west
        first = south * self._width + west
        cells = self.cells
        low = cells[first] + right * (cells[first + 1] - cells[first])
        first += self._width
        high = cells[first] + right * (cells[first + 1] - cells[first])
        return (self.steps - low - up * (high - low)) * self.side_m

    def _cell(self, at: Point) -> int:
        last = self._width - 2
        row = min(max(int((at.north_m - self._south_m) / self.side_m), 0), last)
        return row * self._width + min(max(int((at.east_m - self._west_m) / self.side_m), 0), last)

    def _open(self, field: ClearanceField, clear_m: float, shut: int) -> int:
        """A 1 in each cell with this clearance and none of these marks; 0 in the last column, so that no wave
        enters the next row.
        """
        table = bytes(
            b"01"[(LEVELS - (byte & LEVEL)) * field.cell_m >= clear_m and not byte & shut]
            for byte in range(256)
        )
        marks = bytearray()
        for row in range(self._width):
            marks += self._row(field, row).translate(table)[:-1] + b"0"
        return int(marks[::-1], 2)

    def _row(self, field: ClearanceField, row: int) -> bytes:
        first = COARSE * row * field.width
        return field.cells[first : first + field.width : COARSE]

    def _shut(self, field: ClearanceField, shuts: Callable[[float, float], bool]) -> int:
        """A 1 in each cell that is shut and that no ranger has seen."""
        width = self._width
        marks = bytearray(b"0" * width * width)
        for row in range(width):
            north_m = self._south_m + (row + 0.5) * self.side_m
            for column, byte in enumerate(self._row(field, row)):
                if byte & UNSEEN and shuts(north_m, self._west_m + (column + 0.5) * self.side_m):
                    marks[row * width + column] = ord("1")
        return int(marks[::-1], 2)

    def _seeds(self, here: Point, goal: Point, free: int, width: int) -> dict[int, int]:
        """Where waves begin, by step: at the goal, or on the edge where it is not much farther than here."""
        half_m = 0.5 * width * self.side_m
        north_m, east_m = goal.north_m - self._south_m - half_m, goal.east_m - self._west_m - half_m
        if max(abs(north_m), abs(east_m)) < half_m - 2.0 * self.side_m:
            return {1: 1 << self._cell(goal)}
        last = width - 2
        most_m = distance_m(here, goal) + _FARTHER * half_m
        cells = f"{free:0{width * width}b}"[::-1]
        edge = [(row, column) for row in range(last + 1) for column in (0, last)]
        edge += [(row, column) for column in range(1, last) for row in (0, last)]
        away = []
        for row, column in edge:
            if cells[row * width + column] == "1":
                at = Point(
                    self._south_m + (row + 0.5) * self.side_m, self._west_m + (column + 0.5) * self.side_m
                )
                away_m = distance_m(at, goal)
                if away_m < most_m:
                    away.append((away_m, row * width + column))
        late: dict[int, int] = {}
        nearest_m = min(away, default=(0.0, 0))[0]
        for at_m, cell in away:
            step = 1 + round((at_m - nearest_m) / self.side_m)
            late[step] = late.get(step, 0) | 1 << cell
        return late


def _counted(waves: list[int], size: int) -> bytes:
    """In how many of the waves, each of which holds the one before, each cell is: a byte a cell.

    Bit k of a count changes where the count passes a multiple of 2^k, so it is the parity of every 2^k-th
    wave, counted from the last.
    """
    total, ones = 0, int.from_bytes(b"\1" * size, "little")
    for bit in range(8):
        parity = 0
        for wave in waves[-(1 << bit) :: -(1 << bit)]:
            parity ^= wave
        digits = f"{parity:0{size}b}".encode("ascii")
        total |= (int.from_bytes(digits, "big") & ones) << bit
    return total.to_bytes(size, "little")
