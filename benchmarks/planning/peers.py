"""How do the planners of the related work compare with the exact route, on pool, lakes and grids?

Each plans the same queries with the same seeds and the same clearance; a path that does not keep it is a
failure.
"""

import statistics
import time
from dataclasses import dataclass, field
from importlib.util import find_spec
from itertools import islice
from pathlib import Path

from benchmarks.measure import Row
from benchmarks.peers import PEERS, planner
from benchmarks.peers.interface import Failed, Planned, Sea, plan
from companion.core.geo import Point
from companion.planning.visibility import NoWay
from mission_tools.maps import load_source
from mission_tools.maps.formats.grid_map import load_grid_map
from mission_tools.planning.exact_planner import water_of
from sitl.scenarios.scenario import load_scenario

PAGE = Path("docs/peers.md")
GRIDS = Path("tests/data/grids")
SEEDS = (11, 12, 13)
BUDGET_S = 5.0
GRID_CLEARANCE_M = 0.25  # in cells of 1 m, so that a corridor of one cell is passable
_GRIDS = ("arena2",)
_GRID_QUERIES = 1
_GRID_STRIDE = 40
_BEGIN, _END = "<!-- table -->", "<!-- end of table -->"

Query = tuple[Point, Point]


@dataclass
class Tally:
    """What one planner did on one kind of water."""

    excesses: list[float] = field(default_factory=list)
    times_s: list[float] = field(default_factory=list)
    reasons: list[str] = field(default_factory=list)


def rows() -> list[Row]:
    """A row by water and planner; the page gets one table of all."""
    table: dict[str, dict[str, Tally]] = {}
    for water, (sea, queries) in _waters().items():
        for name in PEERS:
            if name == "RRT*" and find_spec("ompl") is None:
                continue
            table.setdefault(name, {})[water] = _tally(name, sea, queries)
        table.setdefault("exact (ours)", {})[water] = _exact_tally(sea, queries)
    _write(table)
    return [
        Row(
            f"{water}: {name}", "% longer", "less", _median(tally.excesses), 0.0,
            note=f"{_median(tally.times_s) * 1e3:.3g} ms, {len(tally.reasons)} failures",
        )
        for name, by_water in table.items()
        for water, tally in by_water.items()
    ]  # fmt: skip


def _waters() -> dict[str, tuple[Sea, list[Query]]]:
    found = {}
    for title, source in (("pool", "pool"), ("mill pond", "lake")):
        scenario = load_source(source)
        route = scenario.route
        assert route.clearance_m is not None
        if source == "pool":
            cases = [load_scenario("pool", (), str(number)).route for number in range(1, 6)]
        else:
            cases = [route]
        sea = Sea(scenario.chart, route.clearance_m)
        queries = [(case.start, case.goal) for case in cases if case.start and case.goal]
        found[title] = sea, [query for query in queries if _is_joined(sea, query)]
    for name in _GRIDS:
        path = GRIDS / f"{name}.map"
        sea = Sea(load_grid_map(path), GRID_CLEARANCE_M)

        # From the longest on, those that the outlines of the cells still join
        ends = _queries(path.with_suffix(".map.scen"))[::-_GRID_STRIDE]
        found[name] = sea, list(islice((pair for pair in ends if _is_joined(sea, pair)), _GRID_QUERIES))
    return found


def _queries(path: Path) -> list[Query]:
    """Start and goal of each line of a MovingAI scenario, shortest first, with the map's cells of 1 m."""
    found = []
    for line in path.read_text("ascii").splitlines()[1:]:
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
            found = plan(planner(name), sea, start, goal, seed, BUDGET_S)
            tally.times_s.append(found.cpu_s)
            if isinstance(found, Planned):
                tally.excesses.append(100.0 * (found.length_m / exact_m - 1.0))
            if isinstance(found, Failed):
                tally.reasons.append(found.reason)
    return tally


def _exact_tally(sea: Sea, queries: list[Query]) -> Tally:
    tally = Tally()
    for start, goal in queries:
        began_s = time.thread_time()
        water_of.__wrapped__(sea.chart).routes(sea.clearance_m).route(start, goal)  # without what is kept
        tally.times_s.append(time.thread_time() - began_s)
        tally.excesses.append(0.0)
    return tally


def _median(values: list[float]) -> float:
    return statistics.median(values) if values else float("nan")


def _write(table: dict[str, dict[str, Tally]]) -> None:
    waters = list(next(iter(table.values())))
    lines = [f"| planner | {' | '.join(waters)} |", "|---" * (len(waters) + 1) + "|"]
    lines += [
        f"| {name} | {' | '.join(_cell(by_water[water]) for water in waters)} |"
        for name, by_water in table.items()
    ]
    page = PAGE.read_text(encoding="utf-8")
    head, rest = page.split(_BEGIN)
    text = f"{head}{_BEGIN}\n\n" + "\n".join(lines) + f"\n\n{_END}{rest.split(_END)[1]}"
    PAGE.write_text(text, encoding="utf-8")


def _cell(tally: Tally) -> str:
    runs = len(tally.times_s)
    failed = f", {len(tally.reasons)} of {runs} failed" if tally.reasons else ""
    if not tally.excesses:
        return f"{_time(tally)}{failed}" if runs else "–"
    return f"+{_median(tally.excesses):.2f} %, {_time(tally)}{failed}"


def _time(tally: Tally) -> str:
    return f"{_median(tally.times_s) * 1e3:.3g} ms"
