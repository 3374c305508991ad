"""The command mission-upload."""

import json
import logging
import math
import sys
from argparse import Namespace

from companion.cli.interrupts import importing
from companion.cli.parser import Parser, number
from mission_tools.cli.arguments import with_places
from mission_tools.cli.exit import run_parsed
from mission_tools.cli.options import (
    add_areas,
    add_costs,
    add_link,
    add_outputs,
    add_route,
    add_tasks,
    plan_options,
)
from mission_tools.cli.upload_help import EXAMPLES, PROGRAM


def _parser() -> Parser:
    parser = Parser(PROGRAM, EXAMPLES, "SOURCE")
    add_route(parser)
    add_tasks(parser)
    add_areas(parser)
    add_costs(parser)
    add_outputs(parser)
    sail = parser.add_argument_group("upload")
    sail.add_argument("--start", action="store_true", help="arm and start the mission")
    sail.add_argument("--follow", action="store_true", help="watch until the mission has ended")
    sail.add_argument(
        "--watch",
        action="store_true",
        help="as --follow, and lead the mission round what the boat's rangers see on its way",
    )
    sail.add_argument(
        "--timeout", type=number, default=math.inf, metavar="S", help="give up following after this"
    )
    sail.add_argument("--diff", action="store_true", help="say what the upload changes on board")
    sail.add_argument(
        "--if-changed", action="store_true", help="as --diff, and upload only the lists that change"
    )
    sail.add_argument("--dry-run", action="store_true", help="plan and report; no vehicle")
    add_link(parser)
    parser.add_common()
    return parser


def _upload(given: Namespace) -> None:
    with importing():
        from mission_tools.cli.report import as_json  # noqa: PLC0415 - numpy and more, not needed for --help
        from mission_tools.job.job import run  # noqa: PLC0415
        from mission_tools.job.request import Report, Request  # noqa: PLC0415
        from mission_tools.wording import Printer  # noqa: PLC0415

    if given.debug:
        logging.basicConfig(level=logging.DEBUG, stream=sys.stderr)
    request = Request(
        source=given.source,
        options=plan_options(given),
        link=given.connect,
        system_id=given.system_id,
        patience_s=given.patience,
        start=given.start,
        follow=given.follow,
        watch=given.watch,
        timeout_s=given.timeout,
        dry_run=given.dry_run,
        save=given.save,
        preview=given.preview,
        force=given.force,
        sign_key=given.sign_key,
        fence=given.fence,
        rally=given.rally,
        one_way=given.one_way,
        beyond_range=given.beyond_range,
        fence_from_map=given.fence_from_map or given.contract,
        rally_from_map=given.rally_from_map or given.contract,
        diff=given.diff,
        if_changed=given.if_changed,
    )
    report = Report()
    run(request, report, Printer(sys.stderr if given.as_json else sys.stdout))
    if given.as_json:
        sys.stdout.write(json.dumps(as_json(report), indent=2) + "\n")


def run_program(arguments: list[str]) -> int:
    """Run the program; returns its exit code."""
    return run_parsed(_parser(), with_places(arguments), _upload)
