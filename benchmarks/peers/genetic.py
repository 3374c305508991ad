"""A genetic algorithm over waypoints, one of the three planners compared in the paper's reference [7].

A path is a list of waypoints between start and goal; its cost is its length, and for each leg that does not
keep the clearance a penalty that grows with that leg. Selection by tournament, crossover at one point of
each parent, and mutations that move, insert, delete and swap out waypoints; the best of a generation live
on.
"""

import math
import random
from collections.abc import Sequence
from itertools import pairwise

from benchmarks.peers.interface import Deadline, NoPath, Path, Sea
from companion.core.geo import Point, distance_m

POPULATION = 60
GENERATIONS = 200
ELITE = 4
MOST_WAYPOINTS = 12
_FIRST_WAYPOINTS = 5
_BLOCKED = 4.0  # cost of a leg that is not clear, in its length, and once the straight line on top


class _Breeder:
    """Cost, crossover and mutation for one pair of ends."""

    def __init__(self, sea: Sea, start: Point, goal: Point, draw: random.Random) -> None:
        self._sea, self._start, self._goal, self._draw = sea, start, goal, draw
        self._straight_m = distance_m(start, goal)
        self._legs: dict[tuple[Point, Point], float] = {}

    def cost(self, waypoints: Sequence[Point]) -> float:
        return sum(self._leg_cost(a, b) for a, b in pairwise((self._start, *waypoints, self._goal)))

    def first(self) -> list[Point]:
        return [self._anywhere() for _ in range(self._draw.randint(0, _FIRST_WAYPOINTS))]

    def child(self, mother: Sequence[Point], father: Sequence[Point]) -> list[Point]:
        cut = self._draw.randint(0, len(mother)), self._draw.randint(0, len(father))
        return self._mutated([*mother[: cut[0]], *father[cut[1] :]][:MOST_WAYPOINTS])

    def _mutated(self, waypoints: list[Point]) -> list[Point]:
        draw = self._draw
        if waypoints and draw.random() < 0.6:
            at = draw.randrange(len(waypoints))
            reach_m = self._straight_m * 10.0 ** draw.uniform(-3.0, -0.5)
            waypoints[at] = Point(
                waypoints[at].north_m + draw.gauss(0.0, reach_m),
                waypoints[at].east_m + draw.gauss(0.0, reach_m),
            )
        if waypoints and draw.random() < 0.15:
            del waypoints[draw.randrange(len(waypoints))]
        if len(waypoints) < MOST_WAYPOINTS and draw.random() < 0.15:
            at = draw.randint(0, len(waypoints))
            a, b = (self._start, *waypoints)[at], (*waypoints, self._goal)[at]
            between = Point(0.5 * (a.north_m + b.north_m), 0.5 * (a.east_m + b.east_m))
            reach_m = 0.5 * distance_m(a, b)
            waypoints.insert(
                at,
                Point(between.north_m + draw.gauss(0.0, reach_m), between.east_m + draw.gauss(0.0, reach_m)),
            )
        if waypoints and draw.random() < 0.05:
            waypoints[draw.randrange(len(waypoints))] = self._anywhere()
        return waypoints

    def _anywhere(self) -> Point:
        west, south, east, north = self._sea.bounds
        return Point(self._draw.uniform(south, north), self._draw.uniform(west, east))

    def _leg_cost(self, a: Point, b: Point) -> float:
        cost = self._legs.get((a, b))
        if cost is None:
            cost = distance_m(a, b)
            if not self._sea.is_clear(a, b):
                cost = (1.0 + _BLOCKED) * cost + self._straight_m
            self._legs[a, b] = cost
        return cost


def genetic(sea: Sea, start: Point, goal: Point, seed: int, deadline: Deadline) -> Path:
    """The best path of the last generation."""
    draw = random.Random(seed)
    breeder = _Breeder(sea, start, goal, draw)
    population = sorted((breeder.first() for _ in range(POPULATION)), key=breeder.cost)
    for _ in range(GENERATIONS):
        deadline.check()

        def parent(ranked: list[list[Point]] = population) -> list[Point]:
            return ranked[min(draw.randrange(POPULATION) for _ in range(3))]

        children = [breeder.child(parent(), parent()) for _ in range(POPULATION - ELITE)]
        population = sorted([*population[:ELITE], *children], key=breeder.cost)
    best = (start, *population[0], goal)
    if not all(sea.is_clear(a, b) for a, b in pairwise(best)):
        raise NoPath(f"no clear path after {GENERATIONS} generations")
    if not math.isfinite(breeder.cost(population[0])):
        raise NoPath("no path of finite length")
    return best
