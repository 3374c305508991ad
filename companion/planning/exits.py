"""Where free water begins round a point that has not the clearance.

The nearest point of free water lies on the outline of what is too near to a shore: at the foot of the
perpendicular on the offset of one shore segment or corner, or where the offsets of two meet.
"""

import math
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, NamedTuple

from companion.core.geo import Point, distance_m

if TYPE_CHECKING:
    from companion.planning.segments import Segments

MAX_PAIRED = 150  # offsets whose meeting points are tried, the nearest ones


class _Line(NamedTuple):
    """The offset of a segment on one side: from `a` along the unit vector (dx, dy)."""

    ax: float
    ay: float
    dx: float
    dy: float
    length: float


class _Circle(NamedTuple):
    x: float
    y: float
    radius: float


def exits(
    segments: "Segments", radii_m: list[float], at: Point, is_free: Callable[[Point], bool]
) -> Iterator[Point]:
    """Points of free water, the nearest first."""
    x, y = at.east_m, at.north_m
    nearest_m = math.sqrt(segments.distance2(x, y, x, y))
    widest_m = max(radii_m)
    reach_m = nearest_m + 2.0 * widest_m
    largest_m = 4.0 * (segments.extent + nearest_m + widest_m)
    passed_m = 0.0  # nearer points were yielded
    while True:
        near = segments.near(x, y, reach_m + widest_m)
        offsets = _offsets(segments, radii_m, near)
        found = [foot for offset in offsets for foot in _feet(offset, x, y)]
        free_m = min(
            (distance_m(at, foot) for foot in found if distance_m(at, foot) <= reach_m and is_free(foot)),
            default=reach_m,
        )
        # A nearer meeting point can only be one of offsets that pass nearer than the nearest free foot.
        close = sorted((_distance(offset, x, y), n) for n, offset in enumerate(offsets))
        paired = [offsets[n] for away_m, n in close[:MAX_PAIRED] if away_m <= free_m]
        for n, one in enumerate(paired):
            for other in paired[:n]:
                found += _meetings(one, other)
        order = sorted((distance_m(at, place), place) for place in found)
        for away_m, place in order:
            if passed_m < away_m <= reach_m and is_free(place):
                passed_m = away_m
                yield place
        passed_m = max(passed_m, reach_m)
        if reach_m > largest_m:
            return
        reach_m *= 2.0


def _offsets(segments: "Segments", radii_m: list[float], near: list[int]) -> list[_Line | _Circle]:
    offsets: list[_Line | _Circle] = []
    for k in near:
        ax, ay = segments.ax[k], segments.ay[k]
        dx, dy = segments.bx[k] - ax, segments.by[k] - ay
        length = math.sqrt(dx * dx + dy * dy)
        dx, dy, r = dx / length, dy / length, radii_m[k]
        offsets += [
            _Circle(ax, ay, r),
            _Circle(segments.bx[k], segments.by[k], r),
            _Line(ax - r * dy, ay + r * dx, dx, dy, length),
            _Line(ax + r * dy, ay - r * dx, dx, dy, length),
        ]
    return offsets


def _feet(offset: _Line | _Circle, x: float, y: float) -> list[Point]:
    if isinstance(offset, _Circle):
        dx, dy = x - offset.x, y - offset.y
        away = math.sqrt(dx * dx + dy * dy)
        if away == 0.0:
            return [
                Point(offset.y + offset.radius * n, offset.x + offset.radius * e) for n, e in ((0, 1), (1, 0))
            ]
        scale = offset.radius / away
        return [Point(offset.y + scale * dy, offset.x + scale * dx)]
    along = (x - offset.ax) * offset.dx + (y - offset.ay) * offset.dy
    if not 0.0 <= along <= offset.length:
        return []
    return [Point(offset.ay + along * offset.dy, offset.ax + along * offset.dx)]


def _distance(offset: _Line | _Circle, x: float, y: float) -> float:
    if isinstance(offset, _Circle):
        return abs(math.hypot(x - offset.x, y - offset.y) - offset.radius)
    along = (x - offset.ax) * offset.dx + (y - offset.ay) * offset.dy
    along = min(max(along, 0.0), offset.length)
    return math.hypot(x - offset.ax - along * offset.dx, y - offset.ay - along * offset.dy)


def _meetings(one: _Line | _Circle, other: _Line | _Circle) -> list[Point]:
    if isinstance(one, _Line):
        if isinstance(other, _Line):
            return _lines_meet(one, other)
        return _line_meets_circle(one, other)
    if isinstance(other, _Line):
        return _line_meets_circle(other, one)
    return _circles_meet(one, other)


def _lines_meet(one: _Line, other: _Line) -> list[Point]:
    cross = one.dx * other.dy - one.dy * other.dx
    if abs(cross) < 1e-12:
        return []
    ex, ey = other.ax - one.ax, other.ay - one.ay
    along = (ex * other.dy - ey * other.dx) / cross
    along_other = (ex * one.dy - ey * one.dx) / cross
    if not (0.0 <= along <= one.length and 0.0 <= along_other <= other.length):
        return []
    return [Point(one.ay + along * one.dy, one.ax + along * one.dx)]


def _line_meets_circle(line: _Line, circle: _Circle) -> list[Point]:
    ex, ey = circle.x - line.ax, circle.y - line.ay
    middle = ex * line.dx + ey * line.dy
    aside = ex * line.dy - ey * line.dx
    half2 = circle.radius * circle.radius - aside * aside
    if half2 < 0.0:
        return []
    half = math.sqrt(half2)
    return [
        Point(line.ay + along * line.dy, line.ax + along * line.dx)
        for along in (middle - half, middle + half)
        if 0.0 <= along <= line.length
    ]


def _circles_meet(one: _Circle, other: _Circle) -> list[Point]:
    dx, dy = other.x - one.x, other.y - one.y
    d2 = dx * dx + dy * dy
    if d2 == 0.0:
        return []
    share = 0.5 * (d2 + one.radius * one.radius - other.radius * other.radius) / d2
    half2 = one.radius * one.radius / d2 - share * share
    if half2 < 0.0:
        return []
    half = math.sqrt(half2)
    return [
        Point(one.y + share * dy + side * half * dx, one.x + share * dx - side * half * dy)
        for side in (1.0, -1.0)
    ]
