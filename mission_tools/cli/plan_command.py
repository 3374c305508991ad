"""The command mission-plan: the options of mission-upload that need no vehicle."""

import sys
from argparse import Namespace
from pathlib import Path

from companion.cli.interrupts import importing
from companion.cli.parser import Parser
from mission_tools.cli.arguments import print_json, run_parsed, with_places
from mission_tools.cli.options import mission_parser, request
from mission_tools.errors import UsageError

PROGRAM = "mission-plan"
EXAMPLES = f"""
Plan a mission, describe it, and write it to a file. No vehicle is needed; mission-upload takes the same
options.

SOURCE is a scenario (`lake`, or a .toml file), a map (.geojson, .kml …) with --start and --goal, or a mission
that is ready (QGroundControl's .plan, or .waypoints).

Examples:

    {PROGRAM} lake --out lake.plan --preview lake.png

    {PROGRAM} lake --via 50.0001,-1.1975 --via 49.9990,-1.2010@60 --any-order --return --boat lake

    {PROGRAM} lake --survey all --footprint 30 --overlap 0.2 --contract --out survey.plan

    {PROGRAM} pond.geojson --start 29.4102,-82.1712 --goal 29.4105,-82.1702 --clearance 3 --out pond.plan

    {PROGRAM} drawn.gpx --as-route --check-on pond.geojson --out drawn.plan

    {PROGRAM} --learn 00012.bin --learn 00013.bin --boat boat.toml

Exit codes: 0 done, 1 no route, 2 wrong usage or input.
"""


def _parser() -> Parser:
    parser = mission_parser(PROGRAM, EXAMPLES)
    parser.set_defaults(dry_run=True)
    parser.add_argument(
        "--learn",
        action="append",
        type=Path,
        metavar="LOG",
        help="no plan: print what --boat draws at which speed, by its logs (.bin); repeat it",
    )
    parser.add_argument("--items", action="store_true", help="with --json: also every item, as on the wire")
    parser.add_common()
    return parser


def run_job(given: Namespace) -> None:
    """Do what the options of mission-plan or mission-upload ask for."""
    with importing():
        from mission_tools.cli.report import as_json  # noqa: PLC0415 - numpy and more, not needed for --help
        from mission_tools.job.job import run  # noqa: PLC0415
        from mission_tools.job.planned import Report  # noqa: PLC0415
        from mission_tools.wording import Printer  # noqa: PLC0415

    asked = request(given)
    report = Report()
    run(asked, report, Printer(sys.stderr if given.as_json else sys.stdout))
    if given.as_json:
        print_json(as_json(report, with_items=given.items), None if given.items else 2)


def _learn(given: Namespace) -> None:
    """Print what logs say that a boat draws."""
    with importing():
        from mission_tools.costs.boat import load_boat  # noqa: PLC0415 - as in run_job
        from mission_tools.costs.learned_draw import learn_draw  # noqa: PLC0415

    found = learn_draw(given.learn, load_boat(given.boat).idle_a)
    if given.as_json:
        print_json({"draw": found})
        return
    pairs = ", ".join(f"[{speed_m_s:.3g}, {drawn_a:.3g}]" for speed_m_s, drawn_a in found)
    sys.stdout.write(f"[battery]\ndraw = [{pairs}]  # m/s through still water, A\n")


def _run(given: Namespace) -> None:
    if given.learn:
        _learn(given)
    elif given.source is None:
        raise UsageError(f"SOURCE is missing (see {PROGRAM} --help)")
    else:
        run_job(given)


def run_program(arguments: list[str]) -> int:
    """Run the program; returns its exit code."""
    return run_parsed(_parser(), with_places(arguments), _run)
