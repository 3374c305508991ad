"""Fewer and better placed corners for a path, by cost."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from companion.core.geo import Point, distance_m
from mission_tools.costs.legs import leg_costs, route_cost, route_costs
from mission_tools.costs.travel import Floats, Travel
from mission_tools.maps.chart import Chart
from mission_tools.planning.exact_planner import water_of

LEG_SHARE = 0.001
"""Of the whole cost: what a corner more has to save, so that a curve is not cut into dozens of legs."""
TIMED_LEG_SHARE = 0.0003
"""The same where currents change: their routes bend more, and a dozen corners would cost 1 % (seeds 1000-1011
of `python -m benchmarks.planning.tide`: 0.1 % less time with a leg more)."""
_MOST_POINTS = 120
"""Of a path that legs are laid along: dynamic programming tries every pair. Half of it where legs are timed,
which takes four times as long."""
_TRIED_DEPARTURES = 100
_AS_GOOD = 0.002  # of the time until arrival
_PASSES = 6
_ROUND = ((0, 0), *((up, right) for up in (-1, 0, 1) for right in (-1, 0, 1) if up or right))


class Polish:
    """Fewer and better placed corners for a path, by cost."""

    def __init__(self, chart: Chart, clearance_m: float, travel: Travel, cell_m: float) -> None:
        self._routes = water_of(chart).routes(clearance_m)
        self._travel, self._cell_m = travel, cell_m

    def is_clear(self, start: Point, end: Point) -> bool:
        """Whether a leg may be sailed."""
        return self._routes.is_clear(start, end)

    def is_sailable(self, path: Sequence[Point]) -> bool:
        """Whether every leg may be sailed: the lattice knows no clearance that a feature asks for itself."""
        return all(self.is_clear(a, b) for a, b in pairwise(path))

    def cost(self, points: Sequence[Point], depart_s: float = 0.0) -> float:
        """Of a whole path."""
        return route_cost(self._travel, points, self._cell_m, depart_s)

    def leave_s(self, path: Sequence[Point], begin_s: float, end_s: float) -> float:
        """begin_s, if the path can be sailed then, else the departure that arrives first, up to end_s.

        Of departures that arrive almost at the same time it is the last: a boat that leaves as soon as the
        current lets it creeps against it.
        """
        if end_s <= begin_s or math.isfinite(self.cost(path, begin_s)):
            return begin_s
        first_s, last_s = begin_s, end_s
        for _ in range(2):
            tried_s = np.linspace(first_s, last_s, _TRIED_DEPARTURES)
            cost, passed_s = route_costs(self._travel, path, self._cell_m, tried_s)
            arrive_s = np.where(np.isfinite(cost), passed_s[-1], np.inf)
            latest_s = arrive_s.min() + _AS_GOOD * (arrive_s.min() - begin_s)
            best = int(np.flatnonzero(arrive_s <= latest_s)[-1])
            first_s, last_s = float(tried_s[max(best - 1, 0)]), float(tried_s[min(best + 1, len(cost) - 1)])
        return float(tried_s[best])

    def improved(self, path: tuple[Point, ...], depart_s: float = 0.0) -> tuple[Point, ...]:
        """The same way with straight legs and better corners."""
        most = _MOST_POINTS // 2 if self._travel.varies else _MOST_POINTS
        while not self.is_sailable(_thinned(path, most)) and most < len(path):
            most *= 2
        best = self._laid(_thinned(path, most), depart_s)
        for halving in range(_PASSES):
            best = self._laid(self._moved(best, 2.0 * self._cell_m * 0.5**halving, depart_s), depart_s)
        return best

    def _legs(
        self, starts: Sequence[Point], ends: Sequence[Point], depart_s: Floats | float
    ) -> tuple[Floats, Floats]:
        return leg_costs(self._travel, starts, ends, self._cell_m, depart_s)

    def _are_clear(self, start: Point, ends: Sequence[Point]) -> NDArray[np.bool_]:
        return np.array([self.is_clear(start, end) for end in ends], dtype=np.bool_)

    def _laid(self, path: Sequence[Point], depart_s: float) -> tuple[Point, ...]:
        """The cheapest chain of clear legs through some of the path's points; each leg more has to pay."""
        number = len(path)
        corner = (TIMED_LEG_SHARE if self._travel.varies else LEG_SHARE) * self.cost(path, depart_s)
        cheapest = np.full(number, np.inf)
        before = np.zeros(number, dtype=np.intp)
        cheapest[0] = 0.0
        at_s = np.full(number, depart_s)
        for here in range(number - 1):
            if not math.isfinite(cheapest[here]):
                continue
            ends = path[here + 1 :]
            legs, seconds = self._legs([path[here]], ends, at_s[here])
            cost = cheapest[here] + legs + corner
            cheaper = np.flatnonzero(cost < cheapest[here + 1 :])
            cheaper = cheaper[self._are_clear(path[here], [ends[int(index)] for index in cheaper])]
            cheapest[here + 1 + cheaper] = cost[cheaper]
            at_s[here + 1 + cheaper] = at_s[here] + seconds[cheaper]
            before[here + 1 + cheaper] = here
        if not math.isfinite(cheapest[-1]):
            return tuple(path)
        chain = [number - 1]
        while chain[-1]:
            chain.append(int(before[chain[-1]]))
        return tuple(path[index] for index in reversed(chain))

    def _moved(self, points: tuple[Point, ...], by_m: float, depart_s: float) -> tuple[Point, ...]:
        """Every corner, and the middle of every leg, moved to the cheapest of nine places by_m apart."""
        path = list(_with_middles(points, 4.0 * self._cell_m))
        now_s = depart_s
        for index in range(1, len(path) - 1):
            a, here, b = path[index - 1 : index + 2]
            tried = [Point(here.north_m + up * by_m, here.east_m + right * by_m) for up, right in _ROUND]
            to_it, seconds = self._legs([a], tried, now_s)
            costs = to_it + self._legs(tried, [b], now_s + seconds)[0]
            clear = self._are_clear(a, tried) & self._are_clear(b, tried)
            clear[0] = True  # as it is
            chosen = int(np.argmin(np.where(clear, costs, np.inf)))
            path[index], now_s = tried[chosen], now_s + float(seconds[chosen])
        return tuple(path)


def _thinned(path: tuple[Point, ...], most: int) -> tuple[Point, ...]:
    """At most so many points of a path, evenly; first and last stay."""
    if len(path) <= most:
        return path
    return tuple(path[round(index)] for index in np.linspace(0, len(path) - 1, most))


def _with_middles(points: tuple[Point, ...], least_m: float) -> tuple[Point, ...]:
    """The path with the middle of every leg longer than this."""
    path = [points[0]]
    for a, b in pairwise(points):
        if distance_m(a, b) > least_m:
            path.append(a.towards(b, 0.5))
        path.append(b)
    return tuple(path)
