"""What a survey sails, in order: tracks, closed passes along the shore, cross lines."""

import math
from collections.abc import Sequence
from itertools import pairwise, zip_longest

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon

from mission_tools.tasks.survey.coverage import way_lengths_m
from mission_tools.tasks.survey.postman import Pass, Visit, linked, stations_along, with_chains
from mission_tools.tasks.survey.sequence import Mode, best_sequence
from mission_tools.tasks.survey.tracks import Tracks
from mission_tools.tasks.survey.turns import turn_length_m
from mission_tools.tasks.task_route import LegKind

Array = NDArray[np.float64]
Way = tuple[int, ...]
MOST_SORTED = 300  # tracks that are sorted one by one: a second on the development machine
_TRIES = 64  # entries into a ring that are tried for a clear line before a planned way is taken


def in_best_order(
    tracks: Tracks,
    water: Polygon,
    start: Array | None,
    end: Array | None,
    detail_m: float,
    kind: LegKind,
    radius_m: float = 0.0,
    passes: Sequence[Pass] = (),
    gap_m: float = 0.0,
) -> list[Visit]:
    """The tracks, each cell to and fro, and the passes, in an order with short transits.

    start, end: where the boat comes from and goes to afterwards; None: free. radius_m: of its turns.
    passes: closed, with their spikes; cells are sailed from passes where that is shorter. gap_m: that a
    pass may leave out where it is left or closed.
    """
    if not tracks.cells:
        return _with_passes([], passes, water, start, detail_m, gap_m)
    ends = tracks.ends()
    count, spacing_m = len(tracks.tracks), tracks.spacing_m
    skip = 1 + math.ceil(2.0 * radius_m / spacing_m) if 0.0 < spacing_m < 2.0 * radius_m else 1
    paths = [_ways_through(cell, count, skip) for cell in tracks.cells]
    lengths_m, number = _between(paths, ends, water, (start, end), detail_m)
    items = _items(paths, number, tracks, radius_m)
    order = best_sequence(items, lengths_m, len(number), len(number) + 1)
    if skip == 1 and len(paths) < count <= MOST_SORTED:
        nodes = [node for item, mode in order for node in paths[item][mode]]
        paths = [[(track, track + count), (track + count, track)] for track in range(count)]
        lengths_m, number = _between(paths, ends, water, (start, end), detail_m)
        items = _items(paths, number, tracks, radius_m)
        order = [(node % count, node // count) for node in nodes[::2]]
        order = best_sequence(items, lengths_m, len(number), len(number) + 1, order)
    found = []
    for item, mode in order:
        way = paths[item][mode]
        found.append([Visit(kind, ends[[way[n], way[n + 1]]]) for n in range(0, len(way), 2)])
    if not passes:
        return [visit for visits in found for visit in visits]
    first, last = np.array([items[item][mode][:2] for item, mode in order]).T
    open_m = lengths_m[len(number), first][:, None] + lengths_m[last, len(number) + 1][None]
    ways_m = lengths_m[np.ix_(first, last)]
    alone = with_chains(passes, found, ways_m, open_m, water, 2.0 * detail_m)
    return _with_passes(alone, passes, water, start, detail_m, gap_m)


def _between(
    paths: Sequence[Sequence[Way]],
    ends: Array,
    water: Polygon,
    outside: tuple[Array | None, Array | None],
    detail_m: float,
) -> tuple[Array, dict[int, int]]:
    """Lengths between where ways begin and end, and the number of each such node; the last two are start and
    end, which are free where they are None.
    """
    corners = sorted({node for ways in paths for way in ways for node in (way[0], way[-1])})
    count = len(corners)
    named = [*range(count), *(count + n for n, place in enumerate(outside) if place is not None)]
    places = np.vstack([ends[corners], *([place[None] for place in outside if place is not None])])
    lengths_m = np.zeros((count + 2, count + 2))
    lengths_m[np.ix_(named, named)] = way_lengths_m(water, places, np.arange(len(places)), detail_m)
    return lengths_m, {node: index for index, node in enumerate(corners)}


def _items(
    paths: Sequence[Sequence[Way]], number: dict[int, int], tracks: Tracks, radius_m: float
) -> list[list[Mode]]:
    return [
        [Mode(number[way[0]], number[way[-1]], _inner_m(way, tracks, radius_m)) for way in ways]
        for ways in paths
    ]


def _with_passes(
    visits: list[Visit],
    passes: Sequence[Pass],
    water: Polygon,
    start: Array | None,
    detail_m: float,
    gap_m: float,
) -> list[Visit]:
    """The visits, and the passes with what is sailed on the way along them where the detour is least."""
    if not passes:
        return visits
    alone_m = [0.0, *(math.inf for _ in passes[1:])]
    if visits or start is not None:
        alone_m = [_entry(visits, one, water, start, detail_m)[0] for one in passes]
    for one in linked(passes, alone_m, gap_m, water, 4.0 * detail_m):
        _, gap, place = _entry(visits, one, water, start, detail_m)
        visits[gap:gap] = one.visits(place, gap_m)
    return visits


def _entry(
    visits: Sequence[Visit], one: Pass, water: Polygon, start: Array | None, detail_m: float
) -> tuple[float, int, Array]:
    """The least detour to a pass, the gap between visits that it is from, and the place to enter the pass."""
    stations = stations_along(one.points, 2.0 * detail_m)
    before = [start, *(visit.points[-1] for visit in visits)]
    after = [*(visit.points[0] for visit in visits), None]
    cost_m = _gaps_m(before, stations) + _gaps_m(after, stations)
    cost_m -= [
        0.0 if origin is None or goal is None else float(np.hypot(*(goal - origin)))
        for origin, goal in zip(before, after, strict=True)
    ]
    cost_m = cost_m.T
    gap, station = _first_clear(cost_m, before, after, stations, water)
    return float(cost_m[gap, station]), gap, stations[station]


def _ways_through(cell: tuple[int, ...], count: int, skip: int) -> list[tuple[int, ...]]:
    """The nodes of a cell's tracks in the ways to sail them, first all, then all the other way round.

    Track after track, beginning up or down; and, where a turn into the next track but `skip` is easier, by
    turns a track of this half of a block and one of the other half.
    """
    orders = [cell]
    if skip > 1:
        orders.append(tuple(track for block in _blocks(cell, 2 * skip) for track in _by_turns(block)))
    ways = []
    for tracks in orders:
        for is_up in (True, False):
            way: list[int] = []
            for step, track in enumerate(tracks):
                low, high = track, track + count
                way += (low, high) if is_up == (step % 2 == 0) else (high, low)
            ways.append(tuple(way))
    return ways + [way[::-1] for way in ways]


def _blocks(cell: tuple[int, ...], size: int) -> list[tuple[int, ...]]:
    """Stretches of at least this many tracks, but for a cell that has fewer."""
    number = max(1, len(cell) // size)
    cuts = [round(n * len(cell) / number) for n in range(number + 1)]
    return [cell[first:last] for first, last in pairwise(cuts)]


def _by_turns(block: tuple[int, ...]) -> list[int]:
    """0, 3, 1, 4, 2, 5 of six."""
    half = (len(block) + 1) // 2
    return [track for pair in zip_longest(block[:half], block[half:]) for track in pair if track is not None]


def _inner_m(way: tuple[int, ...], tracks: Tracks, radius_m: float) -> float:
    """Of the turns between the tracks of a cell."""
    count, nodes = len(tracks.tracks), np.array(way)
    across, low, high = np.array(tracks.tracks).T
    along = np.concatenate((low, high))
    out, into = nodes[1:-1:2], nodes[2::2]
    sideways_m = np.abs(across[into % count] - across[out % count])
    return float(turn_length_m(sideways_m, along[into] - along[out], radius_m).sum())


def _gaps_m(places: list[Array | None], stations: Array) -> Array:
    """[station, place]: straight distances; 0 for a free place."""
    points = np.array([stations[0] if place is None else place for place in places])
    found: Array = np.hypot(*(stations[:, None] - points[None]).transpose(2, 0, 1))
    found[:, [place is None for place in places]] = 0.0
    return found


def _first_clear(
    cost_m: Array, before: list[Array | None], after: list[Array | None], stations: Array, water: Polygon
) -> tuple[int, int]:
    """The cheapest (gap, station) whose straight lines lie in the water; the cheapest of all if none tried
    does.
    """
    tries = min(_TRIES, cost_m.size) - 1
    flat = np.argpartition(cost_m, tries, axis=None)[: tries + 1]
    flat = flat[np.lexsort((flat, cost_m.ravel()[flat]))]
    for gap, station in zip(*np.unravel_index(flat, cost_m.shape), strict=True):
        ends = [place for place in (before[gap], after[gap]) if place is not None]
        if all(water.covers(shapely.LineString([place, stations[station]])) for place in ends):
            return int(gap), int(station)
    gap, station = np.unravel_index(int(flat[0]), cost_m.shape)
    return int(gap), int(station)
