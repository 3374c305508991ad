"""An oracle of its own for voyages in currents that change: a search over a grid of places and times.

It shares no code with the planner. In every layer of time a boat may leave each place that it has reached,
on any of some 180 courses, or stay there if it stems the current; nothing is assumed of arrivals in order.
The speed is the wind triangle's: over ground as asked, as far as the top speed through the water allows.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flow = Callable[[Array, Array, Array], tuple[Array, Array]]
"""North and east velocity of the water at north, east and time."""
PARTS = 4  # of a step, each timed by itself
LEAST_M_S = 0.1  # over ground, or the leg counts as one that cannot be stemmed


@dataclass(frozen=True)
class Sailor:
    """What the boat can do, m/s."""

    asked: float
    top: float
    steerage: float = 0.3

    def over_ground(self, north: Array, east: Array, course: Array) -> Array:
        """Speed on a course in a current; 0 where it is too strong."""
        helping = north * np.cos(course) + east * np.sin(course)
        pushing = north * np.sin(course) - east * np.cos(course)
        left = np.sqrt(np.clip(self.top**2 - pushing**2, 0.0, None))
        fastest = np.where(np.abs(pushing) < self.top, helping + left, 0.0)
        speed = np.minimum(np.maximum(self.asked, helping + self.steerage), fastest)
        return np.where(speed < LEAST_M_S, 0.0, speed)


def earliest(
    land: shapely.Geometry,
    bounds: tuple[float, float, float, float],
    start: tuple[float, float],
    goal: tuple[float, float],
    sailor: Sailor,
    flow: Flow,
    *,
    cell: float,
    layer_s: float,
    depart_s: float = 0.0,
    layers: int = 5000,
    reach: int = 8,
) -> float:
    """The earliest arrival; places are (north, east), bounds south, west, north, east. land: what no step may
    touch. Infinite: not within so many layers.
    """
    axes = [_axis(start[n], goal[n], bounds[n], bounds[n + 2], cell) for n in (0, 1)]
    norths, easts = (axis for axis, _, _ in axes)
    rows, columns = len(norths), len(easts)
    steps = [
        (r, c) for r in range(-reach, reach + 1) for c in range(-reach, reach + 1) if math.gcd(r, c) == 1
    ]
    up, right = np.array(steps).T
    row, column = (grid.ravel() for grid in np.indices((rows, columns)))
    to_row, to_column = row[:, None] + up, column[:, None] + right
    can = (to_row >= 0) & (to_row < rows) & (to_column >= 0) & (to_column < columns)
    heads = np.where(can, to_row * columns + to_column, 0)
    n0, e0 = norths[row], easts[column]
    dn, de = up * (norths[1] - norths[0]), right * (easts[1] - easts[0])
    _bar(can, land, n0, e0, dn, de)
    course, length = np.arctan2(de, dn), np.hypot(dn, de)
    arrived = np.full(rows * columns, np.inf)
    first, last = axes[0][1] * columns + axes[1][1], axes[0][2] * columns + axes[1][2]
    arrived[first] = depart_s
    is_over = ~can.any(axis=1)
    for layer in range(layers):
        now_s = depart_s + layer * layer_s
        if arrived[last] <= now_s:
            return float(arrived[last])
        fresh = np.flatnonzero((arrived < now_s + layer_s) & ~is_over)
        stays = fresh[arrived[fresh] < now_s]
        is_over[stays] = (~can[stays] | (arrived[heads[stays]] <= now_s)).all(axis=1)
        stays = stays[~is_over[stays]]
        north, east = flow(n0[stays], e0[stays], np.full(len(stays), now_s))
        held = np.hypot(north, east) < sailor.top - LEAST_M_S
        is_over[stays[~held]] = True
        fresh = np.concatenate((stays[held], fresh[arrived[fresh] >= now_s]))
        while len(fresh):
            leave_s = np.maximum(arrived[fresh], now_s)
            which, step = np.nonzero(can[fresh] & (arrived[heads[fresh]] > leave_s[:, None]))
            tail, at_s = fresh[which], leave_s[which].copy()
            took_s = np.zeros(len(tail))
            is_open = np.full(len(tail), fill_value=True)
            for part in range(PARTS):
                share = (part + 0.5) / PARTS
                place = n0[tail] + share * dn[step], e0[tail] + share * de[step]
                speed = sailor.over_ground(*flow(*place, at_s + 0.5 * took_s), course[step])
                is_open &= speed > 0.0
                took_s = length[step] / PARTS / np.maximum(speed, LEAST_M_S)
                at_s += took_s
            at_s[~is_open] = np.inf
            before = arrived.copy()
            np.minimum.at(arrived, heads[tail, step], at_s)
            fresh = np.flatnonzero((arrived < before) & (arrived < now_s + layer_s))
    return math.inf


def sailed_s(
    points: Sequence[tuple[float, float]], sailor: Sailor, flow: Flow, depart_s: float, step_m: float = 2.0
) -> float:
    """When a boat that leaves then comes to the end of a route, by small steps; infinite: never."""
    now_s = depart_s
    for (n0, e0), (n1, e1) in pairwise(points):
        length, course = math.hypot(n1 - n0, e1 - e0), np.array([math.atan2(e1 - e0, n1 - n0)])
        number = max(1, round(length / step_m))
        took_s = 0.0
        for part in range(number):
            share = (part + 0.5) / number
            place = np.array([n0 + share * (n1 - n0)]), np.array([e0 + share * (e1 - e0)])
            speed = sailor.over_ground(*flow(*place, np.array([now_s + 0.5 * took_s])), course)
            if not speed[0] > 0.0:
                return math.inf
            took_s = length / number / float(speed[0])
            now_s += took_s
    return now_s


def _axis(a: float, b: float, low: float, high: float, cell: float) -> tuple[Array, int, int]:
    """Places along an axis of which a and b are two, and their numbers."""
    step = abs(b - a) / max(1, round(abs(b - a) / cell)) if abs(b - a) > 1e-6 else cell
    below, above = math.floor((a - low) / step), math.floor((high - a) / step)
    places = a + step * np.arange(-below, above + 1, dtype=np.float64)
    return places, below, below + round((b - a) / step)


def _bar(can: NDArray[np.bool_], land: shapely.Geometry, n0: Array, e0: Array, dn: Array, de: Array) -> None:
    """Take out the steps that touch land."""
    shapely.prepare(land)
    room = shapely.distance(shapely.points(e0, n0), land)
    can[room <= 0.0] = False
    near, step = np.nonzero(can & (room[:, None] < np.hypot(dn, de)))
    ends = np.stack((e0[near] + de[step], n0[near] + dn[step]), axis=1)
    legs = shapely.linestrings(np.stack((np.stack((e0[near], n0[near]), axis=1), ends), axis=1))
    barred = shapely.intersects(land, legs)
    can[near[barred], step[barred]] = False
