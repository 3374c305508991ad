"""Time and memory of routes among islands, against the vertices of the map, over four decades.

    python -m benchmarks.planning.archipelago            # drawn archipelagos, and the picture
    python -m benchmarks.planning.archipelago COAST.geojson …

Each map is a process of its own: a hundred routes between random places 4 m clear of every shore, each from
scratch (index, graph and search) and again. Memory is the peak of the process, 97 MB of it libraries.
"""

import json
import random
import resource
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import shapely

from benchmarks.planning import route_oracle as oracle
from companion.planning.visibility import NoWay
from companion.planning.water import Water
from mission_tools.drawing.draw import save_figure
from mission_tools.drawing.style import new_figure, style_panel
from mission_tools.maps import load_geojson

VERTICES = (10, 100, 1_000, 10_000, 100_000)
ROUTES = 100
CLEARANCE_M = 4.0
CELL_M = 800.0  # a piece of sea with an island
SEED = 20261128
PICTURE = Path("docs/pictures/archipelago.png")


def archipelago(vertices: int) -> oracle.Shape:
    """A square of sea with islands from 40 to 360 m, the larger the more corners, one a cell."""
    rng = random.Random(SEED)
    islands: list[shapely.Polygon] = []
    corners, side = 4, max(1, round((vertices / 16) ** 0.5))
    for cell in range(side * side):
        x, y = CELL_M * (cell % side + 0.5), CELL_M * (cell // side + 0.5)
        radius = 40.0 * 9.0 ** rng.random() ** 2
        count = min(max(4, round(radius / 6.0)), vertices - corners)
        if count < 4:
            break
        islands.append(oracle.star(rng, x, y, radius, count, 0.4))
        corners += count
    sea = shapely.box(0.0, 0.0, side * CELL_M, side * CELL_M)
    return shapely.difference(sea, shapely.union_all(islands))


def measured(water: oracle.Shape) -> dict[str, float]:
    """The dearest of the routes, in CPU ms from scratch and again, and the peak of memory."""
    shores = oracle.shores_of(water)
    rng = random.Random(SEED)
    places = oracle.free_points(rng, water, CLEARANCE_M, 2 * ROUTES)
    cold_ms: list[float] = []
    warm_ms: list[float] = []
    for start, goal in zip(places[::2], places[1::2], strict=True):
        for times in (cold_ms, warm_ms):
            began = time.process_time()
            if times is cold_ms:
                sea = Water(shores)
            with suppress(NoWay):
                sea.routes(CLEARANCE_M).route(start, goal)
            times.append(1e3 * (time.process_time() - began))
    return {
        "vertices": sum(len(shore.corners) for shore in shores),
        "rings": len(shores),
        "median_ms": sorted(cold_ms)[len(cold_ms) // 2],
        "cold_ms": max(cold_ms),
        "warm_ms": max(warm_ms),
        "memory_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3,
    }


def in_process(what: str) -> dict[str, Any]:
    """The same of a file, or of a number of vertices, by a process of its own."""
    command = [sys.executable, "-m", "benchmarks.planning.archipelago", "--one", what]
    found = subprocess.run(command, check=True, capture_output=True, text=True)
    return dict(json.loads(found.stdout))


def draw(found: Sequence[dict[str, Any]], path: Path) -> None:
    """Times and memory against vertices."""
    figure = new_figure(9.0, 3.6, dpi=90)
    times, memory = figure.subplots(1, 2)
    vertices = [each["vertices"] for each in found]
    for key, label, colour in (
        ("cold_ms", "dearest, from scratch", "#cf3a2e"),
        ("median_ms", "median, from scratch", "#e8a33d"),
        ("warm_ms", "dearest, again", "#31688e"),
    ):
        times.plot(vertices, [each[key] for each in found], color=colour, marker="o", label=label)
    memory.plot(vertices, [each["memory_mb"] for each in found], color="#31688e", marker="o")
    times.set(xscale="log", yscale="log", xlabel="vertices of the map", ylabel="CPU time of a route, ms")
    memory.set(xscale="log", ylim=(0, None), xlabel="vertices of the map", ylabel="memory of the process, MB")
    for axes in (times, memory):
        style_panel(axes)
    times.legend(fontsize=8)
    save_figure(path, figure)


def main(arguments: Sequence[str]) -> int:
    """A line a map."""
    if arguments[:1] == ["--one"]:
        what = arguments[1]
        water = archipelago(int(what)) if what.isdecimal() else load_geojson(Path(what)).navigable
        sys.stdout.write(json.dumps(measured(water)))
        return 0
    found = []
    for what in arguments or map(str, VERTICES):
        found.append(in_process(what))
        figures = " ".join(f"{key} {value:,.6g}" for key, value in found[-1].items())
        sys.stdout.write(f"{Path(what).stem}: {figures}\n")
    if not arguments:
        draw(found, PICTURE)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
