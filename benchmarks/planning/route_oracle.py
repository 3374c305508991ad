"""What routes are measured with, independent of the planner: shapely's shores, clearances and free places."""

import random
from collections.abc import Sequence
from math import cos, pi, sin
from typing import TypeAlias

import shapely
from shapely.geometry import MultiPolygon, Polygon

from companion.core.geo import Point
from companion.planning.water import Shore

Shape: TypeAlias = Polygon | MultiPolygon


def shores_of(water: Shape) -> list[Shore]:
    """The rings of shapely polygons, x east."""
    rings = [
        ring
        for part in shapely.get_parts(water)
        for ring in (part.exterior, *part.interiors)
        if part.area > 0
    ]
    return [Shore([Point(y, x) for x, y in ring.coords[:-1]]) for ring in rings]


def clearance_m(water: Shape, points: Sequence[Point]) -> float:
    """Distance of a route from the shore; 0 where it leaves the water."""
    line = shapely.LineString([(point.east_m, point.north_m) for point in points])
    return float(water.boundary.distance(line)) if water.covers(line) else 0.0


def star(rng: random.Random, x: float, y: float, radius: float, corners: int, jag: float) -> Polygon:
    """A polygon round a point, jagged by this share of its radius."""
    spread = [radius * (1.0 - jag * rng.random()) for _ in range(corners)]
    turn = rng.random()
    return shapely.Polygon(
        [
            (x + r * cos(2 * pi * (n + turn) / corners), y + r * sin(2 * pi * (n + turn) / corners))
            for n, r in enumerate(spread)
        ]
    )


def free_points(rng: random.Random, water: Shape, clearance_m: float, count: int) -> list[Point]:
    """Random points that have the clearance; fewer where there is hardly any free water."""
    free = water.buffer(-1.02 * clearance_m - 1e-3)  # the chords of its arcs cut a hundredth off
    found: list[Point] = []
    if free.is_empty:
        return found
    west, south, east, north = free.bounds
    for _ in range(200 * count):
        x, y = rng.uniform(west, east), rng.uniform(south, north)
        if free.contains(shapely.Point(x, y)):
            found.append(Point(y, x))
            if len(found) == count:
                break
    return found
