"""The commands of boat-survey, each in a module of its own."""

from companion.cli.command_line import Program
from companion.core.errors import BoatError
from mission_tools.errors import MissionToolsError

_program = Program(
    "boat-survey",
    "From a boat's logs to samples with their places, and to a depth chart.",
    ("mission_tools.cli.survey_export:export", "mission_tools.cli.survey_chart:chart"),
    expected=(MissionToolsError, BoatError),
)


def run_program(arguments: list[str]) -> int:
    """Run the program; returns its exit code."""
    return _program.run(arguments)
