"""boat-shore: the boat's page for a phone or a laptop."""

import asyncio
import contextlib
import getpass
import logging
import sys
from argparse import Namespace
from pathlib import Path
from typing import Final

from companion.cli.output_file import state_home
from companion.cli.program_end import busy_port_explained, end_with
from companion.core.errors import BoatError, ConfigError
from companion.mavlink.signing_key import read_key_file
from mission_tools.errors import MissionToolsError
from mission_tools.shore import memory_use
from mission_tools.shore.chart import WaterChart
from mission_tools.shore.clock import Clock
from mission_tools.shore.command_line import PROGRAM, SHOW, read_arguments
from mission_tools.shore.plans.plan_service import Sources
from mission_tools.shore.web.listening import parse_listen, serve
from mission_tools.shore.web.login.pin_file import LEAST_CHARACTERS, PinFile
from mission_tools.shore.web.login.session import Sessions
from mission_tools.shore.web.server import make_app
from mission_tools.station.boats import Boats

_PAGE: Final = Path(__file__).with_name("page")


def default_pin_file() -> Path:
    """Of the user who runs the program."""
    return state_home() / "shore-pin"


def _show(given: Namespace) -> None:
    """Serve the page until a signal ends it."""
    logging.basicConfig(level=logging.WARNING, format="%(asctime)s %(levelname)s %(message)s")
    memory_use.settle()
    host, port = parse_listen(given.listen)
    clock = Clock()
    sessions = Sessions(PinFile(given.pin_file or default_pin_file()), clock)
    water = WaterChart(given.chart)
    key = None if given.sign_key is None else read_key_file(given.sign_key)
    station = Boats(given.connect, given.system_id, status_file=given.status, key=key)
    with contextlib.closing(station) as boats:
        sources = Sources(given.chart, given.boat)
        web_app = make_app(boats, water, sessions, _PAGE, clock, sources=sources, hosts=given.hosts)

        def on_open(number: int) -> None:
            name = f"[{host}]" if ":" in host else "127.0.0.1" if host == "0.0.0.0" else host  # noqa: S104
            _say(f"the page: http://{name}:{number}/")
            if not sessions.has_pin:
                _say("no PIN is set: the page only shows; set one with boat-shore pin")

        with busy_port_explained("choose another with --listen"):
            asyncio.run(serve(web_app, host, port, on_open))


def _set_pin(given: Namespace) -> None:
    """Set the PIN: from a person at a terminal, twice, or a line of standard input."""
    file = PinFile(given.pin_file or default_pin_file())
    if sys.stdin.isatty():
        told = getpass.getpass(f"PIN (at least {LEAST_CHARACTERS} digits or letters): ")
        if getpass.getpass("The same again: ") != told:
            raise ConfigError("expected the same PIN twice: nothing is changed")
    else:
        told = sys.stdin.readline().strip()
        if not told:
            raise ConfigError("expected a PIN on standard input")
    file.write(told)
    _say(f"{file.path}: PIN set")


def _say(line: str) -> None:
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


def run_program(arguments: list[str]) -> int:
    """Run the program; returns its exit code."""
    try:
        given = read_arguments(arguments)
        (_show if given.command == SHOW else _set_pin)(given)
    except SystemExit:  # the help is printed
        return 0
    except EOFError:  # Ctrl-D instead of a PIN
        return end_with(KeyboardInterrupt(), PROGRAM, arguments, expected=())
    except (Exception, KeyboardInterrupt) as error:
        return end_with(error, PROGRAM, arguments, expected=(BoatError, MissionToolsError))
    return 0
