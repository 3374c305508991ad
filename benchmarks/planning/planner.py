"""How long does A* take on a grid, against networkx's A* over the same eight-connected graph?"""

import math
from importlib.util import find_spec

import numpy as np
from scipy.ndimage import gaussian_filter

from benchmarks.measure import Row, alone, cpu_seconds, paired
from mission_tools.maps import load_source
from mission_tools.planning.astar import SearchResult, astar
from mission_tools.planning.expansion import EightNeighbours
from mission_tools.planning.grid import Grid
from mission_tools.planning.heuristics import estimates
from mission_tools.planning.planner import plan

_SIDE = 256
_SEED = 7


def _grid() -> Grid:
    """Smooth noise, four cells in ten blocked: water with many islands."""
    noise = gaussian_filter(np.random.default_rng(_SEED).standard_normal((_SIDE, _SIDE)), 3.0)
    free = noise > np.quantile(noise, 0.4)
    free[[0, -1], :] = free[:, [0, -1]] = False
    return Grid(free, 0.0, 0.0, 1.0)


def _far_apart(grid: Grid, expansion: EightNeighbours) -> tuple[int, int]:
    """Two cells that are far apart and joined: the ends of a breadth-first walk from the first free cell."""
    reached = start = int(np.flatnonzero(grid.free)[len(np.flatnonzero(grid.free)) // 2])
    seen, front = {start}, [start]
    while front:
        reached = front[-1]
        front = [cell + delta for cell in front for delta, _ in expansion.moves(cell)]
        front = [cell for cell in dict.fromkeys(front) if cell not in seen]
        seen.update(front)
    return start, reached


def rows() -> list[Row]:
    """One search on a grid, and a whole plan on the mill pond."""
    grid = _grid()
    expansion = EightNeighbours(grid)
    start, goal = _far_apart(grid, expansion)

    def search() -> SearchResult:
        return astar(expansion, estimates("octile", grid, goal), start, goal)

    pond = load_source("lake")
    assert pond.route.start is not None
    assert pond.route.goal is not None
    ends = (pond.route.start, pond.route.goal)
    planning = [cpu_seconds(lambda: plan(pond.chart, *ends)) * 1e3 for _ in range(5)]
    whole = alone("plan on the mill pond, from map to shortened route", "ms", "less", planning)
    question = f"A*, octile, {_SIDE} × {_SIDE} cells"
    if find_spec("networkx") is None:
        mine = [cpu_seconds(search) * 1e3 for _ in range(9)]
        return [alone(question, "ms", "less", mine, "networkx is not installed: no peer"), whole]
    return [_against_networkx(question, grid, expansion, (start, goal), search), whole]


def _against_networkx(
    question: str, grid: Grid, expansion: EightNeighbours, ends: tuple[int, int], search: object
) -> Row:
    import networkx  # noqa: PLC0415  an optional peer

    graph = networkx.Graph()
    for cell in np.flatnonzero(grid.free).tolist():
        graph.add_weighted_edges_from(
            (cell, cell + delta, cost / 1e9) for delta, cost in expansion.moves(cell)
        )

    def octile(a: int, b: int) -> float:
        (row_a, column_a), (row_b, column_b) = divmod(a, grid.columns), divmod(b, grid.columns)
        rows, columns = abs(row_a - row_b), abs(column_a - column_b)
        return max(rows, columns) + (math.sqrt(2.0) - 1.0) * min(rows, columns)

    def peer() -> float:
        length: float = networkx.astar_path_length(graph, *ends, heuristic=octile)
        return length

    assert callable(search)
    assert math.isclose(search().length, peer(), rel_tol=1e-6)
    return paired(question, "ms", 1e3, search, "networkx", peer)
