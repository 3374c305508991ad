"""The commands of boat-sitl, the emulator's program."""

from typing import Annotated

import typer

from companion.core.command_line import HELP_NAMES, Version, run_app
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

PROGRAM = "boat-sitl"

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings=HELP_NAMES,
    help="The emulator: the boat's own program over simulated hardware and water.",
)


@app.callback()
def options(
    debug: Annotated[bool, typer.Option("--debug", help="a traceback with every error")] = False,
    version: Version = False,
) -> None:
    """What goes before the command; --debug is looked for where errors end."""


app.command()(serve)
app.command()(sail)
app.command()(campaign)
app.command()(encounters)
app.command()(report)
app.command()(tune)
app.command()(paper)
app.command()(physics)


def run_program(arguments: list[str]) -> int:
    """Run the program; returns its exit code."""
    return run_app(app, PROGRAM, with_json_file_option(arguments), expected=(MissionToolsError, BoatError))
