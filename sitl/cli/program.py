"""The commands of boat-sitl, the emulator's program."""

from companion.cli.command_line import Program
from companion.core.errors import BoatError
from mission_tools.errors import MissionToolsError
from sitl.cli.arguments import with_json_file_option

program = Program(
    "boat-sitl",
    "The emulator: the boat's own program over simulated hardware and water.",
    tuple(
        f"sitl.cli.{name}:{name}"
        for name in ("serve", "sail", "campaign", "encounters", "report", "fit", "tune", "paper", "physics")
    ),
    expected=(MissionToolsError, BoatError),
)


def run_program(arguments: list[str]) -> int:
    """Run the program; returns its exit code."""
    return program.run(with_json_file_option(arguments))
