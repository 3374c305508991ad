"""How do the planners of the related work compare with the exact route, on ponds, a pool and a grid?

Thirty queries a map between random places, at least a third of its diagonal apart, the same for all, each
with a seed of its own and with a quarter, all and four times a planner's usual work. A path that does not
keep the clearance is a failure. It takes a quarter of an hour; out/peers.md gets the table.
"""

import math
import random
import statistics
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path

from matplotlib.axes import Axes

from benchmarks.measure import Row, write
from benchmarks.measure import table as markdown
from benchmarks.peers import PEERS
from benchmarks.peers.interface import Failed, Sea, plan
from benchmarks.planning import route_oracle as oracle
from companion.core.geo import Point, distance_m
from companion.planning.visibility import NoWay
from mission_tools.drawing.draw import save_figure
from mission_tools.drawing.style import new_figure, style_axes
from mission_tools.maps import load_geojson, load_source
from mission_tools.maps.formats.grid_map import load_grid_map
from mission_tools.planning.exact_planner import water_of

DATA = Path("tests/data")
SEED = 20261128
QUERIES = 30
EFFORTS = (0.25, 1.0, 4.0)
BUDGET_S = 5.0
EXACT = "exact (ours)"
POND = "mill pond"
PICTURE = Path("docs/pictures/peers.png")
COLOURS = {"Dijkstra": "#8d6e4f", "Theta*": "#2e7d6b", "PRM": "#7b5aa6", "RRT*": "#c2413b", "ACO": "#c78a1b"}

Query = tuple[Point, Point]


@dataclass
class Tally:
    """What one planner did on one kind of water: excess over the exact length in %, CPU ms, failures."""

    excesses: list[float] = field(default_factory=list)
    times_ms: list[float] = field(default_factory=list)
    failures: int = 0

    def __str__(self) -> str:
        said = ["+{1:.2f} % ({0:.2f}–{2:.2f})".format(*quartiles(self.excesses))] if self.excesses else []
        low, middle, high = (f"{ms:.3g}" if ms < 1000.0 else f"{ms:,.0f}" for ms in quartiles(self.times_ms))
        said.append(f"{middle} ms ({low}–{high})")
        if self.failures:
            said.append(f"{self.failures} of {len(self.times_ms)} failed")
        return ", ".join(said)


def quartiles(values: Sequence[float]) -> list[float]:
    """The quarter, the half and the three quarters of them."""
    return statistics.quantiles(values, n=4, method="inclusive") if len(values) > 1 else [*values] * 3


def rows() -> list[Row]:
    """A row a planner that finds a way on the mill pond, with its usual work."""
    names = [name for name in PEERS if name != "RRT*" or find_spec("ompl") is not None]
    waters = _waters()
    exact = {water: _exact_tally(*asked) for water, asked in waters.items()}
    peers = {
        water: {name: [_tally(name, *asked, effort) for effort in EFFORTS] for name in names}
        for water, asked in waters.items()
    }
    usual = EFFORTS.index(1.0)
    cells = [(name, *(str(peers[water][name][usual]) for water in waters)) for name in names]
    write("peers", markdown(("planner", *waters), [*cells, (EXACT, *map(str, exact.values()))]))
    draw(exact, peers, PICTURE)
    _, ours_ms, _ = quartiles(exact[POND].times_ms)
    on_pond = {name: peers[POND][name][usual] for name in names}
    return [
        Row(
            "CPU time of a route on the mill pond", "ms", ours_ms, 0.0,
            name.replace("*", r"\*"), (theirs_ms := statistics.median(tally.times_ms)), ours_ms / theirs_ms,
            f"{statistics.median(tally.excesses):.2f} % longer",
        )
        for name, tally in on_pond.items() if tally.excesses
    ]  # fmt: skip


def draw(exact: dict[str, Tally], peers: dict[str, dict[str, list[Tally]]], path: Path) -> None:
    """A panel a map: excess length against CPU time, a line a planner from little work to much."""
    figure = new_figure(11.0, 8.0)
    for number, (water, by_name) in enumerate(peers.items(), 1):
        panel = figure.add_subplot(2, 2, number)
        low_ms, middle_ms, high_ms = quartiles(exact[water].times_ms)
        panel.axvspan(low_ms, high_ms, color="#12395b", alpha=0.25, linewidth=0)
        panel.axvline(middle_ms, color="#12395b", linewidth=2.0, label="exact: no excess")
        for name, tallies in by_name.items():
            _draw_planner(panel, name, [one for one in tallies if one.excesses])
        panel.set_xscale("log")
        panel.set_yscale("symlog", linthresh=0.1)
        panel.set_ylim(0.0, 100.0)
        panel.xaxis.set_major_formatter("{x:g}")
        panel.yaxis.set_major_formatter("{x:g}")
        panel.set_title(water, fontsize=10, loc="left")
        panel.set_xlabel("CPU time of a query, ms", fontsize=9)
        panel.set_ylabel("longer than the shortest, %", fontsize=9)
        panel.tick_params(labelsize=8.5)
        style_axes(panel)
    names = panel.get_legend_handles_labels()
    figure.legend(*names, loc="outside upper right", ncols=6, fontsize=9, frameon=False)
    save_figure(path, figure)


def _draw_planner(panel: Axes, name: str, tallies: Sequence[Tally]) -> None:
    """Medians with their quartiles; hollow where queries fail."""
    if not tallies:
        return
    times = [quartiles(one.times_ms) for one in tallies]
    excesses = [quartiles(one.excesses) for one in tallies]
    middles = [m for _, m, _ in times], [m for _, m, _ in excesses]
    panel.errorbar(
        *middles,
        xerr=[[m - a for a, m, _ in times], [b - m for _, m, b in times]],
        yerr=[[m - a for a, m, _ in excesses], [b - m for _, m, b in excesses]],
        marker="o",
        markersize=4,
        linewidth=1.2,
        elinewidth=0.7,
        color=COLOURS[name],
        label=name,
    )
    failing = [n for n, one in enumerate(tallies) if one.failures]
    panel.plot(*([axis[n] for n in failing] for axis in middles), "o", markersize=3, color="white", zorder=5)


def _waters() -> dict[str, tuple[Sea, list[Query]]]:
    """Each map with its clearance in metres, in which one cell of the grid is passable, and its queries."""
    charts = {
        "pool": (load_source("pool").chart, 0.08),
        POND: (load_source("lake").chart, 4.0),
        "pond with two islands": (load_geojson(DATA / "shores/pond_two_islands_nh.geojson"), 4.0),
        "arena2": (load_grid_map(DATA / "grids/arena2.map"), 0.25),
    }
    seas = {name: Sea(*chart) for name, chart in charts.items()}
    return {name: (sea, _queries(sea)) for name, sea in seas.items()}


def _queries(sea: Sea) -> list[Query]:
    """Between random places, far from each other, that a route joins."""
    rng = random.Random(SEED)
    west, south, east, north = sea.bounds
    found: list[Query] = []
    while len(found) < QUERIES:
        start, goal = oracle.free_points(rng, sea.chart.navigable, sea.clearance_m, 2)
        is_far = distance_m(start, goal) > math.hypot(east - west, north - south) / 3.0
        if is_far and _is_joined(sea, (start, goal)):
            found.append((start, goal))
    return found


def _is_joined(sea: Sea, query: Query) -> bool:
    try:
        sea.water.routes(sea.clearance_m).route(*query)
    except NoWay:
        return False
    return True


def _tally(name: str, sea: Sea, queries: list[Query], effort: float) -> Tally:
    tally = Tally()
    for seed, (start, goal) in enumerate(queries):
        exact_m = sea.water.routes(sea.clearance_m).route(start, goal).length_m
        found = plan(PEERS[name], sea, start, goal, seed, BUDGET_S, effort)
        tally.times_ms.append(1e3 * found.cpu_s)
        if isinstance(found, Failed):
            tally.failures += 1
        else:
            tally.excesses.append(100.0 * (found.length_m / exact_m - 1.0))
    return tally


def _exact_tally(sea: Sea, queries: list[Query]) -> Tally:
    tally = Tally([0.0, 0.0])
    for start, goal in queries:
        began_s = time.thread_time()
        water_of.__wrapped__(sea.chart).routes(sea.clearance_m).route(start, goal)  # without what is kept
        tally.times_ms.append(1e3 * (time.thread_time() - began_s))
    return tally
