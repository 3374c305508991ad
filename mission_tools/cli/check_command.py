"""The command mission-check."""

import sys
from argparse import Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from companion.cli.interrupts import importing
from companion.cli.parser import Parser, number
from mission_tools.cli.arguments import print_json, run_parsed
from mission_tools.cli.options import add_link
from mission_tools.errors import UsageError

if TYPE_CHECKING:
    from mission_tools.mission.mission import Mission

PROGRAM = "mission-check"
EXAMPLES = f"""
Check a mission (.plan or .waypoints), or with --connect the one that a vehicle holds: items that a boat
cannot do, missing home, odd places and frames; with a map also legs over land or nearer to it than the
clearance.

Examples:

    {PROGRAM} survey.plan

    {PROGRAM} survey.plan --map pond.geojson --clearance 3

    {PROGRAM} --connect tcp:127.0.0.1:5760 --map lake

Exit codes: 0 nothing found, 1 findings, 2 wrong usage or input, 3 no vehicle or link lost.
"""


def _parser() -> Parser:
    parser = Parser(PROGRAM, EXAMPLES, "FILE")
    add = parser.add_argument_group("check").add_argument
    add("--map", metavar="SOURCE", dest="map_source", help="scenario or map to check against")
    add("--clearance", type=number, metavar="M", help="metres kept from everything [the scenario's, or 4]")
    add_link(parser, None)
    parser.add_common()
    return parser


def _check(given: Namespace) -> int:
    with importing():
        from mission_tools.assembly.check import check_mission  # noqa: PLC0415
        from mission_tools.maps import load_source  # noqa: PLC0415 - numpy and more, not needed for --help
        from mission_tools.mission.plan_file import load_mission  # noqa: PLC0415
        from mission_tools.planning.planner import PlanSettings  # noqa: PLC0415
        from mission_tools.wording import counted  # noqa: PLC0415

    if (given.source is None) == (given.link is None):
        raise UsageError("expected either a FILE or --connect URL, which checks what is on board")
    if given.source is not None:
        name, mission = given.source, load_mission(Path(given.source))
    else:
        name, mission = given.link, _on_board(given)
    if given.map_source is None:
        findings = check_mission(mission)
    else:
        source = load_source(given.map_source)
        settings = PlanSettings.from_route(source.route, clearance_m=given.clearance)
        findings = check_mission(mission, source.chart, settings.clearance_m)
        for note in source.chart.notes:
            sys.stderr.write(f"note: {note}\n")
    code = 1 if findings else 0
    if given.as_json:
        listed = [{"item": finding.item, "text": finding.text} for finding in findings]
        print_json({"ok": not findings, "exit_code": code, "findings": listed})
        return code
    for finding in findings:
        sys.stdout.write(f"{name}: {finding}\n")
    sys.stdout.write(f"{name}: {counted(len(mission.items), 'item')}, {counted(len(findings), 'finding')}\n")
    return code


def _on_board(given: Namespace) -> "Mission":
    with importing():
        from mission_tools.vehicle.exchange import ask_vehicle  # noqa: PLC0415 - MAVSDK takes half a second

    return ask_vehicle(given.link, given.patience_s, given.sign_key, given.system_id).mission


def run_program(arguments: list[str]) -> int:
    """Run the program; returns its exit code."""
    return run_parsed(_parser(), arguments, _check)
