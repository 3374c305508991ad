"""A way around: A* on the grid of clearances, where the path is blocked.

Unknown water is free. Cells within the margin cost more, so that a narrow gap is taken only where the way
around is long; cells to port of the line to the goal cost little more, so that equal ways go to starboard.
"""

import math
from array import array
from typing import Final

from companion.core.geo import Point, distance_m
from companion.obstacles.planning.clearance import FENCE, LEVEL, LEVELS, SOLID, ClearanceField
from companion.planning.grid import GridMap, NoGridPath, StepCosts, cheapest_path

_STRIDE: Final = 2  # cells of the field
_TIGHT: Final = 3.0  # cost within the margin,
_BESIDE: Final = 1.3  # and within twice the margin
_PORT: Final = 1.1
_AROUND_M: Final = 2.0  # free water is looked for within this of a blocked goal


def find_route(
    field: ClearanceField, here: Point, goal: Point, margin_m: float, hull_m: float
) -> list[Point] | None:
    """Corners from here to the goal, or to the edge of the grid on the way there; None if there is none."""
    width, side = field.width // _STRIDE, _STRIDE * field.cell_m
    rows = [field.cells[_STRIDE * row * field.width :][: field.width : _STRIDE] for row in range(width)]
    starboard, port = _classes(field.cell_m, margin_m, hull_m, 0), _classes(field.cell_m, margin_m, hull_m, 3)
    classed = bytearray()
    to_n, to_e = (goal.north_m - here.north_m) or 1e-9, goal.east_m - here.east_m
    left, right = (port, starboard) if to_n > 0.0 else (starboard, port)
    for row, cells in enumerate(rows):
        north_m = field.south_m + (row + 0.5) * side - here.north_m
        flips = (here.east_m + north_m * to_e / to_n - field.west_m) / side  # the line to the goal
        split = round(min(max(flips, 0.0), float(width)))
        classed += cells[:split].translate(left) + cells[split:].translate(right)
    start = _cell(field, here, width, side)
    here_m = field.distance_m(*here)
    for row in range(-2, 3):  # the boat itself may be too near: what is no nearer is open to it
        for column in range(-2, 3):
            cell = start + row * width + column
            is_no_nearer = field.distance_m(*_centre(field, cell, width, side)) >= here_m - field.cell_m
            if 0 <= cell < len(classed) and not classed[cell] and is_no_nearer:
                classed[cell] = 1
    classed[start] = classed[start] or 1
    end = _end(field, classed, here, goal, width, side)
    if end is None:
        return None
    free = bytes(classed)
    rows_ = tuple(
        tuple(base * share * (math.sqrt(2.0) if step & 1 else 1.0) for step in range(8))
        for share in (1.0, _PORT)
        for base in (_TIGHT, _BESIDE, 1.0)
    )
    grid = GridMap(free, width, width)
    try:
        path = cheapest_path(
            grid, StepCosts(array("H", [max(kind - 1, 0) for kind in free]), rows_), start, end
        )
    except NoGridPath:
        return None
    return [here, *(_centre(field, cell, width, side) for cell in path.corners[1:])]


def _classes(cell_m: float, margin_m: float, hull_m: float, offset: int) -> bytes:
    """Class by byte: 0 blocked, then tight, beside and free, port after starboard."""
    table = bytearray(256)
    for byte in range(128):
        clear_m = (LEVELS - (byte & LEVEL)) * cell_m
        if byte & (SOLID | FENCE) or clear_m < hull_m:
            continue
        table[byte] = offset + (1 if clear_m < margin_m else 2 if clear_m < 1.5 * margin_m else 3)
    return bytes(table)


def _cell(field: ClearanceField, at: Point, width: int, side: float) -> int:
    row = min(max(int((at.north_m - field.south_m) / side), 0), width - 1)
    return row * width + min(max(int((at.east_m - field.west_m) / side), 0), width - 1)


def _end(
    field: ClearanceField, classed: bytearray, here: Point, goal: Point, width: int, side: float
) -> int | None:
    """The goal's cell, or the nearest free one; on the edge of the grid for a goal beyond."""
    half_m = 0.5 * width * side
    is_inside = max(abs(goal.north_m - field.centre.north_m), abs(goal.east_m - field.centre.east_m)) < half_m
    if is_inside:
        reach = math.ceil(_AROUND_M / side)
        middle = _cell(field, goal, width, side)
        cells = [
            row * width + column
            for row in range(max(middle // width - reach, 0), min(middle // width + reach + 1, width))
            for column in range(max(middle % width - reach, 0), min(middle % width + reach + 1, width))
        ]
    else:
        last = width - 1
        cells = [*range(width), *range(last * width, width * width)]
        cells += [row * width + column for row in range(1, last) for column in (0, last)]
    best, least = None, math.inf
    for cell in cells:
        if classed[cell]:
            at = _centre(field, cell, width, side)
            away = distance_m(at, goal) + (0.0 if is_inside else 0.2 * distance_m(at, here))
            if away < least:
                best, least = cell, away
    return best


def _centre(field: ClearanceField, cell: int, width: int, side: float) -> Point:
    return Point(field.south_m + (cell // width + 0.5) * side, field.west_m + (cell % width + 0.5) * side)
