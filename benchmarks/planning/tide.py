"""Routes in currents that change with time, against a time-expanded search of its own (time_expanded.py).

    python -m benchmarks.planning.tide            # ten cases, a table
    python -m benchmarks.planning.tide NAME …     # some of them; a number draws a case from that seed

Ours and the oracle's time from departure to arrival, waits included. Ours is what the oracle's own boat takes
for our route.
"""

import math
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely
import shapely.affinity

from benchmarks.planning.time_expanded import Array, Flow, Sailor, earliest, sailed_s
from companion.core.geo import LatLon, LocalFrame, Point
from mission_tools.costs.cheapest import CheapestRoute, cheapest_route
from mission_tools.costs.departure import KnownTimes
from mission_tools.costs.travel import BoatSpeed, TravelTime
from mission_tools.maps import Chart, build_chart, load_geojson
from mission_tools.maps.chart import Feature
from mission_tools.planning.planner import PlanSettings, plan

SHORE = Path("tests/data/shores")
CLEARANCE_M = 4.0
CELLS = 140  # of the oracle, along the way
LAYERS = 160  # of the oracle, in the time of ours


_ALWAYS = KnownTimes()


@dataclass(frozen=True)
class Water:
    """A flow as the planner asks for one."""

    flow: Flow
    times: KnownTimes = _ALWAYS

    def at(self, north_m: Array, east_m: Array, time_s: Array) -> tuple[Array, Array]:
        """As `mission_tools.costs.current.Current`."""
        north, east, when = np.broadcast_arrays(north_m, east_m, time_s)
        return self.flow(north, east, when)


@dataclass(frozen=True)
class Case:
    """A voyage; places are (north, east) in metres."""

    name: str
    what: str
    chart: Chart
    start: tuple[float, float]
    goal: tuple[float, float]
    sailor: Sailor
    flow: Flow
    depart_s: float = 0.0

    def ours(self) -> CheapestRoute:
        """The planner's."""
        settings = PlanSettings(clearance_m=CLEARANCE_M, margin_m=0.0)
        direct = plan(self.chart, Point(*self.start), Point(*self.goal), settings).points
        speed = BoatSpeed(self.sailor.asked, self.sailor.top, self.sailor.steerage)
        travel = TravelTime(speed, Water(self.flow))
        return cheapest_route(self.chart, direct, CLEARANCE_M, travel, self.depart_s)

    def oracle_s(self, expected_s: float, cells: int = CELLS) -> float:
        """How long the oracle takes."""
        away = math.dist(self.start, self.goal)
        (low_n, high_n), (low_e, high_e) = (sorted(pair) for pair in zip(self.start, self.goal, strict=True))
        reach = 0.4 * away
        ends = shapely.box(low_e - reach, low_n - reach, high_e + reach, high_n + reach)
        land = shapely.buffer(self.chart.shores, CLEARANCE_M - 0.01, quad_segs=16)
        if not self.chart.is_open:
            land = shapely.union(land, shapely.difference(ends, self.chart.navigable))
            ends = shapely.intersection(ends, shapely.box(*self.chart.navigable.bounds))
        west, south, east, north = ends.bounds
        arrival_s = earliest(
            land, (south, west, north, east), self.start, self.goal, self.sailor, self.flow,
            cell=away / cells, layer_s=expected_s / LAYERS, depart_s=self.depart_s, layers=2 * LAYERS,
        )  # fmt: skip
        return arrival_s - self.depart_s


def swinging(speed: float, to_deg: float, period_s: float, strongest_s: float = 0.0) -> Flow:
    """The same everywhere, to and fro."""
    north, east = speed * math.cos(math.radians(to_deg)), speed * math.sin(math.radians(to_deg))

    def flow(north_m: Array, east_m: Array, time_s: Array) -> tuple[Array, Array]:
        now = np.cos(2.0 * math.pi * (time_s - strongest_s) / period_s) + 0.0 * (north_m + east_m)
        return north * now, east * now

    return flow


def eddy(speed: float, radius_m: float, period_s: float, at: Callable[[Array], tuple[Array, Array]]) -> Flow:
    """A round eddy whose sense swings, and whose middle may move."""

    def flow(north_m: Array, east_m: Array, time_s: Array) -> tuple[Array, Array]:
        middle_n, middle_e = at(time_s)
        n, e = north_m - middle_n, east_m - middle_e
        per_m = speed / radius_m * np.exp(0.5 - 0.5 * (n * n + e * e) / radius_m**2)
        per_m = per_m * np.cos(2.0 * math.pi * time_s / period_s)
        return -e * per_m, n * per_m

    return flow


def _jet(speed: float, middle_e: float, width_m: float, period_s: float) -> Flow:
    """A stream to the south and back that is strong only near one meridian."""

    def flow(north_m: Array, east_m: Array, time_s: Array) -> tuple[Array, Array]:
        now = np.cos(2.0 * math.pi * time_s / period_s) + 0.0 * north_m
        return -speed * np.exp(-(((east_m - middle_e) / width_m) ** 2)) * now, 0.0 * now

    return flow


def _strait(speed: float, period_s: float, strongest_s: float, length_m: float = 300.0) -> Flow:
    """Along east, strong between walls round the origin, by the walls' shape."""

    def flow(north_m: Array, east_m: Array, time_s: Array) -> tuple[Array, Array]:
        now = np.cos(2.0 * math.pi * (time_s - strongest_s) / period_s)
        along = speed * np.exp(-((east_m / length_m) ** 2)) * now * np.exp(-((north_m / 600.0) ** 2))
        return 0.0 * along, along

    return flow


def _gates(speed: float, period_s: float) -> Flow:
    """Two straits 2,500 m apart, the second of which is closed while the first is open."""
    first, second = _strait(speed, period_s, 1200.0), _strait(speed, period_s, 1200.0 + 0.3 * period_s)

    def flow(north_m: Array, east_m: Array, time_s: Array) -> tuple[Array, Array]:
        there, here = first(north_m, east_m - 2500.0, time_s), second(north_m, east_m, time_s)
        return there[0] + here[0], there[1] + here[1]

    return flow


def _ebb(flood: float, mean: float, width_m: float, period_s: float) -> Flow:
    """A river of parabolic profile along east, whose stream a tide changes."""

    def flow(north_m: Array, east_m: Array, time_s: Array) -> tuple[Array, Array]:
        profile = np.clip(1.0 - (2.0 * north_m / width_m) ** 2, 0.0, None)
        along = profile * (mean + flood * np.cos(2.0 * math.pi * (time_s - 2e-4 * east_m) / period_s))
        return 0.0 * along, along + 0.0 * east_m

    return flow


FRAME = LocalFrame(LatLon(50.0, -1.2))


def _channel(east: float, *islands: shapely.Geometry) -> Chart:
    features = [Feature(f"wall {number}", "island", shape) for number, shape in enumerate(islands, 1)]
    return build_chart("channel", FRAME, shapely.box(-1500, -950, east, 950), features)


def _ends(chart: Chart) -> tuple[tuple[float, float], tuple[float, float]]:
    """Two places far apart with room round them."""
    corners = shapely.get_coordinates(max(shapely.get_parts(chart.navigable.buffer(-20.0)), key=shapely.area))
    south, north = corners[np.argmin(corners.sum(axis=1))], corners[np.argmax(corners.sum(axis=1))]
    return (float(north[1]), float(north[0])), (float(south[1]), float(south[0]))


def cases() -> dict[str, Case]:
    """All of them, by name."""
    south, north = shapely.box(-60, -900, 60, -25), shapely.box(-60, 25, 60, 900)
    second = [shapely.affinity.translate(wall, 2500.0) for wall in (south, north)]
    strait = _channel(1500, south, north)
    open_end = _channel(1500, south, shapely.box(-60, 25, 60, 450))
    gates = _channel(4000, south, north, *second)
    river = build_chart("river", FRAME, shapely.box(-1600, -120, 1600, 120), ())
    pond = load_geojson(SHORE / "pond_two_islands_nh.geojson")
    harbour = load_geojson(SHORE / "harbour_san_juan_pr.geojson")
    sea = build_chart("sea", FRAME, None, ())
    boat, slow, weak = Sailor(1.5, 1.8), Sailor(1.0, 1.2), Sailor(0.8, 1.0)
    still = eddy(0.9, 500, 3000, lambda t: (0.0 * t + 900.0, 0.0 * t))
    wandering = eddy(1, 350, 20000, lambda t: (400.0 + 0.25 * t, 200.0 - 0.1 * t))
    chosen = [
        Case("ferry", "a tide across that turns", sea, (0, 0), (4000, 0), boat, swinging(1.3, 90, 5400)),
        Case("turn", "a tide on the bow that turns", sea, (0, 0), (2500, 900), slow, swinging(1, 200, 9000)),
        Case("gyre", "a gyre whose sense turns", sea, (0, 0), (1800, 0), slow, still),
        Case("eddy", "an eddy that wanders", sea, (0, 0), (2000, 300), slow, wandering),
        Case("jet", "a jet from ahead, then none", sea, (0, 0), (3000, 0), slow, _jet(1.0, 0, 250, 4000)),
        Case(
            "strait", "a strait to be waited for", strait, (0, 700), (0, -1200), slow, _strait(2, 9000, 1500)
        ),
        Case("round", "wait, or sail round", open_end, (0, 1200), (0, -1200), slow, _strait(1.6, 12000, 900)),
        Case("gates", "two straits in turn", gates, (0, 3700), (0, -1200), slow, _gates(1.9, 9000)),
        Case("river", "up a river in its ebb", river, (0, 1500), (0, -1500), slow, _ebb(0.8, 0.3, 240, 8000)),
        Case("pond", "two islands, a tide", pond, *_ends(pond), weak, swinging(0.7, 60, 900)),
        Case("harbour", "a harbour's tide", harbour, *_ends(harbour), boat, swinging(1.2, 150, 6000, 700)),
    ]
    return {case.name: case for case in chosen}


def drawn(seed: int) -> Case:
    """Four islands, two eddies that swing and wander, and a tide, all at random."""
    rng = np.random.default_rng(seed)
    islands = [
        Feature(
            f"island {number}", "island", shapely.Point(*at).buffer(rng.uniform(60.0, 220.0), quad_segs=3)
        )
        for number, at in enumerate(rng.uniform((400.0, -500.0), (1600.0, 500.0), (4, 2)), 1)
    ]
    tide = swinging(rng.uniform(0.2, 0.9), rng.uniform(0, 360), rng.uniform(3e3, 12e3), rng.uniform(0, 6e3))
    eddies = [
        eddy(rng.uniform(0.3, 0.9), rng.uniform(200, 500), rng.uniform(3e3, 9e3), _drifting(rng))
        for _ in range(2)
    ]

    def flow(north_m: Array, east_m: Array, time_s: Array) -> tuple[Array, Array]:
        parts = [part(north_m, east_m, time_s) for part in (tide, *eddies)]
        zero = np.zeros(1)
        return sum((part[0] for part in parts), zero), sum((part[1] for part in parts), zero)

    chart = build_chart("sea", FRAME, None, islands)
    sailor = Sailor(asked := rng.uniform(0.8, 1.5), asked * rng.uniform(1.05, 1.4))
    return Case(str(seed), f"drawn, seed {seed}", chart, (0.0, -100.0), (100.0, 2100.0), sailor, flow)


def _drifting(rng: np.random.Generator) -> Callable[[Array], tuple[Array, Array]]:
    (north_m, east_m), (north_m_s, east_m_s) = (
        rng.uniform((-500, 300), (500, 1700)),
        rng.uniform(-0.2, 0.2, 2),
    )
    return lambda time_s: (north_m + north_m_s * time_s, east_m + east_m_s * time_s)


def main(names: list[str]) -> int:
    """Run them; prints a line each."""
    chosen = cases()
    for name in names or chosen:
        case = chosen[name] if name in chosen else drawn(int(name))
        began = time.process_time()
        found = case.ours()
        took_s = time.process_time() - began
        leave_s = case.depart_s + found.wait_s
        ours_s = sailed_s(found.points, case.sailor, case.flow, leave_s) - case.depart_s
        oracle_s = case.oracle_s(ours_s)
        waits = found.wait_s
        sys.stdout.write(
            f"| {case.what} | {ours_s:.0f} s | {oracle_s:.0f} s | {100 * ours_s / oracle_s - 100:+.2f} % | "
            f"{waits:.0f} s | {found.shortest_cost:.0f} s | {len(found.points) - 1} | {took_s:.1f} s |\n"
        )
        sys.stdout.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
