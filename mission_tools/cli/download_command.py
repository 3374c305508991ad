"""The command mission-download."""

import sys
from argparse import Namespace
from pathlib import Path

from companion.cli.interrupts import importing
from companion.cli.parser import Parser
from mission_tools.cli.arguments import print_json, run_parsed
from mission_tools.cli.options import add_force, add_link

PROGRAM = "mission-download"
EXAMPLES = f"""
Save the mission, the fence and the rally points that a vehicle holds. It changes nothing on board.

FILE is a .plan for QGroundControl, or .waypoints, which holds the mission alone.

Examples:

    {PROGRAM} aboard.plan

    {PROGRAM} aboard.plan --connect udp:0.0.0.0:14550

Exit codes: 0 done, 1 the vehicle refused, 2 wrong usage or input, 3 no vehicle or link lost.
"""


def _parser() -> Parser:
    parser = Parser(PROGRAM, EXAMPLES, "FILE", is_required=True)
    add_link(parser)
    add_force(parser)
    parser.add_common()
    return parser


def _download(given: Namespace) -> None:
    with importing():
        from mission_tools.job.planned import check_outputs, save  # noqa: PLC0415 - not needed for --help
        from mission_tools.vehicle.exchange import ask_vehicle  # noqa: PLC0415
        from mission_tools.wording import counted  # noqa: PLC0415

    file = Path(given.source)
    check_outputs(file, None, (), force=given.force)
    held = ask_vehicle(given.link, given.patience_s, given.sign_key, given.system_id)
    mission = held.mission
    save(mission, file)
    areas = len(mission.fence.polygons) + len(mission.fence.circles)
    counts = {"items": len(mission.items), "fence_areas": areas, "rally_points": len(mission.rally)}
    if given.as_json:
        tree = {"ok": True, "exit_code": 0, "system_id": held.vehicle_id, "saved": str(file), **counts}
        print_json(tree)
        return
    said = ", ".join(
        counted(count, name.replace("_", " ").removesuffix("s")) for name, count in counts.items()
    )
    sys.stdout.write(f"vehicle {held.vehicle_id} on {held.link}: {said}\nsaved {file}\n")


def run_program(arguments: list[str]) -> int:
    """Run the program; returns its exit code."""
    return run_parsed(_parser(), arguments, _download)
