"""The whole job as two programs that meet only over MAVLink: `make demo`.

Starts `boat-sitl serve` on a map, lets `mission-upload` plan, upload, read back, start and follow a mission,
then compares what the boat really did with the plan: a table, and out/demo.png.

    make demo
    make demo MAP=pond.geojson START=29.4102,-82.1712 GOAL=29.4110,-82.1705

Without START and GOAL a map's two ends are found that lie far apart, but not too far for a demonstration.
"""

import signal

signal.signal(signal.SIGINT, signal.SIG_DFL)  # the imports take a second: until then Ctrl-C ends at once

import argparse
import contextlib
import csv
import json
import subprocess
import sys
import threading
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from rich.console import Console
from rich.table import Table

from companion.core.geo import LatLon, Point, distance_m, path_length_m
from mission_tools.cli.arguments import position
from mission_tools.drawing.draw import draw_picture, save_figure
from mission_tools.errors import MissionToolsError
from mission_tools.maps import Chart, Source, load_source
from mission_tools.planning.planner import PlanSettings

CRUISE_M_S = 2.0
SAIL_S = 18.0  # wall-clock seconds that the voyage is to take
PATIENCE_S = 80.0  # for first heartbeat and position: the usual ten at eight times the machine's load
FASTEST = 120.0  # times real time; what an emulated boat keeps up with on a small machine
FARTHEST_M = 700.0
KEEPS_WITHIN_M = 0.5  # how far inside the clearance the boat may stray where there is no room for a margin
RECEIVER = "sensors.gnss.receiver=rtk"  # the kit's receiver wanders by metres, which would hide plan and PID
REACHED_M = 2.5  # a waypoint passed nearer than this, in truth, was reached: the boat's radius and its GNSS
PASSING_M = 40.0  # an obstacle nearer than this to the track was sailed past
DRAWN_POINTS = 3000


def main() -> int:
    """Run the demonstration; 0 when the boat reached every waypoint and kept its distance."""
    arguments = _arguments()
    console = Console(highlight=False)
    try:
        source = load_source(arguments.map)
        clearance_m = PlanSettings.from_route(source.route, clearance_m=arguments.clearance).clearance_m
        start, goal = _ends(source, arguments.start, arguments.goal, clearance_m)
    except MissionToolsError as error:
        sys.stderr.write(f"demo: {error}\n")
        return error.exit_code
    out: Path = arguments.out
    out.mkdir(parents=True, exist_ok=True)
    frame = source.chart.frame
    straight_m = distance_m(start, goal)
    speedup = min(max(1.5 * straight_m / CRUISE_M_S / SAIL_S, 1.0), FASTEST)
    ends = [frame.to_global(start), frame.to_global(goal)]
    console.print(f"1  boat-sitl serve {arguments.map} --set {RECEIVER} --speedup {speedup:.0f}")
    with _emulator(arguments.map, ends[0], speedup, out / "track.csv", console) as url:
        console.print(f"2  mission-upload {arguments.map} --connect {url} --start --follow")
        report = _upload(arguments.map, ends, clearance_m, url, out / "demo.plan")
    if report is None:
        return 1
    waypoints = [frame.to_local(LatLon(*place)) for place in report["waypoints"]]
    track = _read_track(out / "track.csv", waypoints[-1])
    route = [start, *waypoints]
    figures = _figures(source.chart, route, track, report, clearance_m)
    _print_table(figures, console)
    _draw(source.chart, route, track, figures, out / "demo.png")
    console.print(f"picture: {out / 'demo.png'}   plan: {out / 'demo.plan'}   truth: {out / 'track.csv'}")
    return 0 if figures["ok"] else 1


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="demo", description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--map", default="lake", help="scenario, .toml or .geojson")
    parser.add_argument("--start", type=str, default=None, metavar="LAT,LON")
    parser.add_argument("--goal", type=str, default=None, metavar="LAT,LON")
    parser.add_argument("--clearance", type=float, default=None, metavar="M")
    parser.add_argument("--out", type=Path, default=Path("out"))
    return parser.parse_args()


def _ends(source: Source, start: str | None, goal: str | None, clearance_m: float) -> tuple[Point, Point]:
    """Where to sail from and to: as asked, else as the scenario says, else far apart on the map."""
    to_local = source.chart.frame.to_local
    given = [position(name, text) for name, text in (("START", start), ("GOAL", goal))]
    defaults = [source.route.start, source.route.goal]
    ends = [to_local(place) if place else default for place, default in zip(given, defaults, strict=True)]
    if ends[0] is None or ends[1] is None:
        found = _far_apart(source.chart, clearance_m, ends[0] or ends[1])
        ends = [ends[0] or found[0], ends[1] or found[1]]
    assert ends[0] is not None  # noqa: S101  both are set now
    assert ends[1] is not None  # noqa: S101
    return ends[0], ends[1]


def _far_apart(chart: Chart, clearance_m: float, fixed: Point | None) -> tuple[Point, Point]:
    """Two places on one piece of water with room around them, at most FARTHEST_M apart."""
    room = chart.navigable.buffer(-2.0 * clearance_m)
    largest = max(shapely.get_parts(room), key=lambda part: part.area)
    places = shapely.get_coordinates(largest.exterior.simplify(clearance_m))
    origin = np.array([fixed.east_m, fixed.north_m]) if fixed else places[np.argmin(places[:, 1])]
    gaps = np.hypot(*(places - origin).T)
    goal = places[np.argmax(np.where(gaps <= FARTHEST_M, gaps, -1.0))]
    return Point(float(origin[1]), float(origin[0])), Point(float(goal[1]), float(goal[0]))


@contextlib.contextmanager
def _emulator(source: str, start: LatLon, speedup: float, track: Path, console: Console) -> Iterator[str]:
    """A boat-sitl process on a port of the system's choice; its url."""
    command = [_program("boat-sitl"), "serve", source, f"--start={start.lat_deg:.7f},{start.lon_deg:.7f}"]
    command += ["--set", RECEIVER, "--speedup", f"{speedup:.1f}", "--csv", str(track)]
    command += ["--tcp", "0", "--no-udp", "--state", "none"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)  # noqa: S603
    try:
        assert process.stdout is not None  # noqa: S101  asked for above
        first = process.stdout.readline()
        if "tcpin:" not in first:
            raise SystemExit(process.wait() or 1)
        threading.Thread(target=_forward, args=(process.stdout, console), daemon=True).start()
        yield "tcp:" + first.rsplit("tcpin:", 1)[1].split(",")[0].strip()
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(timeout=PATIENCE_S)


def _forward(lines: Iterable[str], console: Console) -> None:
    """Show what the emulator says later on, such as that this computer is too slow for the speed."""
    for line in lines:
        if "ready; Ctrl-C" not in line and "are forgotten" not in line:
            console.print(line.rstrip(), soft_wrap=True)


def _upload(
    source: str, ends: list[LatLon], clearance_m: float, url: str, saved: Path
) -> dict[str, Any] | None:
    """Run mission-upload as a process of its own; what it reports, None when it failed."""
    command = [_program("mission-upload"), source, "--connect", url, "--start", "--follow", "--json"]
    command += [f"--start-at={ends[0].lat_deg:.7f},{ends[0].lon_deg:.7f}"]
    command += [f"--goal={ends[1].lat_deg:.7f},{ends[1].lon_deg:.7f}"]
    command += ["--clearance", f"{clearance_m:g}", "--save", str(saved), "--patience", f"{PATIENCE_S:g}"]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)  # noqa: S603
    if done.returncode != 0:
        return None
    report: dict[str, Any] = json.loads(done.stdout)
    return report


def _program(name: str) -> str:
    """The installed program beside this Python."""
    return str(Path(sys.executable).with_name(name))


def _read_track(path: Path, goal: Point) -> list[Point]:
    """The true track, ten rows a second, without the time in which the boat lay at its goal."""
    with path.open(encoding="utf-8") as file:
        track = [Point(float(row["north_m"]), float(row["east_m"])) for row in csv.DictReader(file)]
    under_way = [i for i, point in enumerate(track) if distance_m(point, goal) > REACHED_M]
    return track[: max(under_way, default=0) + 2]


def _figures(
    chart: Chart, route: list[Point], sailed: list[Point], report: dict[str, Any], clearance_m: float
) -> dict[str, Any]:
    """Truth against plan. Lengths in metres, times in seconds of the boat's clock."""
    line = shapely.LineString([(point.east_m, point.north_m) for point in route])
    track = shapely.points([(point.east_m, point.north_m) for point in sailed])
    off_m = shapely.distance(track, line)
    shore_m = shapely.distance(track, chart.shores) if not chart.is_open else np.full(len(track), np.inf)
    path = shapely.LineString(track)
    reached = [shapely.distance(path, shapely.Point(p.east_m, p.north_m)) <= REACHED_M for p in route[1:]]
    things = [feature for feature in chart.features if feature.kind not in ("water", "landmark")]
    passed = [feature.name for feature in things if feature.shape.distance(path) <= PASSING_M]
    islands = [ring for part in shapely.get_parts(chart.water) for ring in part.interiors]
    moving = np.hypot(*np.diff(shapely.get_coordinates(track), axis=0).T) > 0.01 * CRUISE_M_S
    nearest_m = float(shore_m.min())
    return {
        "planned_m": float(line.length),
        "straight_m": distance_m(route[0], route[-1]),
        "sailed_m": path_length_m(sailed),
        "time_s": float(0.1 * np.count_nonzero(moving)),
        "waypoints": len(reached),
        "reached": sum(reached),
        "off_rms_m": float(np.sqrt(np.mean(off_m**2))),
        "off_max_m": float(off_m.max()),
        "clearance_m": clearance_m,
        "nearest_m": nearest_m,
        "kept": "met" if nearest_m >= clearance_m else "NOT met",
        "passed": passed
        or [f"{sum(ring.distance(path) <= PASSING_M for ring in islands)} unnamed island(s)"],
        "upload_s": report["upload"]["upload_s"],
        "read_back_s": report["upload"]["read_back_s"],
        "items": report["upload"]["items"],
        "ok": all(reached) and nearest_m >= clearance_m - KEEPS_WITHIN_M,
    }


def _print_table(figures: dict[str, Any], console: Console) -> None:
    table = Table(title="What was planned, and what the boat really did", box=None, show_header=False)
    rows = (
        ("uploaded, read back equal", "{items} items in {upload_s:.2f} s, {read_back_s:.2f} s"),
        ("straight line, planned, sailed", "{straight_m:.0f} m, {planned_m:.0f} m, {sailed_m:.0f} m"),
        ("time under way", "{time_s:.0f} s of the boat's clock"),
        ("waypoints reached", "{reached} of {waypoints}"),
        ("off the planned line", "{off_rms_m:.2f} m RMS, {off_max_m:.2f} m at most"),
        ("nearest to anything solid", "{nearest_m:.2f} m; {clearance_m:g} m asked for: {kept}"),
    )
    for name, form in rows:
        table.add_row(name, form.format(**figures))
    table.add_row("sailed past", ", ".join(figures["passed"]))
    table.add_row("result", "as it should be" if figures["ok"] else "NOT as it should be")
    console.print(table)


def _draw(
    chart: Chart, route: list[Point], track: list[Point], figures: dict[str, Any], picture: Path
) -> None:
    subtitle = (
        "A* with {clearance_m:g} m clearance, {sailed_m:.0f} m sailed under PID control, "
        "{off_rms_m:.2f} m RMS off the line"
    )
    every = max(1, len(track) // DRAWN_POINTS)
    figure = draw_picture(
        chart,
        route,
        track[::every],
        title=chart.name.split(" (")[0],
        subtitle=subtitle.format(**figures),
        clearance_m=figures["clearance_m"],
    )
    save_figure(picture, figure)


if __name__ == "__main__":
    try:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        code = main()
    except KeyboardInterrupt:
        sys.stderr.write("demo: interrupted\n")
        code = 130
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(code)
