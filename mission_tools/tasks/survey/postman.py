"""Passes with what is sailed on the way along them: spikes, chains of tracks, further passes.

Tracks and passes must be sailed, the ways between them are free: the rural postman problem. As in the
heuristic of G. N. Frederickson ("Approximation algorithms for some postman problems", *SIAM Journal on
Computing* 7, 1979) a tree of shortest links joins the passes, each sailed out and back. Tracks come as one
sequence, which is cut where it is shorter to sail a part of it from a pass nearby: route first, cluster
second (J. E. Beasley, *Omega* 11, 1983), by dynamic programming (C. Prins, *Computers & Operations Research*
31, 2004).
"""

import heapq
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon
from shapely.ops import substring

from mission_tools.tasks.shoreline import begun_at
from mission_tools.tasks.survey.coverage import UNREACHED
from mission_tools.tasks.task_route import LegKind

Array = NDArray[np.float64]
_TRIES = 16  # places on the passes nearest to an end of a chain that are tried for a clear line
_NEAR = 10.0  # footprints: passes farther apart are not linked
_WIDER = 0.05  # footprints: a piece that is so much wider than one all round is still covered by a spike


class Visit(NamedTuple):
    """Something sailed whole, as (east, north) points."""

    kind: LegKind
    points: Array


class Entered(NamedTuple):
    """A pass, and the place to enter it."""

    one: "Pass"
    place: Array


@dataclass(slots=True)
class Pass:
    """A closed pass, and what is sailed on the way: the place to leave it at, and the tip of a spike, a chain
    of tracks, or another pass.
    """

    points: Array
    ways: list[tuple[Array, Array | Sequence[Visit] | Entered]] = field(default_factory=list)

    def visits(self, begin: Array, gap_m: float, beside: Array | None = None) -> Iterator[Visit]:
        """Once round, with everything on the way.

        begin: in the middle of the gap where the pass is closed. gap_m: its length, and that of the gaps
        where the pass is left and entered again. beside: nearer to the round's end than to its beginning.
        """
        line, half_m = shapely.LineString(begun_at(self.points, shapely.Point(begin))), 0.5 * gap_m
        if beside is not None:
            first, last = line.interpolate(half_m), line.interpolate(line.length - half_m)
            if first.distance(shapely.Point(beside)) < last.distance(shapely.Point(beside)):
                line = line.reverse()
        leaves_m = [max(0.0, line.project(shapely.Point(leave)) - half_m) for leave, _ in self.ways]
        here_m = half_m
        for number in np.argsort(leaves_m, kind="stable"):
            leave_m, way = leaves_m[number], self.ways[number][1]
            if leave_m >= here_m:
                yield from _stretch(line, here_m, leave_m)
                here_m = leave_m + gap_m
            off, on = shapely.get_coordinates([line.interpolate(leave_m), line.interpolate(here_m)])
            if isinstance(way, Entered):
                yield from way.one.visits(way.place, gap_m, on)
            elif isinstance(way, np.ndarray):
                yield Visit("track", np.vstack((off, way, on)))
            else:
                yield from way
        yield from _stretch(line, here_m, line.length - half_m)


def _stretch(line: shapely.LineString, from_m: float, to_m: float) -> Iterator[Visit]:
    if to_m > from_m:
        yield Visit("shore", shapely.get_coordinates(substring(line, from_m, to_m)))


def with_spikes(
    passes: Sequence[Pass], pieces: Sequence[Polygon], water: Polygon, swath_m: float
) -> list[Polygon]:
    """Add spikes to the nearest passes, as short as can be, for pieces that one place covers; the others."""
    lines, others = np.array([shapely.LineString(one.points) for one in passes]), list[Polygon]()
    tree = shapely.STRtree(lines)
    shapely.prepare(water)
    for piece in pieces:
        centre = shapely.minimum_bounding_circle(piece).centroid
        room_m = 0.5 * swath_m - float(shapely.minimum_bounding_radius(piece))
        ring = int(tree.nearest(centre))
        way = shapely.shortest_line(centre, lines[ring])
        tip = way.interpolate(min(max(room_m, 0.0), way.length))
        leave = shapely.get_point(way, -1)
        if room_m < -_WIDER * swath_m or not water.covers(shapely.LineString([tip, leave])):
            others.append(piece)
        else:
            passes[ring].ways.append((shapely.get_coordinates(leave)[0], shapely.get_coordinates(tip)[0]))
    return others


def with_chains(
    passes: Sequence[Pass],
    cells: Sequence[Sequence[Visit]],
    ways_m: Array,
    open_m: Array,
    water: Polygon,
    spacing_m: float,
) -> list[Visit]:
    """Cut the sequence of cells into chains that are shortest together, each but one sailed from a pass.

    ways_m: from the beginning of each cell to the end of each. open_m: what it costs to sail from one cell to
    another, inclusive, and from no pass. Returns the chain that is sailed from none.
    """
    stations = [stations_along(one.points, spacing_m) for one in passes]
    places, ring_of = np.vstack(stations), np.repeat(np.arange(len(passes)), [len(one) for one in stations])
    entries, exits = (np.array([cell[end].points[end] for cell in cells]) for end in (0, -1))
    # closed_m[first, last] by the station nearest to the one end or to the other; never shorter than the way.
    station, closed_m = list[NDArray[np.intp]](), list[Array]()
    for ends, others, ways in ((entries, exits, ways_m), (exits, entries, ways_m.T)):
        near, there_m = _nearest_clear(ends, places, water)
        back_m = np.hypot(*(places[near][:, None] - others[None]).transpose(2, 0, 1))
        station.append(near)
        closed_m.append(np.maximum(there_m[:, None] + back_m, ways))
    by_first, by_last = closed_m[0], closed_m[1].T
    costs_m = np.stack((np.minimum(by_first, by_last), open_m))
    inner_m = np.concatenate(([0.0], np.cumsum(np.diagonal(ways_m, -1))))
    # best_m[open, count]: of the chains of so many cells, with so many open ones; came_from: the last one.
    count = len(cells)
    best_m, came_from = np.full((2, count + 1), np.inf), np.zeros((2, count + 1, 2), dtype=np.intp)
    best_m[0, 0] = 0.0
    for last in range(count):
        for is_open, was_open in ((0, 0), (1, 1), (1, 0)):
            total_m = best_m[was_open, : last + 1] + costs_m[is_open - was_open, : last + 1, last]
            total_m = total_m + inner_m[last] - inner_m[: last + 1]
            first = int(np.argmin(total_m))
            if total_m[first] < best_m[is_open, last + 1]:
                best_m[is_open, last + 1], came_from[is_open, last + 1] = total_m[first], (first, was_open)
    alone: list[Visit] = []
    end, is_open = count, int(np.argmin(best_m[:, count]))
    while end > 0:
        first, was_open = (int(value) for value in came_from[is_open, end])
        chain = [visit for cell in cells[first:end] for visit in cell]
        if is_open != was_open:
            alone = chain
        else:
            side = 0 if by_first[first, end - 1] <= by_last[first, end - 1] else 1
            at = station[side][(first, end - 1)[side]]
            passes[ring_of[at]].ways.append((places[at], chain))
        end, is_open = first, was_open
    return alone


def stations_along(ring: Array, spacing_m: float) -> Array:
    """Points along a closed ring, corners included, at most spacing_m apart."""
    points: Array = shapely.get_coordinates(shapely.segmentize(shapely.LineString(ring), spacing_m))
    return points[:-1]


def _nearest_clear(ends: Array, places: Array, water: Polygon) -> tuple[NDArray[np.intp], Array]:
    """Of each end, the nearest place with a clear line, and its length; infinite where none of a few has."""
    from scipy.spatial import cKDTree  # noqa: PLC0415  a survey alone needs it

    tries = min(_TRIES, len(places))
    near = cKDTree(places).query(ends, k=tries)[1].reshape(len(ends), tries)
    lines = shapely.linestrings(np.stack((np.repeat(ends, tries, axis=0), places[near.ravel()]), axis=1))
    shapely.prepare(water)
    lengths_m = np.where(shapely.covers(water, lines), shapely.length(lines), np.inf).reshape(near.shape)
    best = np.argmin(lengths_m, axis=1)[:, None]
    return np.take_along_axis(near, best, 1)[:, 0], np.take_along_axis(lengths_m, best, 1)[:, 0]


def linked(
    passes: Sequence[Pass], alone_m: Sequence[float], gap_m: float, water: Polygon, swath_m: float
) -> list[Pass]:
    """Link passes to each other by clear lines where that is shorter than alone_m (R. C. Prim, 1957).

    alone_m: what it costs to sail a pass from none. Returns those that are.
    """
    lines = np.array([shapely.LineString(one.points) for one in passes])
    pairs = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=_NEAR * swath_m)
    one, other = pairs[:, pairs[0] != pairs[1]]
    links = shapely.shortest_line(lines[one], lines[other])
    shapely.prepare(water)
    around = np.where(shapely.covers(water, links), 1.0, UNREACHED)
    lengths_m = 2.0 * (around * shapely.length(links) - gap_m)
    onward: list[list[tuple[float, int, int]]] = [[] for _ in passes]
    for number, length_m in enumerate(lengths_m.tolist()):
        onward[one[number]].append((length_m, int(other[number]), number))
    alone, taken = list[Pass](), set[int]()
    queue = [(length_m, number, -1) for number, length_m in enumerate(alone_m)]
    heapq.heapify(queue)
    while queue:
        _, number, link = heapq.heappop(queue)
        if number in taken:
            continue
        taken.add(number)
        if link < 0:
            alone.append(passes[number])
        else:
            leave, enter = shapely.get_coordinates(links[link])
            passes[one[link]].ways.append((leave, Entered(passes[number], enter)))
        for step in onward[number]:
            heapq.heappush(queue, step)
    return alone
