"""The command mission-check."""

import json
import sys
from pathlib import Path
from typing import Annotated

import typer

from companion.core.command_line import HELP_NAMES, Version
from mission_tools.cli.exit import run_app
from mission_tools.maps import load_source
from mission_tools.mission.check import check_mission
from mission_tools.mission.plan_file import load_mission
from mission_tools.planning.planner import PlanSettings

PROGRAM = "mission-check"
EXAMPLES = f"""
Check a mission (.plan or .waypoints): items that a boat cannot do, missing home, odd places and frames; with
a map also legs over land or nearer to it than the clearance.

Examples:

    {PROGRAM} survey.plan

    {PROGRAM} survey.plan --map pond.geojson --clearance 3

Exit codes: 0 nothing found, 1 findings, 2 wrong usage or input.
"""

app = typer.Typer(add_completion=False, rich_markup_mode=None, context_settings=HELP_NAMES)


@app.command(help=EXAMPLES, no_args_is_help=True)
def check(
    file: Annotated[Path, typer.Argument(help="the mission")],
    map_source: Annotated[
        str | None,
        typer.Option("--map", metavar="SOURCE", help="scenario, .toml or .geojson to check against"),
    ] = None,
    clearance: Annotated[
        float | None, typer.Option(metavar="M", help="metres kept from everything [the scenario's, or 4]")
    ] = None,
    as_json_text: Annotated[bool, typer.Option("--json", help="findings as JSON on stdout")] = False,
    debug: Annotated[bool, typer.Option("--debug", help="tracebacks")] = False,  # noqa: ARG001 - run_app reads it
    version: Version = False,  # noqa: ARG001 - its callback prints it
) -> int:
    """The command; its help is EXAMPLES."""
    mission = load_mission(file)
    if map_source is None:
        findings = check_mission(mission)
    else:
        source = load_source(map_source)
        settings = PlanSettings.from_route(source.route, clearance_m=clearance)
        findings = check_mission(mission, source.chart, settings.clearance_m)
    code = 1 if findings else 0
    if as_json_text:
        listed = [{"item": finding.item, "text": finding.text} for finding in findings]
        sys.stdout.write(
            json.dumps({"ok": not findings, "exit_code": code, "findings": listed}, indent=2) + "\n"
        )
        return code
    for finding in findings:
        sys.stdout.write(f"{file}: {finding}\n")
    count = len(mission.items)
    sys.stdout.write(f"{file}: {count} items, {len(findings)} finding{'' if len(findings) == 1 else 's'}\n")
    return code


def run_program(arguments: list[str]) -> int:
    """Run the program; returns its exit code."""
    return run_app(app, PROGRAM, arguments)
