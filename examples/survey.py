"""A survey from plan to chart: `make survey`.

Plans passes, tracks and cross lines over the water of a scenario, lets the emulated boat sail them in
lockstep with a depth sounder, charts the lake from its log, and measures both against the truth: what its
track really covered, and how deep the water really is. A table, out/survey.png, the chart in out/chart, and
out/survey.json. The same seed gives the same result.

    make survey
    make survey FOOTPRINT=40 SEED=7
"""

import argparse
import json
import math
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import rasterio
import shapely
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from companion.cli.output_file import write_text
from companion.core.errors import BoatError
from companion.core.geo import Point
from companion.log.logbook import Logbook
from companion.log.sink import SingleFile
from mission_tools.cli.survey_command import run_program as run_survey
from mission_tools.costs.boat import Boat
from mission_tools.drawing.draw import draw_survey, save_figure
from mission_tools.errors import MissionToolsError
from mission_tools.planning.planner import PlanSettings
from mission_tools.tasks.survey.coverage import coverage
from mission_tools.tasks.survey.settings import SurveySettings, turn_radius_m
from mission_tools.tasks.survey.survey import Survey, survey
from mission_tools.tasks.task_route import mission_of
from sitl.cli.arguments import scenario_from
from sitl.courses.missions import wire_items
from sitl.run.mission_run import MissionRun, Result
from sitl.run.recording.recorder import Recorder
from sitl.run.station_commands import RunError
from sitl.world.environment.bottom import Bathymetry
from sitl.world.scenario import Scenario

LEAST_COVERAGE = 0.99  # of the target, in truth
LEAST_WITHIN = 0.85  # of the true depths, within their 90 % bands
LEAST_DEPTH_M = 0.4  # of the water that the boat sails: three times its draught
TURN_M, TURN_RAD = 6.0, math.radians(30.0)  # a turn: the plan bends by more, from so far before to behind
THINNED_M = 0.05  # how far a thinned track may leave the true one


@dataclass(frozen=True, slots=True)
class SailedSurvey:
    """A survey, the figures of its run, the boat's true track, and the share of the target it covered.

    off_tracks_rms_m: distance from the planned line outside turns. straight_share: of the time.
    """

    planned: Survey
    result: Result
    track: tuple[Point, ...]
    coverage: float
    off_tracks_rms_m: float
    straight_share: float


def sail_survey(scenario: Scenario, settings: SurveySettings, log: Path) -> SailedSurvey:
    """Plan from where the boat lies, sail, and measure the true track. log: where the boat writes its log.

    Raises NoRouteError: no water to survey; RunError: the boat refused the mission, or did not complete it.
    """
    planned = survey(scenario.chart, scenario.start, settings)
    items = wire_items(mission_of(planned.route, scenario.frame))
    mission_run = MissionRun(scenario, items, Logbook(SingleFile(log)))
    try:
        result = mission_run.run()
    finally:
        mission_run.lockstep.close()
    if not result.completed:
        raise RunError(f"the survey was not completed: {mission_run.ending()}")
    line = shapely.LineString([(point.east_m, point.north_m) for point in mission_run.recorder.track()])
    thinned = shapely.get_coordinates(line.simplify(THINNED_M, preserve_topology=False)).tolist()
    track = tuple(Point(north_m, east_m) for east_m, north_m in thinned)
    covered = coverage(track, planned.target, planned.swath_m)
    return SailedSurvey(
        planned, result, track, covered, *off_tracks(mission_run.recorder, mission_run.planned)
    )


def off_tracks(recorder: Recorder, planned: Sequence[Point]) -> tuple[float, float]:
    """RMS distance from the planned line outside turns, and the share of the time that this is."""
    off_m, is_sailed = recorder.cross_track_m(planned), recorder.legs >= 0
    places, leg = np.asarray(planned), recorder.legs[is_sailed]
    legs = np.diff(places, axis=0)
    lengths_m = np.maximum(np.hypot(*legs.T), 1e-9)
    ends_m = np.concatenate([[0.0], np.cumsum(lengths_m)])
    from_start = recorder.rows[is_sailed, 1:3] - places[leg]
    along_m = ((from_start * legs[leg]).sum(axis=1) / lengths_m[leg]).clip(0.0, lengths_m[leg])

    def place(by_m: float) -> NDArray[np.complex128]:
        at_m = ends_m[leg] + along_m + by_m
        return np.asarray(np.interp(at_m, ends_m, places @ (1.0, 1.0j)))

    turn_rad = np.angle((place(TURN_M) - place(0.0)) * (place(0.0) - place(-TURN_M)).conj())
    is_straight = np.abs(turn_rad) < TURN_RAD
    return float(np.sqrt(np.mean(off_m[is_straight] ** 2))), float(np.mean(is_straight))


def compared(scenario: Scenario, chart: Path) -> dict[str, float]:
    """Errors of the chart's depth.tif in metres, the share of true depths within its 90 % bands, and the
    volume over the true one of the same water.
    """
    with rasterio.open(chart / "depth.tif") as file:
        depth_m, band_m = file.read(masked=True).filled(np.nan)
        rows, columns = np.nonzero(np.isfinite(depth_m))
        east_m, north_m = file.transform * (columns + 0.5, rows + 0.5)
    depth_m, band_m = depth_m[rows, columns], band_m[rows, columns]
    true_m = Bathymetry(scenario.chart, scenario.environment).depths_m(north_m, east_m)
    error_m = depth_m - true_m
    return {
        "depth_rms_m": float(np.sqrt(np.mean(error_m**2))),
        "depth_mean_error_m": float(np.mean(error_m)),
        "within_band": float(np.mean(np.abs(error_m) <= band_m)),
        "volume_ratio": float(depth_m.sum() / true_m.sum()),
    }


def main() -> int:
    """Plan, sail, chart, report; 0 if the boat covered what it should and the chart is true."""
    arguments = _arguments()
    console = Console(highlight=False)
    try:
        scenario = _scenario(arguments)
        settings = _settings(scenario, arguments)
        console.print(f"sailing a survey of {scenario.title}, seed {scenario.seed} …")
        began_s = time.perf_counter()
        out: Path = arguments.out
        out.mkdir(parents=True, exist_ok=True)
        log, chart = out / "survey.bin", out / "chart"
        sailed = sail_survey(scenario, settings, log)
        console.print("charting the lake …")
        if run_survey(["chart", str(log), "--map", arguments.scenario, "--out", str(chart)]):
            return 1
    except (MissionToolsError, BoatError) as error:
        sys.stderr.write(f"survey: {error}\n")
        return 2
    figures = _figures(sailed, settings) | compared(scenario, chart)
    figures["wall_s"] = time.perf_counter() - began_s
    _print_table(figures, console)
    write_text(out / "survey.json", json.dumps(figures | {"run": asdict(sailed.result)}, indent=2) + "\n")
    subtitle = (
        f"lines {figures['spacing_m']:.3g} m apart, footprint {settings.swath_m:g} m, "
        f"seed {scenario.seed}: {sailed.coverage:.2%} covered in {figures['time_s'] / 3600.0:.1f} h, "
        f"{figures['sailed_m'] / 1000.0:.1f} km sailed"
    )
    figure = draw_survey(
        scenario.chart,
        sailed.planned,
        sailed.track,
        title=f"{scenario.chart.name.split(' (')[0]}: survey",
        subtitle=subtitle,
    )
    save_figure(out / "survey.png", figure)
    console.print(f"pictures: {out / 'survey.png'}, {chart / 'chart.html'}   figures: {out / 'survey.json'}")
    is_true = figures["within_band"] >= LEAST_WITHIN
    return 0 if sailed.coverage >= LEAST_COVERAGE and not sailed.result.groundings and is_true else 1


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="survey", description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--scenario", default="lake", help="lake, pool, a .toml file, or a map")
    parser.add_argument("--footprint", type=float, default=30.0, metavar="M")
    parser.add_argument("--overlap", type=float, default=0.15, metavar="SHARE")
    parser.add_argument("--cross", type=float, default=150.0, metavar="M", help="between cross lines [150]")
    parser.add_argument(
        "--set", action="append", default=[], metavar="KEY=VALUE", help="as of boat-sitl sail"
    )
    parser.add_argument("--start", metavar="LAT,LON", help="of a map that is no scenario")
    parser.add_argument("--battery", type=float, default=20.0, metavar="AH", help="capacity [20]")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path("out"))
    return parser.parse_args()


def _scenario(arguments: argparse.Namespace) -> Scenario:
    """The scenario with a sounder and with a battery that lasts: the lake boat's own returns from half of the
    mill pond.
    """
    capacity_mah = 1000.0 * arguments.battery
    fitted = [f"{battery}.capacity_mah={capacity_mah}" for battery in ("battery", "vehicle.battery")]
    given = [*fitted, "sensors.depth.fitted=true", f"vehicle.failsafe.min_depth_m={LEAST_DEPTH_M}"]
    given += arguments.set
    return scenario_from(arguments.scenario, given, None, arguments.seed, arguments.start)


def _settings(scenario: Scenario, arguments: argparse.Namespace) -> SurveySettings:
    """Tracks for the scenario's own boat."""
    boat = Boat.of(scenario.vehicle)
    return SurveySettings(
        footprint_m=arguments.footprint,
        overlap=arguments.overlap,
        cross_spacing_m=arguments.cross,
        plan=PlanSettings.from_route(scenario.route),
        turn_radius_m=turn_radius_m(boat, boat.cruise_m_s),
    )


def _figures(sailed: SailedSurvey, settings: SurveySettings) -> dict[str, float]:
    """Lengths in metres, times in seconds of the boat's clock."""
    planned, result = sailed.planned, sailed.result
    return {
        "tracks": planned.tracks,
        "spacing_m": planned.spacing_m,
        "turn_radius_m": settings.turn_radius_m,
        "waypoints": result.waypoints,
        "reached": result.waypoints_reached,
        "planned_m": planned.route.length_m,
        "plain_m": planned.plain_m,
        "sailed_m": result.path_length_m,
        "time_s": result.time_s,
        "planned_coverage": planned.coverage,
        "sailed_coverage": sailed.coverage,
        "off_rms_m": result.cross_track_rms_m or 0.0,
        "off_tracks_rms_m": sailed.off_tracks_rms_m,
        "straight_share": sailed.straight_share,
        "nearest_m": result.min_clearance_m or float("inf"),
        "groundings": result.groundings,
    }


def _print_table(figures: dict[str, float], console: Console) -> None:
    table = Table(
        title="What was planned, sailed and charted, against the truth", box=None, show_header=False
    )
    rows = (
        ("covered: planned, sailed", "{planned_coverage:.2%}, {sailed_coverage:.2%}"),
        ("tracks, waypoints reached", "{tracks}, {reached} of {waypoints}"),
        ("plain lines, planned, sailed", "{plain_m:.0f} m, {planned_m:.0f} m, {sailed_m:.0f} m"),
        ("time under way", "{time_s:.0f} s of the boat's clock"),
        ("off the planned line", "{off_rms_m:.2f} m RMS"),
        ("off it outside turns", "{off_tracks_rms_m:.2f} m RMS, {straight_share:.0%} of the time"),
        ("nearest to a shore", "{nearest_m:.2f} m, {groundings} groundings"),
        ("depths off the truth", "{depth_rms_m:.3f} m RMS, {depth_mean_error_m:+.3f} m in the mean"),
        ("true depths in the 90 % band", "{within_band:.1%}"),
        ("volume over the true one", "{volume_ratio:.4f}"),
    )
    for name, form in rows:
        table.add_row(name, form.format(**figures))
    console.print(table)


if __name__ == "__main__":
    sys.exit(main())
