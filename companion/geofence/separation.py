"""Whether shores part two places of one clearance, without a search for a way.

What a clearance bars is the union of capsules: all that is nearer than it to one side of a shore. Two places
that are free of it are parted where a closed curve within the union passes odd times between them, across the
straight line from one to the other (Jordan). Capsules are convex, so the closed curves are those through the
pairs that overlap, and an odd one is found by union-find with parities.
"""

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import NamedTuple

from companion.core.geo import Point


class _Overlap(NamedTuple):
    """Two capsules, and a place in both."""

    one: int
    other: int
    place: Point


class Separation:
    """Of rings and a clearance. Two places are asked for; both have the clearance."""

    def __init__(self, rings: Iterable[Sequence[Point]], clearance_m: float) -> None:
        self._sides = [side for ring in rings for side in pairwise((*ring, ring[0]))]
        self._overlaps = _overlaps(self._sides, 2.0 * clearance_m)

    def parts(self, one: Point, other: Point) -> bool:
        """Whether no way with the clearance joins two places."""
        bases = [start for start, _ in self._sides]
        above = list(range(len(bases)))
        parity = [False] * len(bases)  # of the crossings on the way to `above`
        for overlap in self._overlaps:
            first, second = overlap.one, overlap.other
            is_odd = _crosses(bases[first], overlap.place, one, other) != _crosses(
                overlap.place, bases[second], one, other
            )
            while above[first] != first:
                is_odd ^= parity[first]
                first = above[first]
            while above[second] != second:
                is_odd ^= parity[second]
                second = above[second]
            if first != second:
                above[first], parity[first] = second, is_odd
            elif is_odd:
                return True
        return False


def _overlaps(sides: Sequence[tuple[Point, Point]], reach_m: float) -> list[_Overlap]:
    """The pairs of sides within reach, by a sweep from west to east."""
    order = sorted(range(len(sides)), key=lambda number: min(end.east_m for end in sides[number]))
    found: list[_Overlap] = []
    active: list[int] = []
    for number in order:
        a, b = sides[number]
        west_m = min(a.east_m, b.east_m) - reach_m
        south_m, north_m = min(a.north_m, b.north_m) - reach_m, max(a.north_m, b.north_m) + reach_m
        active = [one for one in active if max(end.east_m for end in sides[one]) >= west_m]
        for one in active:
            c, d = sides[one]
            if min(c.north_m, d.north_m) > north_m or max(c.north_m, d.north_m) < south_m:
                continue
            away_m, place = _nearest(a, b, c, d)
            if away_m <= reach_m:
                found.append(_Overlap(number, one, place))
        active.append(number)
    return found


def _nearest(a: Point, b: Point, c: Point, d: Point) -> tuple[float, Point]:
    """Distance of two sides, and the place halfway between their nearest points."""
    if a in (c, d):
        return 0.0, a
    if b in (c, d):
        return 0.0, b
    if _crosses(a, b, c, d):
        turn = _turn(a, b, d) - _turn(a, b, c)
        share = -_turn(a, b, c) / turn if turn else 0.0
        return 0.0, c.towards(d, share)
    pairs = [(a, _foot(a, c, d)), (b, _foot(b, c, d)), (c, _foot(c, a, b)), (d, _foot(d, a, b))]
    away_m, end, foot = min((math.dist(end, foot), end, foot) for end, foot in pairs)
    return away_m, end.towards(foot, 0.5)


def _crosses(a: Point, b: Point, c: Point, d: Point) -> bool:
    """Whether segments cross; a point on the other's line counts to one side of it."""
    return (_turn(a, b, c) > 0.0) != (_turn(a, b, d) > 0.0) and (_turn(c, d, a) > 0.0) != (
        _turn(c, d, b) > 0.0
    )


def _turn(a: Point, b: Point, c: Point) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _foot(at: Point, a: Point, b: Point) -> Point:
    """The nearest point of a side."""
    north, east = b[0] - a[0], b[1] - a[1]
    squared = north * north + east * east
    share = ((at[0] - a[0]) * north + (at[1] - a[1]) * east) / squared if squared else 0.0
    return a.towards(b, min(max(share, 0.0), 1.0))
