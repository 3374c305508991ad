"""How far it is home by water from every place of a route."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from companion.core.geo import Point, distance_m
from mission_tools.costs.travel import Floats
from mission_tools.maps.chart import Chart
from mission_tools.planning.exact_planner import water_of
from mission_tools.tasks.task_route import ROUNDING


def ways_home_m(
    chart: Chart, points: Sequence[Point], clearance_m: float, known_m: dict[Point, float] | None = None
) -> list[float]:
    """How far it is home from each point of a route by water; the first is home.

    The shortest way with the clearance. A home without it is left for the nearest water that has it, and from
    a point without it the way leads along the route to one that has it. known_m: of earlier points, with the
    same home; it is added to.
    """
    home, routes = points[0], water_of(chart).routes(clearance_m * (1.0 - ROUNDING))
    afloat = home if routes.is_free(home) else next(routes.exits(home), home)
    known_m = {} if known_m is None else known_m
    new = [point for point in dict.fromkeys(points) if point not in known_m]
    off_m = distance_m(home, afloat)
    known_m |= {at: off_m + m for at, m in zip(new, routes.lengths_m(afloat, new), strict=True)}
    found = [known_m[point] for point in points]
    found[0] = 0.0
    legs_m = [distance_m(a, b) for a, b in pairwise(points)]
    for n, leg_m in enumerate(legs_m):
        found[n + 1] = min(found[n + 1], found[n] + leg_m)
    for n in range(len(legs_m) - 1, -1, -1):
        found[n] = min(found[n], found[n + 1] + legs_m[n])
    return found


def home_along_m(points: Sequence[Point], ways_m: Sequence[float], at: Floats, legs: Floats) -> Floats:
    """The way home from every place: by the nearer of the leg's two ends, and 0 at home."""
    found = [ways_m[0]]
    for (north_m, east_m), leg in zip(at[1:], legs, strict=True):
        n = int(leg)
        here = Point(float(north_m), float(east_m))
        found.append(min(distance_m(here, points[i]) + ways_m[i] for i in (n, n + 1)))
    return np.array(found)
