"""Fewer corners for a map of much detail: Douglas and Peucker's method (1973) on pieces of each ring."""

from collections.abc import Iterable, Sequence

from companion.core.geo import Point
from companion.planning.segments import point_distance2
from mission_tools.shore.chart_file import Shape

_PIECE = 256  # corners: bounds the time, which is quadratic in the worst case
_FIRST_M = 0.05


def thinned(
    shapes: Sequence[Shape], most_corners: int, most_error_m: float
) -> tuple[tuple[Shape, ...], float]:
    """The shapes with at most so many corners, and how far a corner left out may be from the lines kept.

    The first and last corner of each ring stay. There may be more corners if the error would be too large.
    """
    shapes, error_m, step_m = tuple(shapes), 0.0, _FIRST_M
    while _count(shapes) > most_corners and error_m + step_m <= most_error_m:
        shapes = tuple(
            Shape(
                shape.kind,
                shape.name,
                tuple(tuple(_thin(ring, step_m) for ring in rings) for rings in shape.polygons),
                tuple(_thin(line, step_m) for line in shape.lines),
            )
            for shape in shapes
        )
        error_m += step_m
        step_m *= 2.0
    return shapes, error_m


def _count(shapes: Iterable[Shape]) -> int:
    return sum(
        sum(len(ring) for rings in shape.polygons for ring in rings) + sum(map(len, shape.lines))
        for shape in shapes
    )


def _thin(corners: Sequence[Point], error_m: float) -> tuple[Point, ...]:
    if len(corners) < 3:
        return tuple(corners)
    kept = [corners[0]]
    for first in range(0, len(corners) - 1, _PIECE):
        kept += _piece(corners[first : first + _PIECE + 1], error_m)
    return tuple(kept)


def _piece(corners: Sequence[Point], error_m: float) -> list[Point]:
    """The corners kept after the first."""
    kept = {len(corners) - 1}
    open_pieces = [(0, len(corners) - 1)]
    while open_pieces:
        first, last = open_pieces.pop()
        leg = *corners[first], *corners[last]
        worst_m2, worst = max(
            ((point_distance2(*corners[n], *leg), n) for n in range(first + 1, last)), default=(0.0, 0)
        )
        if worst_m2 > error_m * error_m:
            kept.add(worst)
            open_pieces += [(first, worst), (worst, last)]
    return [corners[n] for n in sorted(kept)]
