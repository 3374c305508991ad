"""The search of the grid planner: jump points where they apply, else the paper's A*.

Jump points know only octile costs and their own estimate. Another heuristic, or a limit on expanded cells,
which counts the cells of A*, takes the readable A* of `astar.py`. Both give the same length.
"""

from functools import cached_property

from companion.planning.grid import GridMap, NoGridPath, shortest_path
from mission_tools.errors import NoRoute
from mission_tools.planning.astar import SearchMetrics, SearchResult, astar
from mission_tools.planning.expansion import STRAIGHT, EightNeighbours
from mission_tools.planning.grid import Grid
from mission_tools.planning.heuristics import HeuristicName, estimates


class GridSearch:
    """Paths between the cells of one grid."""

    def __init__(self, grid: Grid, heuristic: HeuristicName = "octile", budget: int | None = None) -> None:
        """budget: most cells that A* may expand; None for no limit."""
        self._grid = grid
        self._heuristic = heuristic
        self._budget = budget

    @cached_property
    def _map(self) -> GridMap:
        return GridMap(self._grid.free.tobytes(), self._grid.columns, self._grid.rows)

    @cached_property
    def _expansion(self) -> EightNeighbours:
        return EightNeighbours(self._grid)

    def path(self, start: int, goal: int) -> SearchResult:
        """The path between two free cells; the metrics of jump points are of expanded cells only.

        Raises:
            NoRoute: no path joins them.
            SearchBudgetExceeded: the budget was spent first.
        """
        if self._heuristic != "octile" or self._budget is not None:
            ahead = estimates(self._heuristic, self._grid, goal)
            return astar(self._expansion, ahead, start, goal, self._budget)
        try:
            found = shortest_path(self._map, start, goal)
        except NoGridPath as error:
            raise NoRoute(
                f"no route: all {error.expanded} cells that can be reached were looked at"
            ) from error
        metrics = SearchMetrics(found.expanded, generated=0, updated=0, max_open=0)
        return SearchResult(found.cells, round(found.length * STRAIGHT), metrics)
