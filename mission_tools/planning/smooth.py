"""String pulling: a grid path drawn taut between the true shores, then into few, long legs.

Every shortcut is checked against the polygons themselves, never against the grid.
"""

import math
from collections.abc import Callable, Sequence
from itertools import pairwise

from companion.core.geo import Point, bearing_rad, distance_m, path_length_m
from companion.core.units import wrap_pi

IsClear = Callable[[Point, Point], bool]
"""Whether the straight leg between two points may be sailed."""

MIN_LEG_CLEARANCES = 3.0  # shorter legs are merged where there is room
MAX_ROUNDS = 12
CUT_HALVINGS = 8
MIN_GAIN = 2e-4  # share of the length that another round must win to be worth its time


def pull_taut(path: Sequence[Point], is_clear: IsClear, spacing_m: float) -> tuple[Point, ...]:
    """Shorten a path without moving its ends, until it hardly gets any shorter.

    Each round sets points along the path, `spacing_m` apart, and from each kept point skips to the farthest
    that is clear ahead, forth and then back, because where a skip ends depends on where the last one began.
    Then each bend that is left is cut as deep as is clear: a skip alone sticks where two legs that graze two
    headlands meet too far out. The legs of `path` are taken to be clear; those of the result are, and it is
    never longer.
    """
    taut = _skip_ahead(tuple(path), is_clear)
    length_m = path_length_m(taut)
    for _ in range(MAX_ROUNDS):
        taut = _skip_ahead(_with_points_between(taut, spacing_m)[::-1], is_clear)
        taut = _skip_ahead(_with_points_between(taut[::-1], spacing_m), is_clear)
        taut = _skip_ahead(_cut_bends(taut, is_clear), is_clear)
        shorter_m = path_length_m(taut)
        if shorter_m > length_m * (1.0 - MIN_GAIN):
            break
        length_m = shorter_m
    return taut


def merge_short_legs(
    path: Sequence[Point], is_clear: IsClear, min_leg_m: float, max_length_m: float
) -> tuple[Point, ...]:
    """Replace short legs, shortest first, by the corner that their neighbours meet in when drawn out.

    A string round a headland has many small bends; the boat steers better by one corner a little farther out.
    A merge must be clear and must not make the path longer than `max_length_m`. The ends stay.
    """
    points = list(path)
    kept: set[tuple[Point, Point]] = set()
    while True:
        legs = [
            (distance_m(points[i], points[i + 1]), i)
            for i in range(1, len(points) - 2)
            if (points[i], points[i + 1]) not in kept
        ]
        shortest_m, i = min(legs, default=(min_leg_m, 0))
        if shortest_m >= min_leg_m:
            return tuple(points)
        before, a, b, after = points[i - 1 : i + 3]
        corner = _meeting_point(before, a, after, b)
        merged = [*points[:i], corner, *points[i + 2 :]] if corner is not None else points
        if (
            corner is not None
            and is_clear(before, corner)
            and is_clear(corner, after)
            and path_length_m(merged) <= max_length_m
        ):
            points = merged
        else:
            kept.add((a, b))


def _skip_ahead(path: tuple[Point, ...], is_clear: IsClear) -> tuple[Point, ...]:
    """From each kept point to the farthest found clear, by doubling and then halving the stride."""
    kept = [path[0]]
    at, last = 0, len(path) - 1
    while at < last:
        reach, stride = at + 1, 1
        while reach + stride <= last and is_clear(path[at], path[reach + stride]):
            reach += stride
            stride *= 2
        while stride >= 1:
            if reach + stride <= last and is_clear(path[at], path[reach + stride]):
                reach += stride
            stride //= 2
        kept.append(path[reach])
        at = reach
    return tuple(kept)


def _cut_bends(path: tuple[Point, ...], is_clear: IsClear) -> tuple[Point, ...]:
    """Replace each bend by a chord between its legs, the longest of a halving series that is clear."""
    points = [path[0]]
    for here, after in pairwise(path[1:]):
        before, share = points[-1], 1.0
        for _ in range(CUT_HALVINGS):
            first, last = here.towards(before, share), here.towards(after, share)
            if is_clear(first, last):
                points += [first, last]
                break
            share *= 0.5
        else:
            points.append(here)
    return (*points, path[-1])


def _with_points_between(path: Sequence[Point], spacing_m: float) -> tuple[Point, ...]:
    dense = [path[0]]
    for a, b in pairwise(path):
        count = max(1, round(distance_m(a, b) / spacing_m))
        dense += [*(a.towards(b, k / count) for k in range(1, count)), b]
    return tuple(dense)


def _meeting_point(p0: Point, p1: Point, q0: Point, q1: Point) -> Point | None:
    """Where p0 → p1 and q0 → q1 meet when both are drawn out beyond p1 and q1; None if they do not."""
    pn, pe = p1.north_m - p0.north_m, p1.east_m - p0.east_m
    qn, qe = q1.north_m - q0.north_m, q1.east_m - q0.east_m
    cross = pn * qe - pe * qn
    if abs(cross) < 1e-12:
        return None
    dn, de = q0.north_m - p0.north_m, q0.east_m - p0.east_m
    t = (dn * qe - de * qn) / cross
    s = (dn * pe - de * pn) / cross
    return Point(p0.north_m + t * pn, p0.east_m + t * pe) if t >= 1.0 and s >= 1.0 else None


CORNER_CLEARANCES = 0.5
"""Assumed start of a turn before a waypoint: with 4 m of clearance, 2 m."""
_SHARES = (1.0, 0.5, 0.25)  # of the way outwards, tried in turn where there is little room


def corner_cut_m(turn_rad: float, radius_m: float) -> float:
    """How far inside a corner the arc passes that leaves one leg, and joins the next, radius_m from it.

    The arc has the radius r = radius_m / tan(|turn|/2) and passes the corner at r (1/cos(|turn|/2) − 1),
    which is radius_m · tan(|turn|/4).
    """
    return radius_m * math.tan(0.25 * min(abs(turn_rad), math.pi))


def widen_corners(
    path: Sequence[Point], is_clear: IsClear, radius_m: float, max_length_m: float
) -> tuple[Point, ...]:
    """Move each corner outwards by what a turn of this radius cuts off, as far as there is room.

    radius_m: how near to a waypoint the vehicle begins its turn. Both legs of a moved corner are clear, the
    ends stay, and the path never becomes longer than max_length_m.
    """
    points = list(path)
    for i in range(1, len(points) - 1):
        before, here, after = points[i - 1 : i + 2]
        turn_rad = wrap_pi(bearing_rad(here, after) - bearing_rad(before, here))
        # Outwards is away from the side that the path turns to, square to the corner's middle direction.
        side = -math.copysign(0.5 * math.pi, turn_rad)
        outwards_rad = bearing_rad(before, here) + 0.5 * turn_rad + side
        for share in _SHARES:
            cut_m = share * corner_cut_m(turn_rad, radius_m)
            moved = here.moved(outwards_rad, cut_m)
            wider = [*points[:i], moved, *points[i + 1 :]]
            if is_clear(before, moved) and is_clear(moved, after) and path_length_m(wider) <= max_length_m:
                points = wider
                break
    return tuple(points)
