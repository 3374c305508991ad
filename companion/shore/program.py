"""boat-shore: the boat's page for a phone or a laptop."""

import asyncio
import contextlib
import logging
import sys
import time
from pathlib import Path
from typing import Annotated, Final

import typer

from companion.core.command_line import HELP_NAMES, Version, busy_port_explained, run_app
from companion.core.errors import BoatError, ConfigError
from companion.core.output_file import state_home
from companion.shore.chart import Chart
from companion.shore.station.boats import Boats
from companion.shore.web.listening import parse_listen, serve
from companion.shore.web.pin_file import LEAST_CHARACTERS, PinFile
from companion.shore.web.server import make_app
from companion.shore.web.session import Sessions

PROGRAM: Final = "boat-shore"
_PAGE: Final = Path(__file__).with_name("page")

app = typer.Typer(
    add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False, context_settings=HELP_NAMES
)


class _SystemClock:
    """The computer's."""

    def now_s(self) -> float:
        """Monotonic seconds."""
        return time.monotonic()

    def unix_s(self) -> float:
        """Seconds since 1970."""
        return time.time()


def default_pin_file() -> Path:
    """Of the user who runs the program."""
    return state_home() / "shore-pin"


PinOption = Annotated[
    Path | None, typer.Option("--pin-file", help="The PIN's hash. Default: under $XDG_STATE_HOME/mavboat.")
]


@app.callback(invoke_without_command=True)
def show(
    context: typer.Context,
    connect: Annotated[
        str, typer.Option("--connect", help="The link to the boat, as for a ground station.")
    ] = "tcp:127.0.0.1:5760",
    listen: Annotated[
        str,
        typer.Option("--listen", help="HOST:PORT of the page. 0.0.0.0:80 opens it to the boat's network."),
    ] = "127.0.0.1:8080",
    chart: Annotated[Path | None, typer.Option("--map", help="GeoJSON map of the water.")] = None,
    status: Annotated[
        Path | None, typer.Option("--status", help="Status file of the boat on this computer.")
    ] = None,
    hosts: Annotated[
        list[str] | None,
        typer.Option("--host", help="Further name of this computer in the page's address; repeatable."),
    ] = None,
    pin_file: PinOption = None,
    system_id: Annotated[int, typer.Option(min=1, max=254, help="System id of this station.")] = 250,
    debug: Annotated[bool, typer.Option("--debug", help="a traceback with every error")] = False,  # noqa: ARG001 (run_app)
    version: Version = False,  # noqa: ARG001 (as above)
) -> None:
    """Serve the boat's page until Ctrl-C or SIGTERM. It only shows until a PIN is set: boat-shore pin.

    Example:  boat-shore --connect tcp:127.0.0.1:5760 --listen 0.0.0.0:8080
    """
    if context.invoked_subcommand is not None:
        return
    logging.basicConfig(level=logging.WARNING, format="%(asctime)s %(levelname)s %(message)s")
    host, port = parse_listen(listen)
    sessions = Sessions(PinFile(pin_file or default_pin_file()))
    water = Chart(chart)
    with contextlib.closing(Boats(connect, system_id, status_file=status)) as boats:
        web_app = make_app(boats, water, sessions, _PAGE, _SystemClock(), hosts=hosts or ())

        def on_open(number: int) -> None:
            name = f"[{host}]" if ":" in host else "127.0.0.1" if host == "0.0.0.0" else host  # noqa: S104
            typer.echo(f"the page: http://{name}:{number}/")
            if not sessions.has_pin:
                typer.echo("no PIN is set: the page only shows; set one with boat-shore pin")

        with busy_port_explained("choose another with --listen"):
            asyncio.run(serve(web_app, host, port, on_open))


@app.command()
def pin(pin_file: PinOption = None) -> None:
    """Set the PIN that the page asks for. Sessions opened with another one end.

    Example:  boat-shore pin
    """
    file = PinFile(pin_file or default_pin_file())
    if sys.stdin.isatty():
        prompt = f"PIN (at least {LEAST_CHARACTERS} digits or letters)"
        told: str = typer.prompt(prompt, hide_input=True, confirmation_prompt=True)
    else:
        told = sys.stdin.readline().strip()
        if not told:
            raise ConfigError("expected a PIN on standard input")
    file.write(told)
    typer.echo(f"{file.path}: PIN set")


def run_program(arguments: list[str]) -> int:
    """Run the program; returns its exit code."""
    return run_app(app, PROGRAM, arguments, expected=(BoatError,))
