"""What straight legs cost at the times when they are sailed.

A boat's place on a leg follows ds/dt = v(s, t), so two boats on one leg never change their order (solutions
of a differential equation do not cross): who leaves earlier does not arrive later, which is the condition
under which a search for the earliest arrival may keep one label a place (FIFO networks: Orda and Rom,
Shortest-path and minimum-delay algorithms in networks with time-dependent edge-length, J. ACM 37, 1990).
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from companion.core.geo import Point
from mission_tools.costs.travel import SLOWEST_M_S, Floats, Travel

_LEAST_SAMPLES, _MOST_SAMPLES = 16, 400
"""Along a leg; in between one a cell."""
_SETTLED_S = 0.05
_MOST_ITERATIONS = 20
"""Of Picard's iteration, whose n-th error shrinks as (K T)^n / n! with the current's rate of change K."""


def leg_costs(
    travel: Travel,
    starts: Sequence[Point],
    ends: Sequence[Point],
    spacing_m: float,
    depart_s: Floats | float = 0.0,
) -> tuple[Floats, Floats]:
    """Cost of straight legs by the midpoint rule, and their seconds where the travel changes with time (else
    0, as nothing depends on them); a single start, end or departure belongs to every leg.
    """
    begin, to = np.asarray(starts, dtype=np.float64), np.asarray(ends, dtype=np.float64)
    north, east = (to - begin).T
    length = np.hypot(north, east)
    number = int(np.clip(length.max() / spacing_m, _LEAST_SAMPLES, _MOST_SAMPLES))
    share = (np.arange(number, dtype=np.float64)[:, np.newaxis] + 0.5) / number
    course = np.broadcast_to(np.arctan2(east, north), (number, len(length)))
    at = begin[:, 0] + share * north, begin[:, 1] + share * east, course
    if not travel.varies:
        per_m = travel.per_m(*at, np.zeros_like(course))
        return np.where(length > 0.0, per_m.mean(axis=0) * length, 0.0), np.zeros_like(length)
    pace, begin_s = travel.pace, np.asarray(depart_s, dtype=np.float64)
    time_s = np.broadcast_to(begin_s, np.broadcast_shapes(course.shape, begin_s.shape))
    for _ in range(_MOST_ITERATIONS):
        before_s = time_s
        per_m = pace.per_m(*at, time_s)
        step_s = np.where(np.isfinite(per_m), per_m, 1.0 / SLOWEST_M_S) * (length / number)
        time_s = begin_s + np.cumsum(step_s, axis=0) - 0.5 * step_s
        if np.abs(time_s - before_s).max() < _SETTLED_S:
            break
    cost = np.where(length > 0.0, travel.per_m(*at, time_s).mean(axis=0) * length, 0.0)
    return cost, step_s.sum(axis=0)


def route_costs(
    travel: Travel,
    points: Sequence[Point],
    spacing_m: float,
    depart_s: Floats,
    holds_s: Sequence[float] = (),
) -> tuple[Floats, Floats]:
    """Cost of a route for each departure, and when it passes its points (a row a point; in a travel that does
    not change with time only if its cost is seconds). holds_s: at each point, after arrival.
    """
    cost, now_s = np.zeros_like(depart_s), depart_s
    passed_s = [now_s]
    for number, (a, b) in enumerate(pairwise(points)):
        now_s = now_s + (holds_s[number] if holds_s else 0.0)
        leg, seconds = leg_costs(travel, [a], [b], spacing_m, now_s)
        cost = cost + leg
        now_s = now_s + (seconds if travel.varies else leg)
        passed_s.append(now_s)
    return cost, np.stack(passed_s)


def route_cost(
    travel: Travel, points: Sequence[Point], spacing_m: float = 1.0, depart_s: float = 0.0
) -> float:
    """Cost of all legs, with samples about spacing_m apart."""
    return float(route_costs(travel, points, spacing_m, np.array([depart_s]))[0][0])
