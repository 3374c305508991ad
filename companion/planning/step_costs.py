"""What a step costs on a grid, by place and direction, and the lower bound on what lies ahead."""

import math
from array import array
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from companion.planning.cost_search import STEPS

MAX_CLASSES = 0xFFFF
MAX_RING = 1 << 20
_NEVER = 1e3
"""Cost taken for a direction that no class allows, in the greatest finite cost: only the bound uses it."""


@dataclass(frozen=True, eq=False)
class StepCosts:
    """A class for each cell, and for each class the cost of a step in the eight directions of STEPS.

    A step costs the mean of both its cells' entries. An entry is positive; infinite where a step of that
    direction is impossible, such as one against a current that cannot be stemmed.

    Raises:
        ValueError: no or too many classes, a row without eight entries, an entry that is not positive, a cell
            whose class has no row; names it.
    """

    classes: "array[int]"
    rows: tuple[tuple[float, ...], ...]

    def __post_init__(self) -> None:
        if not 0 < len(self.rows) < MAX_CLASSES:
            raise ValueError(f"step costs of {len(self.rows)} classes: expected 1 to {MAX_CLASSES - 1}")
        for number, row in enumerate(self.rows):
            if len(row) != len(STEPS) or not all(cost > 0.0 for cost in row):
                raise ValueError(f"step costs of class {number} are {row}: expected eight positive numbers")
        if self.classes.typecode != "H":
            raise ValueError(f"classes are an array of {self.classes.typecode!r}: expected 'H'")
        highest = max(self.classes, default=0)
        if highest >= len(self.rows):
            raise ValueError(f"a cell has class {highest}: there are {len(self.rows)}")

    @classmethod
    def by_weight(cls, weights: Sequence[float]) -> "StepCosts":
        """One factor on the length for each cell, the same in all directions."""
        distinct = sorted(set(weights))
        number = {weight: n for n, weight in enumerate(distinct)}
        return cls(array("H", [number[weight] for weight in weights]), tuple(map(even_costs, distinct)))

    @cached_property
    def table(self) -> "array[float]":
        """The rows one after the other."""
        return array("d", [cost for row in self.rows for cost in row])


def even_costs(weight: float) -> tuple[float, ...]:
    """A row of a class in which every direction costs the same for its length."""
    return tuple(weight * math.hypot(*step) for step in STEPS)


def bucket_width(rows: Sequence[Sequence[float]]) -> float:
    """The range of F in one stack of the open list: the least step, but more where stacks would be too
    many."""
    finite = _finite(rows)
    return max(min(finite), 2.0 * max(finite) / (MAX_RING - 4))


def ring_size(rows: Sequence[Sequence[float]]) -> int:
    """How many stacks are in use at once, as a power of two.

    A step raises F by no more than its cost and the change of H, which is at most the cost of a step.
    """
    wanted = math.ceil(2.0 * max(_finite(rows)) / bucket_width(rows)) + 4
    return max(64, 1 << (wanted - 1).bit_length())


def facets(rows: Sequence[Sequence[float]]) -> list[tuple[float, float]]:
    """The linear forms whose greatest is a lower bound on the cost of a displacement (columns, rows).

    With the least cost of each direction, c_d, one unit of cost reaches the points e_d / c_d; their convex
    hull is the unit ball of the bound, and each of its edges gives the form that is 1 on it.
    """
    most = _NEVER * max(_finite(rows))
    least = [min(most, *(row[direction] for row in rows)) for direction in range(len(STEPS))]
    hull: list[tuple[float, float]] = []
    points = sorted((x / cost, y / cost) for (x, y), cost in zip(STEPS, least, strict=True))
    for chain in (points, points[::-1]):
        begin = len(hull)
        for point in chain:
            while len(hull) >= begin + 2 and _turn(hull[-2], hull[-1], point) <= 0.0:
                hull.pop()
            hull.append(point)
        hull.pop()
    forms = []
    for (ax, ay), (bx, by) in zip(hull, [*hull[1:], hull[0]], strict=True):
        area = ax * by - ay * bx
        forms.append(((by - ay) / area, (ax - bx) / area))
    return forms


def _turn(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _finite(rows: Sequence[Sequence[float]]) -> list[float]:
    finite = [cost for row in rows for cost in row if math.isfinite(cost)]
    if not finite:
        raise ValueError("no step costs are finite")
    return finite
