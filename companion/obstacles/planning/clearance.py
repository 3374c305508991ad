"""Clearance around the boat by a lookup: obstacles, suspects and the fence in one grid of bytes.

The grid is one large integer, a byte a cell: a shift moves all cells at once and a union is an OR, so a
dilation (J. Serra, *Image Analysis and Mathematical Morphology*, 1982) costs a few operations whatever the
number of obstacles. Dilations by 1, 2, 3 … cells are added up; the sum in a cell is the number of them that
reach it, and so its distance to the nearest obstacle.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Final, Protocol

from companion.core.geo import Point

LEVELS: Final = 10  # discs, a cell apart: two margins
LEVEL: Final = 31  # bits of a byte: discs that reach the cell, 0 far from everything,
SOLID: Final = 32  # the hull would touch something certain,
FENCE: Final = 64  # too near the fence, or outside,
UNSEEN: Final = 128  # no ranger has seen it free
COARSE: Final = 2  # cells of a fence cell and of the wave's grid: half a hull's width


class ClearanceBounds(Protocol):
    """A region that the boat must stay within."""

    @property
    def is_active(self) -> bool:
        """Whether there is any limit."""

    @property
    def version(self) -> int:
        """Changes with the limits."""

    def room_m(self, point: Point, course_rad: float, reach_m: float) -> float:
        """Free distance along a course, at most reach_m."""

    def is_near(self, point: Point, reach_m: float) -> bool:
        """Whether a line may be within reach_m."""

    def is_charted(self, point: Point) -> bool:
        """Whether the place is inside an uploaded inclusion area, whose owner knows the water."""

    def margin_within_m(self, north_m: float, east_m: float, limit_m: float) -> float:
        """Signed distance to the nearest line, positive inside, limited to ±limit_m."""


class ClearanceField:
    """A square around `centre`; cells are numbered row by row from the south-west, `width` a row."""

    def __init__(self, at: Point, cell_m: float, reach_m: float) -> None:
        self.cell_m = cell_m
        side_m = COARSE * cell_m
        self.half = COARSE * math.ceil(reach_m / side_m) + LEVELS
        self.width = 2 * self.half
        self.south_m = side_m * round(at.north_m / side_m) - self.half * cell_m
        self.west_m = side_m * round(at.east_m / side_m) - self.half * cell_m
        self.centre = Point(self.south_m + self.half * cell_m, self.west_m + self.half * cell_m)
        self.cells = bytes(self.width * self.width)
        self._fenced = self._unseen = 0
        self._filled: tuple[object, ...] | None = None  # what the cells were filled with

    def fill(self, solid: Sequence[Point], suspects: Sequence[Point], hull_m: float) -> None:
        """Mark obstacles. suspects: the solid ones as well; hull_m: nearest distance of the boat's centre."""
        filled = (list(solid), list(suspects), hull_m, self._fenced, self._unseen)
        if filled == self._filled:
            return
        self._filled = filled
        row_bits = 8 * self.width
        size = self.width * self.width
        marks = self._marked(suspects)
        certain = marks if len(solid) == len(suspects) else self._marked(solid)
        if not marks:
            self.cells = (self._fenced | self._unseen).to_bytes(size, "little")
            return
        skipped = (marks & -marks).bit_length() // row_bits - LEVELS  # rows below the first disc
        marks, certain = marks >> skipped * row_bits, certain >> skipped * row_bits
        total, disc, hull_cells = marks, marks, round(hull_m / self.cell_m)
        for step in range(1, LEVELS):
            disc = grown(disc, row_bits, step)
            total += disc
        for step in range(1, hull_cells + 1 if certain else 0):
            certain = grown(certain, row_bits, step)
        total = (total + certain * SOLID) << skipped * row_bits | self._fenced | self._unseen
        self.cells = total.to_bytes(size, "little")

    def at(self, north_m: float, east_m: float) -> int:
        """The byte of a place; 0 outside the grid."""
        row, column = int((north_m - self.south_m) / self.cell_m), int((east_m - self.west_m) / self.cell_m)
        width = self.width
        if north_m < self.south_m or east_m < self.west_m or row >= width or column >= width:
            return 0
        return self.cells[row * width + column]

    def distance_m(self, north_m: float, east_m: float) -> float:
        """Distance to the nearest obstacle, suspects included; LEVELS cells where none is nearer."""
        return (LEVELS - (self.at(north_m, east_m) & LEVEL)) * self.cell_m

    def look(self, are_known: Callable[[Sequence[float], Sequence[float]], Iterable[Iterable[bool]]]) -> None:
        """Mark the cells that are not known to be free of obstacles. are_known: row by row, for the places
        where these rows and columns cross.
        """
        middles_m = [(cell + 0.5) * COARSE * self.cell_m for cell in range(self.width // COARSE)]
        norths_m = [self.south_m + middle_m for middle_m in middles_m]
        easts_m = [self.west_m + middle_m for middle_m in middles_m]
        marks = (bytes((UNSEEN,)) * COARSE, bytes(COARSE))
        rows = [
            b"".join([marks[is_known] for is_known in row]) * COARSE for row in are_known(norths_m, easts_m)
        ]
        self._unseen = int.from_bytes(b"".join(rows), "little")

    def fence(self, bounds: ClearanceBounds, margin_m: float) -> None:
        """Mark the cells whose centre has less margin to the fence.

        A square whose centre is farther from every line than its corners is wholly free or wholly outside;
        the others are divided (a quadtree).
        """
        rows = bytearray(self.width * self.width)
        side = self.width // COARSE
        todo = [(0, 0, 1 << max(side - 1, 1).bit_length())]
        while todo:
            row, column, size = todo.pop()
            if row >= side or column >= side:
                continue
            half_m = 0.5 * size * COARSE * self.cell_m
            north_m = self.south_m + row * COARSE * self.cell_m + half_m
            east_m = self.west_m + column * COARSE * self.cell_m + half_m
            reach_m = math.sqrt(2.0) * half_m
            room_m = bounds.margin_within_m(north_m, east_m, margin_m + reach_m + 1.0) - margin_m
            if size > 1 and abs(room_m) < reach_m:
                half = size // 2
                todo += [(row + r, column + c, half) for r in (0, half) for c in (0, half)]
            elif room_m < 0.0:
                first, last = column * COARSE, min((column + size) * COARSE, self.width)
                mark = bytes((FENCE,)) * (last - first)
                for at in range(row * COARSE, min((row + size) * COARSE, self.width)):
                    rows[at * self.width + first : at * self.width + last] = mark
        self._fenced = int.from_bytes(rows, "little")

    def _marked(self, obstacles: Sequence[Point]) -> int:
        """A 1 in each obstacle's cell. None nearer to the edge than the largest disc."""
        marks, width, cell_m, last = bytearray(self.width * self.width), self.width, self.cell_m, LEVELS
        high = width - LEVELS
        for north_m, east_m in obstacles:
            row, column = int((north_m - self.south_m) / cell_m), int((east_m - self.west_m) / cell_m)
            if last <= row < high and last <= column < high:
                marks[row * width + column] = 1
        return int.from_bytes(marks, "little")


def grown(marks: int, row_bits: int, step: int, cell_bits: int = 8) -> int:
    """One cell more on every side. Squares and diamonds in turn make octagons, within 8 % of a disc."""
    beside = marks | marks << cell_bits | marks >> cell_bits
    upright = beside if step % 2 else marks
    return beside | upright << row_bits | upright >> row_bits
