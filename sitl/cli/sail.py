"""`boat-sitl sail`: one mission in lockstep, as fast as the machine goes."""

import dataclasses
import json
from pathlib import Path
from typing import Annotated

from rich.console import Console
from rich.progress import Progress
from rich.table import Table

from companion.app import garbage_collection as garbage
from companion.cli.command_line import Option, echo
from companion.cli.output_file import write_text
from companion.core.errors import OutputError
from companion.log.logbook import Logbook
from companion.log.sink import SingleFile
from mission_tools.errors import UsageError
from mission_tools.mission.plan_file import load_mission
from sitl.cli.arguments import Case, Csv, Seed, Settings, Source, StartAt, scenario_from
from sitl.courses.missions import course_names, lay_out, plan_mission, wire_fence, wire_items
from sitl.reports.run_record import RunRecord
from sitl.run.mission_run import MissionRun, Result
from sitl.run.station_commands import RunError


def sail(
    source: Source,
    mission: Annotated[
        Path | None,
        Option(metavar="FILE", help="a .plan or .waypoints file [planned on the scenario's map]"),
    ] = None,
    course: Annotated[
        str | None, Option(metavar="NAME", help=f"a course instead: {', '.join(course_names())}")
    ] = None,
    settings: Settings = None,
    case: Case = None,
    seed: Seed = None,
    start: StartAt = None,
    fence: Annotated[
        bool, Option("--fence", help="the outline of the water as the fence [the plan's]")
    ] = False,
    linger: Annotated[
        float, Option(metavar="S", least=0.0, help="continue after the end of the mission")
    ] = 0.0,
    timeout: Annotated[
        float | None, Option(metavar="S", least=0.0, help="simulated seconds [4 × the planned time]")
    ] = None,
    as_json_text: Annotated[
        bool, Option("--json", help="figures as JSON on stdout, or in a file: --json FILE.json")
    ] = False,
    json_file: Annotated[Path | None, Option("--json-file", is_hidden=True)] = None,
    csv: Csv = None,
    log: Annotated[
        Path | None, Option(metavar="FILE.bin", help="write the boat's log, as for MAVExplorer")
    ] = None,
    png: Annotated[Path | None, Option(metavar="FILE", help="draw chart, plan and true track")] = None,
    record: Annotated[
        Path | None, Option(metavar="FILE.npz", help="keep the whole run, for boat-sitl report")
    ] = None,
) -> None:
    """Sail one mission in lockstep, as fast as the machine goes, and measure it against the truth.

    The same scenario, mission and seed give the same state hash. Exit code 1 if the mission is not completed.

    Example:  boat-sitl sail pool --case 2 --set environment.current_m_s=0.01 --png out/pool.png
    """
    console = Console(stderr=as_json_text, highlight=False, soft_wrap=True)
    if mission is not None and course is not None:
        raise UsageError("--course: a run sails either a course or a mission")
    if mission is not None:
        to_sail = load_mission(mission)
        scenario = scenario_from(source, settings, case, seed, start, to_sail.home)
    elif course is not None:
        scenario = scenario_from(source, settings, case, seed, start)
        to_sail = lay_out(course, scenario)
    else:
        scenario = scenario_from(source, settings, case, seed, start)
        to_sail, _ = plan_mission(scenario)
    logbook = None if log is None else Logbook(SingleFile(log))
    fence_items = wire_fence(to_sail, scenario, has_outline=fence)
    mission_run = MissionRun(scenario, wire_items(to_sail), logbook, fence_items)
    try:
        result = _run(mission_run, timeout, linger, console)
    finally:
        mission_run.lockstep.close()  # a run that went wrong has its log, too
    if csv is not None:
        mission_run.recorder.write_csv(csv, every=5)
    figures = dataclasses.asdict(result)
    if json_file is not None:
        write_text(json_file, json.dumps(figures, indent=2) + "\n")
    kept = RunRecord.of(mission_run, result)
    if png is not None:
        # matplotlib takes a second to import
        from mission_tools.drawing.draw import save_figure  # noqa: PLC0415
        from sitl.reports.run_pictures import draw_track_chart  # noqa: PLC0415

        save_figure(png, draw_track_chart(kept))
    if record is not None:
        kept.save(record)
    if not as_json_text:
        _print_table(result, console)
    if not result.completed:
        raise RunError(f"the mission was not completed: {mission_run.ending()}").with_figures(figures)
    if as_json_text:
        echo(json.dumps(figures, indent=2))
    if logbook is not None and logbook.sink.fault:
        raise OutputError(logbook.sink.fault)


def _run(mission_run: MissionRun, timeout: float | None, linger_s: float, console: Console) -> Result:
    """Sail with a progress bar where there is a person to see it."""
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task("sailing", total=len(mission_run.items) - 1)

        def tell(time_s: float, seq: int) -> None:
            progress.update(task, completed=seq - 1, description=f"{time_s:.0f} s, item {seq}")

        garbage.settle()
        return mission_run.run(timeout, tell, linger_s)


def _print_table(result: Result, console: Console) -> None:
    """One figure a row."""
    table = Table(title=f"{result.scenario}, seed {result.seed}", box=None, show_header=False)
    for name, value in (
        ("mission", "completed" if result.completed else f"not completed, ends in {result.final_mode}"),
        ("waypoints reached", f"{result.waypoints_reached} of {result.waypoints}"),
        ("planned length", _metres(result.planned_length_m)),
        ("path length", _metres(result.path_length_m)),
        ("time", f"{result.time_s:.1f} s"),
        ("cross-track error, RMS", _metres(result.cross_track_rms_m)),
        ("cross-track error, largest", _metres(result.cross_track_max_m)),
        ("nearest to shore or obstacle", _metres(result.min_clearance_m)),
        ("groundings", str(result.groundings)),
        ("simulated", f"{result.sim_seconds:.1f} s at {result.real_time_factor:.0f} × real time"),
        ("state hash", result.state_hash[:16]),
    ):
        table.add_row(name, value)
    console.print(table)


def _metres(value: float | None) -> str:
    return "–" if value is None else f"{value:.3g} m" if value < 100.0 else f"{value:.1f} m"
