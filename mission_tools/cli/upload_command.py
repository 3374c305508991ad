"""The command mission-upload."""

import asyncio
import json
import logging
import math
import sys
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from companion.core.command_line import HELP_NAMES, Version
from mission_tools.cli.arguments import position, with_start_position_option
from mission_tools.cli.exit import run_app
from mission_tools.cli.report import as_json
from mission_tools.cli.upload_help import EXAMPLES, PROGRAM
from mission_tools.job import Report, Request, run
from mission_tools.mission.planned_mission import PlanOptions
from mission_tools.vehicle.connection import DEFAULT_SYSTEM_ID
from mission_tools.vehicle.link_url import DEFAULT_LINK, FORMS

app = typer.Typer(add_completion=False, rich_markup_mode=None, context_settings=HELP_NAMES)


@app.command(help=EXAMPLES, no_args_is_help=True)
def upload(
    source: Annotated[
        str | None, typer.Argument(help="scenario, .toml, .geojson, .plan or .waypoints", show_default=False)
    ] = None,
    connect: Annotated[str, typer.Option(metavar="URL", help=f"the link: {FORMS}")] = DEFAULT_LINK,
    start_at: Annotated[
        str | None,
        typer.Option(metavar="LAT,LON", help="where the route starts (also --start LAT,LON) [the boat]"),
    ] = None,
    goal: Annotated[
        str | None, typer.Option(metavar="LAT,LON", help="where it ends [the scenario's]")
    ] = None,
    case: Annotated[str | None, typer.Option(metavar="N", help="one of the scenario's cases")] = None,
    clearance: Annotated[float | None, typer.Option(metavar="M", help="metres kept from everything")] = None,
    cell: Annotated[float | None, typer.Option(metavar="M", help="side of a grid cell in metres")] = None,
    heuristic: Annotated[str | None, typer.Option(help="octile, euclidean or manhattan")] = None,
    smooth: Annotated[bool | None, typer.Option("--smooth/--no-smooth", help="pull the path taut")] = None,
    speed: Annotated[float | None, typer.Option(metavar="M/S", help="speed over ground [the boat's]")] = None,
    fence: Annotated[
        str | None,
        typer.Option(metavar="FILE", help="upload this fence, plan inside it (none: clear)"),
    ] = None,
    rally: Annotated[
        str | None, typer.Option(metavar="FILE", help="upload these rally points (none: clear)")
    ] = None,
    start: Annotated[bool, typer.Option("--start", help="arm and start the mission")] = False,
    follow: Annotated[bool, typer.Option("--follow", help="watch until the mission has ended")] = False,
    timeout: Annotated[
        float, typer.Option(metavar="S", help="give up following after this", show_default=False)
    ] = math.inf,
    patience: Annotated[float, typer.Option(metavar="S", help="wait for heartbeat, position, arming")] = 10.0,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="plan and report; no vehicle")] = False,
    save: Annotated[
        Path | None, typer.Option(metavar="FILE", help="write a .plan or .waypoints file")
    ] = None,
    preview: Annotated[Path | None, typer.Option(metavar="FILE.png", help="draw map, plan and track")] = None,
    as_json_text: Annotated[bool, typer.Option("--json", help="result as JSON on stdout")] = False,
    sign_key: Annotated[
        Path | None, typer.Option(metavar="FILE", help="sign what is sent; take only what is signed")
    ] = None,
    system_id: Annotated[int, typer.Option(min=1, max=255, help="our own id")] = DEFAULT_SYSTEM_ID,
    debug: Annotated[bool, typer.Option("--debug", help="log everything; tracebacks")] = False,
    version: Version = False,  # noqa: ARG001 - its callback prints it
) -> None:
    """The command; its help is EXAMPLES."""
    if debug:
        logging.basicConfig(level=logging.DEBUG, stream=sys.stderr)
    options = PlanOptions(
        start_at=position("--start-at", start_at),
        goal=position("--goal", goal),
        case=case,
        clearance_m=clearance,
        cell_m=cell,
        heuristic=heuristic,
        smooth=smooth,
        speed_m_s=speed,
    )
    request = Request(
        source=source,
        options=options,
        link=connect,
        system_id=system_id,
        patience_s=patience,
        start=start,
        follow=follow,
        timeout_s=timeout,
        dry_run=dry_run,
        save=save,
        preview=preview,
        sign_key=sign_key,
        fence=fence,
        rally=rally,
    )
    report = Report()
    asyncio.run(
        run(request, report, Console(stderr=as_json_text, highlight=False, markup=False, soft_wrap=True))
    )
    if as_json_text:
        sys.stdout.write(json.dumps(as_json(report), indent=2) + "\n")


def run_program(arguments: list[str]) -> int:
    """Run the program; returns its exit code."""
    return run_app(app, PROGRAM, with_start_position_option(arguments))
