"""Exact routes on real shores: length, wrong answers, clearance and time, against independent oracles.

Oracles: extremitypathfinder on the ponds, shapely's erosion for what is joined, and the distance to the shore
in another projection for the clearance. The picture has the time against the vertices of a lake, beside A* on
the planner's own grid.
"""

import math
import random
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path

import numpy as np
import pyproj
import shapely

from benchmarks.measure import Row, alone, of_pairs
from benchmarks.planning import route_oracle as oracle
from companion.core.geo import LatLon, LocalFrame, Point
from companion.planning.visibility import NoWay, Route
from companion.planning.water import Water
from mission_tools.drawing.draw import save_figure
from mission_tools.drawing.style import new_figure, style_panel
from mission_tools.errors import NoRouteError
from mission_tools.maps import Chart, build_chart, load_geojson
from mission_tools.planning.planner import PlanSettings, plan

SHORE = Path("tests/data/shores")
PICTURE = Path("docs/pictures/route_times.png")
CLEARANCES_M = (1.0, 4.0, 10.0)
QUERIES = 42  # for each map and clearance
SAMPLE_M = 0.05
SEED = 20261122
VERTICES = (100, 300, 1_000, 3_000, 10_000, 30_000)
GRID_CELL_M = 20.0


def rows() -> list[Row]:
    """Times and answers on all maps, and the oracles' verdicts; draws the picture."""
    least_m, samples, asked = math.inf, 0, _Asked()
    maps = sorted(SHORE.glob("*.geojson"))
    for path in maps:
        chart = load_geojson(path)
        for clearance_m in CLEARANCES_M:
            _ask(asked, chart, clearance_m)
        near_m, count = _independent_clearance(chart)
        least_m, samples = min(least_m, near_m), samples + count
    draw(_growth(), PICTURE)
    count = len(asked.cold_ms)
    return [
        *_against_extremitypathfinder(),
        alone("a first query", "ms", asked.cold_ms, f"{count} on {len(maps)}; max {max(asked.cold_ms):.0f}"),
        alone("the same query again", "ms", asked.warm_ms, f"max {max(asked.warm_ms):.2f}"),
        Row("wrongly called “no way”", "queries", asked.wrong),
        Row("least clearance, 4 m asked", "m", least_m, note=f"{samples:,} samples in another projection"),
    ]


@dataclass
class _Asked:
    """What all queries came to."""

    cold_ms: list[float] = field(default_factory=list)
    warm_ms: list[float] = field(default_factory=list)
    wrong: int = 0


def _ask(asked: _Asked, chart: Chart, clearance_m: float) -> None:
    """Queries from scratch (index, graph and search) and again, half between random places, half coastal."""
    rng = random.Random(SEED)
    shores = oracle.shores_of(chart.navigable)
    joined = list(shapely.get_parts(chart.navigable.buffer(-clearance_m - 1e-3)))
    joined = [part for part in joined if not part.is_empty]
    for part in joined:
        shapely.prepare(part)
    places = _places(rng, chart, clearance_m)
    for _ in range(QUERIES):
        start, goal = next(places), next(places)
        began = time.process_time()
        water = Water(shores)
        route = _route(water, clearance_m, start, goal)
        cold = time.process_time()
        again = _route(water, clearance_m, start, goal)
        asked.cold_ms.append(1e3 * (cold - began))
        asked.warm_ms.append(1e3 * (time.process_time() - cold))
        if route is None or again is None:
            ends = [shapely.Point(at.east_m, at.north_m) for at in (start, goal)]
            asked.wrong += any(all(part.contains(end) for end in ends) for part in joined)


def _route(water: Water, clearance_m: float, start: Point, goal: Point) -> Route | None:
    try:
        return water.routes(clearance_m).route(start, goal)
    except NoWay:
        return None


def _places(rng: random.Random, chart: Chart, clearance_m: float) -> Iterator[Point]:
    """Two random places, then two along the shore, and so on."""
    coast = chart.navigable.buffer(-clearance_m - 0.8).boundary
    while True:
        yield from oracle.free_points(rng, chart.navigable, clearance_m, 2)
        for _ in range(2):
            at = coast.interpolate(rng.random(), normalized=True)
            yield Point(at.y, at.x)


def _independent_clearance(chart: Chart) -> tuple[float, int]:
    """The least distance to the shore in an equal-area projection, of points 0.05 m apart; their number."""
    rng = random.Random(SEED)
    clearance_m = 4.0
    shores = oracle.shores_of(chart.navigable)
    least_m, samples = math.inf, 0
    for _ in range(3):
        start, goal = oracle.free_points(rng, chart.navigable, clearance_m, 2)
        try:
            route = plan(chart, start, goal, PlanSettings(clearance_m))
        except NoRouteError:
            continue
        origin = chart.frame.to_global(start)
        laea = pyproj.Proj(proj="laea", lat_0=origin.lat_deg, lon_0=origin.lon_deg, ellps="WGS84")

        def project(points: list[LatLon], laea: pyproj.Proj = laea) -> list[tuple[float, float]]:
            east, north = laea([p.lon_deg for p in points], [p.lat_deg for p in points])
            return list(zip(east, north, strict=True))

        saved = [chart.frame.to_global(point) for point in route.points]
        saved = [LatLon(round(at.lat_deg, 7), round(at.lon_deg, 7)) for at in saved]
        rings = [project([chart.frame.to_global(c) for c in shore.corners]) for shore in shores]
        edges = [shapely.LineString(pair) for ring in rings for pair in pairwise([*ring, ring[0]])]
        line = shapely.LineString(project(saved))
        count = max(2, int(line.length / SAMPLE_M))
        points = shapely.line_interpolate_point(line, np.linspace(0.0, line.length, count))
        _, distances = shapely.STRtree(edges).query_nearest(points, return_distance=True)
        least_m, samples = min(least_m, float(distances.min())), samples + count
    return least_m, samples


def _against_extremitypathfinder() -> Iterator[Row]:
    if find_spec("extremitypathfinder") is None:
        return
    from extremitypathfinder import PolygonEnvironment  # noqa: PLC0415  an optional peer

    for name in ("pond_citra_fl", "pond_two_islands_nh"):
        chart = load_geojson(SHORE / f"{name}.geojson")
        parts = shapely.get_parts(chart.navigable.buffer(-4.0, quad_segs=16))
        free = shapely.orient_polygons(max(parts, key=lambda part: float(part.area)))
        shores = oracle.shores_of(chart.navigable)
        peer = PolygonEnvironment()
        holes = [list(ring.coords[:-1]) for ring in free.interiors]
        build_ms = _ms(partial(peer.store, list(free.exterior.coords[:-1]), holes))
        rng = random.Random(SEED)
        pairs, excess = [], []
        for _ in range(30):
            ends = oracle.free_points(rng, free, 0.01, 2)
            began = time.process_time()
            route = Water(shores).routes(4.0).route(*ends)
            middle = time.process_time()
            _, length_m = peer.find_shortest_path(*((end.east_m, end.north_m) for end in ends))
            pairs.append((1e3 * (middle - began), 1e3 * (time.process_time() - middle)))
            excess.append(100.0 * (route.length_m / length_m - 1.0))
        vertices = sum(len(shore.corners) for shore in shores)
        yield of_pairs(
            f"CPU time of a query on a pond of {vertices} vertices, index included",
            "ms",
            pairs,
            "extremitypathfinder",
            f"after {build_ms / 1e3:.1f} s; lengths differ by {max(map(abs, excess)):.3f} %",
        )


def _growth() -> dict[str, list[tuple[int, list[float]]]]:
    """CPU ms of queries across jagged lakes, by planner and number of vertices: from scratch, on a grid."""
    found: dict[str, list[tuple[int, list[float]]]] = {"exact": [], f"A* on cells of {GRID_CELL_M:g} m": []}
    settings = PlanSettings(4.0), PlanSettings(4.0, cell_m=GRID_CELL_M)
    for vertices in VERTICES:
        rng = random.Random(SEED)
        lake = _jagged(rng, vertices)
        ends = [*pairwise(oracle.free_points(rng, lake, 40.0, 7))]
        for times, setting in zip(found.values(), settings, strict=True):
            took = []
            for start, goal in ends:
                chart = build_chart("lake", LocalFrame(LatLon(50.0, 0.0)), lake, ())
                took.append(_ms(partial(plan, chart, start, goal, setting)))
            times.append((vertices, took))
    return found


def draw(found: dict[str, list[tuple[int, list[float]]]], path: Path) -> None:
    """Medians, and bands from the fastest query to the slowest."""
    figure = new_figure(7.0, 3.8, dpi=90)
    axes = figure.subplots()
    for (name, times), colour in zip(found.items(), ("#cf3a2e", "#31688e"), strict=True):
        vertices, took = zip(*times, strict=True)
        axes.fill_between(
            vertices, [*map(min, took)], [*map(max, took)], color=colour, alpha=0.2, linewidth=0
        )
        axes.plot(vertices, [float(np.median(each)) for each in took], color=colour, marker="o", label=name)
    axes.set(xscale="log", yscale="log", xlabel="vertices of the lake", ylabel="CPU time of a plan, ms")
    style_panel(axes)
    save_figure(path, figure)


def _ms(work: Callable[[], object]) -> float:
    """CPU time of one call."""
    began = time.process_time()
    work()
    return 1e3 * (time.process_time() - began)


def _jagged(rng: random.Random, vertices: int) -> shapely.Polygon:
    """A lake of 6 km with bays of all sizes."""
    waves = [(k, rng.gauss(0, 1) / k**1.1, rng.uniform(0, 2 * math.pi)) for k in range(2, 400)]
    turn = np.linspace(0.0, 2 * math.pi, vertices, endpoint=False)
    radius = 1.0 + 0.125 * sum(a * np.cos(k * turn + p) for k, a, p in waves)
    radius = 3000.0 * np.maximum(radius, 0.15)
    lake = shapely.Polygon(np.column_stack([radius * np.cos(turn), radius * np.sin(turn)]))
    for _ in range(20):
        x, y = rng.uniform(-1500, 1500), rng.uniform(-1500, 1500)
        lake -= oracle.star(rng, x, y, rng.uniform(30, 120), max(6, vertices // 200), 0.2)
    return max(shapely.get_parts(lake), key=lambda part: float(part.area))
