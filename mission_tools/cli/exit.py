"""How a program of this package ends: `companion.core.command_line`, with the planner's own errors."""

from collections.abc import Sequence

import typer

from companion.core import command_line
from companion.core.errors import OutputError
from mission_tools.errors import MissionToolsError


def run_app(app: typer.Typer, name: str, arguments: Sequence[str]) -> int:
    """Run a typer app; returns the exit code. With --debug every error keeps its traceback."""
    return command_line.run_app(app, name, arguments, expected=(MissionToolsError, OutputError))
