"""A* with redundant nodes pruned and a cubic spline through the rest.

After Zhang and Li, the paper's reference [11]: nodes that the line of sight makes unnecessary are removed,
and a cubic spline smooths what is left. A spline swings out at its nodes; where it leaves the clear water,
the straight legs there get a node more, and after some rounds the pruned path itself is the answer.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from scipy.interpolate import CubicSpline

from benchmarks.peers.interface import Deadline, NoPath, Path, Sea
from companion.core.geo import Point, distance_m
from mission_tools.errors import NoRoute
from mission_tools.planning.astar import astar
from mission_tools.planning.expansion import EightNeighbours
from mission_tools.planning.heuristics import estimates

CELLS = 40_000
_ROUNDS = 5
_SAMPLES = 8  # of the spline for each of its pieces


def pruned_spline(sea: Sea, start: Point, goal: Point, seed: int, deadline: Deadline) -> Path:  # noqa: ARG001
    """A grid path, pruned and smoothed."""
    grid = sea.grid(CELLS)
    first, last = sea.entries(grid, start, goal)
    try:
        found = astar(EightNeighbours(grid), estimates("octile", grid, last), first, last)
    except NoRoute as error:
        raise NoPath(str(error)) from error
    nodes = pruned(sea, (start, *map(grid.centre, found.cells), goal))
    pieces = nodes
    for _ in range(_ROUNDS if len(nodes) > 2 else 0):
        deadline.check()
        smooth, spans = _spline(pieces)
        if all(sea.is_clear(a, b) for a, b in pairwise(smooth)):
            return smooth
        finer = [pieces[0]]
        for (a, b), span in zip(pairwise(pieces), spans, strict=True):
            if not all(sea.is_clear(p, q) for p, q in pairwise(span)):
                finer.append(Point(0.5 * (a.north_m + b.north_m), 0.5 * (a.east_m + b.east_m)))
            finer.append(b)
        pieces = tuple(finer)
    return nodes


def pruned(sea: Sea, path: Sequence[Point]) -> Path:
    """From each kept node on to the last one it sees."""
    kept = [path[0]]
    at = 0
    while at < len(path) - 1:
        ahead = len(path) - 1
        while ahead > at + 1 and not sea.is_clear(path[at], path[ahead]):
            ahead -= 1
        kept.append(path[ahead])
        at = ahead
    return tuple(kept)


def _spline(nodes: Path) -> tuple[Path, list[Path]]:
    """Points on the natural cubic spline through the nodes by chord length, and those of each piece."""
    along = np.cumsum([0.0, *(max(distance_m(a, b), 1e-9) for a, b in pairwise(nodes))])
    curve = CubicSpline(along, np.array(nodes), bc_type="natural")
    spans: list[Path] = []
    for (a, b), (node, after) in zip(pairwise(along), pairwise(nodes), strict=True):
        between = curve(np.linspace(a, b, _SAMPLES + 1)[1:-1])
        spans.append((node, *(Point(float(north), float(east)) for north, east in between), after))
    return (nodes[0], *(point for span in spans for point in span[1:])), spans
