"""How long does a shortest path on a grid take, against pyastar2d, networkx and the readable A*?

On the MovingAI maps, query by query in turn, the best of five. pyastar2d answers another question: its
diagonal step costs as much as a straight one and may cut corners, so its time is compared, not its path.
"""

import gc
import math
import statistics
import time
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from benchmarks.measure import Row, alone, spread
from companion.planning.grid import GridMap, GridPath, shortest_path
from mission_tools.maps.movingai import GridQuery, read_grid_map, read_grid_queries
from mission_tools.planning.astar import astar
from mission_tools.planning.expansion import EightNeighbours
from mission_tools.planning.grid import BORDER, Grid
from mission_tools.planning.heuristics import estimates

FOLDER = Path("tests/data/grids")
_QUERIES = 60
_SLOW_QUERIES = 12
_TURNS = 5
_NETWORKX = ("arena2",)  # its graph of a larger map takes half a gigabyte

Search = Callable[[GridQuery], object]


def rows() -> list[Row]:
    """One row a map and peer."""
    found = []
    against_pyastar2d: list[float] = []
    for path in sorted(FOLDER.glob("*.map")):
        found += _on_map(path.stem, against_pyastar2d)
    if against_pyastar2d:
        note = f"{len(against_pyastar2d)} queries, as many on each map; lowest {min(against_pyastar2d):.2g}"
        found.append(
            alone("pyastar2d's time ÷ ours, all maps, best of five", "×", "more", against_pyastar2d, note)
        )
    return found


def _on_map(name: str, against_pyastar2d: list[float]) -> list[Row]:
    grid = read_grid_map(FOLDER / f"{name}.map")
    queries = read_grid_queries(FOLDER / f"{name}.map.scen")

    def ours(query: GridQuery) -> GridPath:
        return shortest_path(grid, query.start, query.goal)

    few = queries[:: len(queries) // _SLOW_QUERIES]
    for query in few:
        assert math.isclose(ours(query).length, query.length, rel_tol=6e-6)
    found = []
    if find_spec("pyastar2d") is not None:
        many = queries[:: len(queries) // _QUERIES]
        row, ratios = _in_turn(name, many, ours, "pyastar2d", _pyastar2d(grid))
        against_pyastar2d += [1.0 / ratio for ratio in ratios]
        found.append(row)
    found.append(_in_turn(name, few, ours, "readable A*", _readable(grid))[0])
    if name in _NETWORKX and find_spec("networkx") is not None:
        found.append(_in_turn(name, few, ours, "networkx", _networkx(grid))[0])
    return found


def _in_turn(
    question: str, queries: list[GridQuery], ours: Search, peer_name: str, peer: Search
) -> tuple[Row, list[float]]:
    """CPU time of both for each query, the best of some in turn; the ratios ours ÷ peer's."""
    pairs = []
    for search in (ours, peer):
        search(queries[-1])
    gc.collect()
    gc.disable()
    try:
        for query in queries:
            best = [math.inf, math.inf]
            for _ in range(_TURNS):
                for which, search in enumerate((ours, peer)):
                    began = time.thread_time()
                    search(query)
                    best[which] = min(best[which], (time.thread_time() - began) * 1e3)
            pairs.append(best)
    finally:
        gc.enable()
    mine, theirs = zip(*pairs, strict=True)
    ratios = [a / b for a, b in pairs]
    row = Row(
        question, "ms", "less", statistics.median(mine), spread(mine),
        peer_name, statistics.median(theirs), statistics.median(ratios),
    )  # fmt: skip
    return row, ratios


def _pyastar2d(grid: GridMap) -> Search:
    import pyastar2d  # noqa: PLC0415  an optional peer

    free = np.frombuffer(grid.free, dtype=np.uint8).reshape(grid.height, grid.width)
    weights = np.where(free == 1, 1.0, np.inf).astype(np.float32)

    def search(query: GridQuery) -> object:
        start, goal = divmod(query.start, grid.width), divmod(query.goal, grid.width)
        return pyastar2d.astar_path(weights, start, goal, allow_diagonal=True)

    return search


def _readable(grid: GridMap) -> Search:
    free = np.frombuffer(grid.free, dtype=np.uint8).reshape(grid.height, grid.width) == 1
    chart = Grid(np.pad(free, BORDER), 0.0, 0.0, 1.0)
    expansion = EightNeighbours(chart)

    def cell(number: int) -> int:
        row, column = divmod(number, grid.width)
        return (row + BORDER) * chart.columns + column + BORDER

    def search(query: GridQuery) -> object:
        goal = cell(query.goal)
        return astar(expansion, estimates("octile", chart, goal), cell(query.start), goal)

    return search


def _networkx(grid: GridMap) -> Search:
    import networkx  # noqa: PLC0415  an optional peer

    free = np.frombuffer(grid.free, dtype=np.uint8).reshape(grid.height, grid.width) == 1
    expansion = EightNeighbours(Grid(np.pad(free, BORDER), 0.0, 0.0, 1.0))
    stride = grid.width + 2 * BORDER
    graph = networkx.Graph()
    for cell in np.flatnonzero(np.pad(free, BORDER)).tolist():
        graph.add_weighted_edges_from(
            (cell, cell + delta, cost / 1e9) for delta, cost in expansion.moves(cell)
        )

    def octile(a: int, b: int) -> float:
        across, along = abs(a % stride - b % stride), abs(a // stride - b // stride)
        return max(across, along) + (math.sqrt(2.0) - 1.0) * min(across, along)

    def search(query: GridQuery) -> object:
        ends = (
            (number // grid.width + BORDER) * stride + number % grid.width + BORDER
            for number in (query.start, query.goal)
        )
        return networkx.astar_path_length(graph, *ends, heuristic=octile)

    return search
