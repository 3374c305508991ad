"""How do the planners of the related work compare with the exact route, on pool, lakes and grids?

Each plans the same queries with the same seeds and the same clearance; a path that does not keep it is a
failure. out/peers.md gets a table of all, out/benchmarks.md those on the mill pond.
"""

import statistics
import time
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path

from benchmarks.measure import Row, write
from benchmarks.measure import table as markdown
from benchmarks.peers import PEERS
from benchmarks.peers.interface import Failed, Sea, plan
from companion.core.geo import Point
from companion.planning.visibility import NoWay
from mission_tools.maps import load_source
from mission_tools.maps.formats.grid_map import load_grid_map
from mission_tools.planning.exact_planner import water_of
from sitl.scenarios.scenario import load_scenario

GRID = Path("tests/data/grids/arena2.map")
SEEDS = (11, 12, 13)
BUDGET_S = 5.0
GRID_CLEARANCE_M = 0.25  # in cells of 1 m, so that a corridor of one cell is passable
EXACT = "exact (ours)"
POND = "mill pond"

Query = tuple[Point, Point]


@dataclass
class Tally:
    """What one planner did on one kind of water."""

    excesses: list[float] = field(default_factory=list)
    times_s: list[float] = field(default_factory=list)
    failures: int = 0

    @property
    def time_ms(self) -> float:
        return 1e3 * statistics.median(self.times_s)

    def __str__(self) -> str:
        said = [f"+{statistics.median(self.excesses):.2f} %"] if self.excesses else []
        said.append(f"{self.time_ms:.3g} ms")
        if self.failures:
            said.append(f"{self.failures} of {len(self.times_s)} failed")
        return ", ".join(said)


def rows() -> list[Row]:
    """A row a planner that finds a way on the mill pond."""
    names = [name for name in PEERS if name != "RRT*" or find_spec("ompl") is not None]
    waters = _waters()
    table = {name: {water: _tally(name, *asked) for water, asked in waters.items()} for name in names}
    table[EXACT] = {water: _exact_tally(*asked) for water, asked in waters.items()}
    cells = ((name, *map(str, by_water.values())) for name, by_water in table.items())
    write("peers", markdown(("planner", *waters), cells))
    ours_ms, on_pond = table[EXACT][POND].time_ms, {name: table[name][POND] for name in names}
    return [
        Row(
            "CPU time of a route on the mill pond", "ms", ours_ms, 0.0,
            name.replace("*", r"\*"), tally.time_ms, ours_ms / tally.time_ms,
            f"{statistics.median(tally.excesses):.2f} % longer",
        )
        for name, tally in on_pond.items() if tally.excesses
    ]  # fmt: skip


def _waters() -> dict[str, tuple[Sea, list[Query]]]:
    """The pool's cases but the one whose start has no clearance, the pond, and a long query on a grid."""
    found = {}
    cases = [load_scenario("pool", (), str(number)).route for number in range(1, 6)]
    for title, source, routes in (("pool", "pool", cases), (POND, "lake", [load_source("lake").route])):
        scenario = load_source(source)
        assert scenario.route.clearance_m is not None
        sea = Sea(scenario.chart, scenario.route.clearance_m)
        queries = [(route.start, route.goal) for route in routes if route.start and route.goal]
        found[title] = sea, [query for query in queries if _is_joined(sea, query)]
    sea = Sea(load_grid_map(GRID), GRID_CLEARANCE_M)
    found[GRID.stem] = sea, [next(query for query in _queries() if _is_joined(sea, query))]
    return found


def _queries() -> list[Query]:
    """Start and goal of some lines of the MovingAI scenario, longest first, on cells of 1 m."""
    found = []
    for line in GRID.with_suffix(".map.scen").read_text("ascii").strip().splitlines()[:0:-40]:
        *_, height, start_x, start_y, goal_x, goal_y, _ = line.split()
        north_m = float(height) - 0.5
        start = Point(north_m - float(start_y), float(start_x) + 0.5)
        found.append((start, Point(north_m - float(goal_y), float(goal_x) + 0.5)))
    return found


def _is_joined(sea: Sea, query: Query) -> bool:
    try:
        sea.water.routes(sea.clearance_m).route(*query)
    except NoWay:
        return False
    return True


def _tally(name: str, sea: Sea, queries: list[Query]) -> Tally:
    tally = Tally()
    for start, goal in queries:
        exact_m = sea.water.routes(sea.clearance_m).route(start, goal).length_m
        for seed in SEEDS:
            found = plan(PEERS[name], sea, start, goal, seed, BUDGET_S)
            tally.times_s.append(found.cpu_s)
            if isinstance(found, Failed):
                tally.failures += 1
            else:
                tally.excesses.append(100.0 * (found.length_m / exact_m - 1.0))
    return tally


def _exact_tally(sea: Sea, queries: list[Query]) -> Tally:
    tally = Tally([0.0])
    for start, goal in queries:
        began_s = time.thread_time()
        water_of.__wrapped__(sea.chart).routes(sea.clearance_m).route(start, goal)  # without what is kept
        tally.times_s.append(time.thread_time() - began_s)
    return tally
