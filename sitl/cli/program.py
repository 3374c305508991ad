"""The commands of boat-sitl, the emulator's program."""

from companion.cli.command_line import Program
from companion.core.errors import BoatError
from mission_tools.errors import MissionToolsError
from sitl.cli.arguments import with_json_file_option
from sitl.cli.campaign import campaign
from sitl.cli.encounters import encounters
from sitl.cli.paper import paper
from sitl.cli.physics import physics
from sitl.cli.report import report
from sitl.cli.sail import sail
from sitl.cli.serve import serve
from sitl.cli.tune import tune

program = Program(
    "boat-sitl",
    "The emulator: the boat's own program over simulated hardware and water.",
    (serve, sail, campaign, encounters, report, tune, paper, physics),
    expected=(MissionToolsError, BoatError),
)


def run_program(arguments: list[str]) -> int:
    """Run the program; returns its exit code."""
    return program.run(with_json_file_option(arguments))
