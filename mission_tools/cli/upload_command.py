"""The command mission-upload."""

import math

from companion.cli.parser import Parser, number
from mission_tools.cli.arguments import run_parsed, with_places
from mission_tools.cli.options import add_link, mission_parser
from mission_tools.cli.plan_command import run_job


def _parser() -> Parser:
    parser = mission_parser(PROGRAM, EXAMPLES)
    add = parser.add_argument_group("upload").add_argument
    add("--start", action="store_true", help="arm and start the mission")
    add("--follow", action="store_true", help="watch until the mission has ended")
    add(
        "--watch",
        action="store_true",
        help="as --follow, and lead the mission round what the boat's rangers see on its way",
    )
    add(
        "--timeout",
        type=number,
        dest="timeout_s",
        default=math.inf,
        metavar="S",
        help="give up following after this",
    )
    add("--diff", action="store_true", help="say what the upload changes on board")
    add("--if-changed", action="store_true", help="as --diff, and upload only the lists that change")
    add("--dry-run", action="store_true", help="plan and report; no vehicle")
    add_link(parser)
    parser.set_defaults(items=False)
    parser.add_common()
    return parser


def run_program(arguments: list[str]) -> int:
    """Run the program; returns its exit code."""
    return run_parsed(_parser(), with_places(arguments), run_job)


PROGRAM = "mission-upload"
EXAMPLES = f"""
Plan a mission, upload it, read it back and compare; then start it and follow it, if asked to.

SOURCE is a scenario (`lake`, or a .toml file), a map (.geojson) with --goal, or a mission that is ready
(QGroundControl's .plan, or .waypoints). Without it, --fence and --rally bring up theirs alone, and the boat
keeps its mission.

A fence file is a .plan, or .geojson with polygons, and circles as points with radius_m; the property kind is
inclusion (which they are without it) or exclusion. A map is a fence too: the outline of its water, without
what is solid or to keep out of. Rally points are points. A route is planned inside the fence and keeps the
clearance from its lines too.

A route starts at --start-at, else at the boat, else at the scenario's start. --contract adds a fence and
rally points from the map itself; --boat refuses a plan on which the boat would not come home.

Examples:

    {PROGRAM} lake --start --follow

    {PROGRAM} pool --case 3 --dry-run --preview pool.png

    {PROGRAM} pond.geojson --goal 29.4105,-82.1702 --clearance 3 --connect udp:0.0.0.0:14550

    {PROGRAM} lake --fence lake-fence.geojson --rally jetties.geojson --start

    {PROGRAM} lake --via 50.0001,-1.1975 --return --contract --boat lake --if-changed --start --follow

    {PROGRAM} --fence none

    {PROGRAM} survey.plan --connect /dev/ttyUSB0,57600 --sign-key radio.key --start

Exit codes: 0 done, 1 no route or the vehicle refused, 2 wrong usage or input, 3 no vehicle or link lost.
"""
