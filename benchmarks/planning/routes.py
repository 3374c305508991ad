"""Exact routes on real shores: length, wrong answers, clearance and time, against independent oracles.

Oracles: extremitypathfinder on the ponds, brute force (`route_oracle`) on cut-outs of the lakes, shapely's
erosion for what is joined, and the distance to the shore in another projection for the clearance.
"""

import math
import random
import statistics
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path

import numpy as np
import pyproj
import shapely

from benchmarks.measure import Row, alone, spread
from benchmarks.planning import route_oracle as oracle
from companion.core.geo import LatLon, Point
from companion.planning.visibility import NoWay, Route
from companion.planning.water import Shore, Water
from mission_tools.errors import NoRouteError
from mission_tools.maps import Chart, load_geojson
from mission_tools.planning.planner import PlanSettings, plan

SHORE = Path("tests/data/shores")
CLEARANCES_M = (1.0, 4.0, 10.0)
QUERIES = 42  # for each of eight maps and three clearances: 1,008
CUT_OUT_M = 350.0  # half the side of the cut-outs
CUT_OUTS = 6
SAMPLE_M = 0.05
SEED = 20261122
VERTICES = (100, 1_000, 10_000, 20_000, 100_000)


def rows() -> list[Row]:
    """Lakes by clearance, the oracles, the clearance, and time against vertices."""
    found = list(_growth())
    lengths, times = [], []
    for path in sorted(SHORE.glob("*.geojson")):
        chart = load_geojson(path)
        for clearance_m in CLEARANCES_M:
            times.append(_timed(path.stem, chart, clearance_m))
        lengths += _excess(path.stem, chart)
        found.append(_independent_clearance(path.stem, chart))
    every = [ms for asked in times for ms in asked.cold_ms]
    warm = [ms for asked in times for ms in asked.warm_ms]
    found += [asked.row() for asked in times]
    found.append(_spread_row(f"all {len(every)} cold queries", "ms", every))
    found.append(_spread_row(f"all {len(warm)} warm queries", "ms", warm))
    wrong = sum(asked.wrong for asked in times)
    found.append(Row(f"wrong “no way” of {len(every)} queries", "", "less", wrong, 0.0))
    back_m = max(asked.worst_back_m for asked in times)
    found.append(Row("largest difference of there and back", "m", "less", back_m, 0.0))
    found.append(_spread_row(f"excess over brute force, {len(lengths)} routes on cut-outs", "%", lengths))
    found += _against_extremitypathfinder()
    return found


@dataclass
class _Asked:
    """What the queries on one map with one clearance came to."""

    name: str
    vertices: int
    clearance_m: float
    cold_ms: list[float] = field(default_factory=list)
    warm_ms: list[float] = field(default_factory=list)
    wrong: int = 0
    no_way: int = 0
    worst_back_m: float = 0.0

    def row(self) -> Row:
        question = f"{self.name}, {self.vertices:,} vertices, {self.clearance_m:g} m: cold"
        note = (
            f"max {max(self.cold_ms):.0f}; warm {statistics.median(self.warm_ms):.2f}, "
            f"max {max(self.warm_ms):.2f}; no way {self.no_way}, wrong {self.wrong}"
        )
        return alone(question, "ms", "less", self.cold_ms, note)


def _timed(name: str, chart: Chart, clearance_m: float) -> _Asked:
    """Queries from scratch (index, graph and search) and again, half between random places, half coastal."""
    rng = random.Random(SEED)
    shores = oracle.shores_of(chart.navigable)
    asked = _Asked(name, sum(len(shore.corners) for shore in shores), clearance_m)
    joined = list(shapely.get_parts(chart.navigable.buffer(-clearance_m - 1e-3)))
    joined = [part for part in joined if not part.is_empty]
    for part in joined:
        shapely.prepare(part)
    places = _places(rng, chart, clearance_m)
    for _ in range(QUERIES):
        start, goal = next(places), next(places)
        began = time.process_time()
        water = Water(shores)
        route = _asked(water, clearance_m, start, goal)
        cold = time.process_time()
        again = _asked(water, clearance_m, start, goal)
        asked.cold_ms.append(1e3 * (cold - began))
        asked.warm_ms.append(1e3 * (time.process_time() - cold))
        back = _asked(water, clearance_m, goal, start)
        if route is None or back is None or again is None:
            asked.no_way += 1
            ends = [shapely.Point(at.east_m, at.north_m) for at in (start, goal)]
            asked.wrong += any(all(part.contains(end) for end in ends) for part in joined)
        else:
            asked.worst_back_m = max(asked.worst_back_m, abs(route.length_m - back.length_m))
    return asked


def _asked(water: Water, clearance_m: float, start: Point, goal: Point) -> Route | None:
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


def _excess(name: str, chart: Chart) -> list[float]:
    """Percent over brute force on cut-outs, by the same water for both."""
    rng = random.Random(f"{SEED} {name}")
    found: list[float] = []
    for _ in range(CUT_OUTS):
        clearance_m = rng.choice(CLEARANCES_M)
        corner = chart.shores.interpolate(rng.random(), normalized=True)
        window = shapely.box(*(v + s * CUT_OUT_M for s in (-1, 1) for v in (corner.x, corner.y)))
        parts = shapely.get_parts(chart.navigable.intersection(window))
        part = max((p for p in parts if p.geom_type == "Polygon"), key=lambda p: float(p.area))
        if len(shapely.get_coordinates(part)) > 900:
            continue
        ends = oracle.free_points(rng, part, clearance_m, 2)
        route = _asked(Water(oracle.shores_of(part)), clearance_m, *ends) if len(ends) == 2 else None
        shortest_m = oracle.shortest_m(part, clearance_m, *ends) if len(ends) == 2 else math.inf
        if route is not None and math.isfinite(shortest_m):
            found.append(100.0 * (route.length_m / shortest_m - 1.0))
    return found


def _independent_clearance(name: str, chart: Chart) -> Row:
    """The least distance to the shore, of points 0.05 m apart, in an equal-area projection."""
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
    return Row(f"{name}: least clearance, 4 m asked", "m", "more", least_m, 0.0, note=f"{samples:,} samples")


def _against_extremitypathfinder() -> list[Row]:
    if find_spec("extremitypathfinder") is None:
        return [Row("extremitypathfinder is not installed: no peer", "", "less", 0.0, 0.0)]
    from extremitypathfinder import PolygonEnvironment  # noqa: PLC0415  an optional peer

    found: list[Row] = []
    for name in ("pond_citra_fl", "pond_two_islands_nh"):
        chart = load_geojson(SHORE / f"{name}.geojson")
        parts = shapely.get_parts(chart.navigable.buffer(-4.0, quad_segs=16))
        free = shapely.orient_polygons(max(parts, key=lambda part: float(part.area)))
        peer = PolygonEnvironment()
        began = time.process_time()
        peer.store(list(free.exterior.coords[:-1]), [list(ring.coords[:-1]) for ring in free.interiors])
        build_ms = 1e3 * (time.process_time() - began)
        rng = random.Random(SEED)
        ours_ms, peer_ms, excess = [], [], []
        for _ in range(30):
            ends = oracle.free_points(rng, free, 0.01, 2)
            water = Water(oracle.shores_of(chart.navigable))
            began = time.process_time()
            route = water.routes(4.0).route(*ends)
            middle = time.process_time()
            _, length_m = peer.find_shortest_path(*((end.east_m, end.north_m) for end in ends))
            ours_ms.append(1e3 * (middle - began))
            peer_ms.append(1e3 * (time.process_time() - middle))
            excess.append(100.0 * (route.length_m / length_m - 1.0))
        found.append(_spread_row(f"{name}: excess over extremitypathfinder, 30 routes", "%", excess))
        found.append(
            Row(
                f"{name}: a query, ours cold",
                "ms",
                "less",
                statistics.median(ours_ms),
                spread(ours_ms),
                f"extremitypathfinder (after {build_ms:.0f} ms)",
                statistics.median(peer_ms),
                statistics.median(a / b for a, b in zip(ours_ms, peer_ms, strict=True)),
            )
        )
    return found


def _growth() -> Iterator[Row]:
    """Cold queries across jagged lakes of more and more vertices."""
    for vertices in VERTICES:
        rng = random.Random(SEED)
        lake = _jagged(rng, vertices)
        shores = oracle.shores_of(lake)
        ends = oracle.free_points(rng, lake, 4.0, 24)
        took = [_cold_ms(shores, *pair) for pair in pairwise(ends)]
        yield alone(f"a lake of {vertices:,} vertices: cold", "ms", "less", took, f"max {max(took):.0f}")


def _cold_ms(shores: list[Shore], start: Point, goal: Point) -> float:
    began = time.process_time()
    Water(shores).routes(4.0).route(start, goal)
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


def _spread_row(question: str, unit: str, values: list[float]) -> Row:
    return alone(question, unit, "less", values, f"max {max(values):.3g}")
