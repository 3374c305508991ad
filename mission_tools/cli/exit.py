"""How a program of this package runs and ends, with the planner's own errors."""

import sys
from argparse import Namespace
from collections.abc import Callable, Sequence

from companion.cli.parser import Parser
from companion.cli.program_end import end_with
from companion.core.errors import BoatError
from mission_tools.errors import MissionToolsError


def run_parsed(parser: Parser, arguments: Sequence[str], work: Callable[[Namespace], int | None]) -> int:
    """Parse, do the work, and return the exit code. Without arguments the help is printed.

    work: takes what was given; None stands for exit code 0.
    """
    if not arguments:
        parser.print_help(sys.stderr)
        return 2
    try:
        return work(parser.read(arguments)) or 0
    except SystemExit as done:  # --help and --version
        return done.code if isinstance(done.code, int) else 0
    except (KeyboardInterrupt, Exception) as error:
        return end_with(error, parser.prog, arguments, (MissionToolsError, BoatError))
