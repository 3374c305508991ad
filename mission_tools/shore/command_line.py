"""The command line of boat-shore.

argparse, as in the planner's programs: typer and its pydantic would keep 10 MB for as long as the page is
served.
"""

import argparse
import shutil
from argparse import ArgumentTypeError
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, Final, NoReturn

from companion import __version__
from companion.core.errors import BoatError

PROGRAM: Final = "boat-shore"
SHOW: Final = "show"  # the command without a name: serve the page
_LONGEST_LINE: Final = 110
_MOST_SYSTEM_ID: Final = 254  # 255 is the usual number of a ground station on a laptop
_ABOUT = """Serve the boat's page until Ctrl-C or SIGTERM. It only shows until a PIN is set: boat-shore pin.

Example:  boat-shore --connect tcp:127.0.0.1:5760 --listen 0.0.0.0:8080"""
_ABOUT_PIN = """Set the PIN that the page asks for. Sessions opened with another one end.

Example:  boat-shore pin"""


class UsageError(BoatError):
    """The command line is not as expected."""

    exit_code = 2


class _Help(argparse.RawDescriptionHelpFormatter):
    """One column for options, as wide as the terminal."""

    def __init__(self, prog: str) -> None:
        width = min(shutil.get_terminal_size().columns, _LONGEST_LINE)
        super().__init__(prog, max_help_position=26, width=width)

    def add_usage(
        self,
        usage: str | None,
        actions: Iterable[argparse.Action],
        groups: Iterable[Any],
        prefix: str | None = None,  # noqa: ARG002 (argparse passes none)
    ) -> None:
        super().add_usage(usage, actions, groups, "Usage: ")


class _Parser(argparse.ArgumentParser):
    """A parser whose mistakes are UsageErrors."""

    def __init__(self, prog: str, usage: str, about: str) -> None:
        super().__init__(
            prog,
            usage,
            about,
            formatter_class=_Help,
            add_help=False,
            allow_abbrev=False,
            exit_on_error=False,
        )

    def error(self, message: str) -> NoReturn:
        """Raise:
        UsageError: with advice.
        """
        raise UsageError(f"{message} (see {self.prog} --help)")


def read_arguments(arguments: Sequence[str]) -> argparse.Namespace:
    """The options by name, and `command`: SHOW or "pin".

    Raises:
        UsageError: names the option and what was expected.
        SystemExit: the help or the version was asked for, and is printed.
    """
    show, pin = _show_parser(), _pin_parser()
    parser, command = (pin, "pin") if arguments[:1] == ["pin"] else (show, SHOW)
    try:
        given, rest = parser.parse_known_args(arguments[1:] if parser is pin else arguments)
    except argparse.ArgumentError as error:
        if error.message.startswith("expected"):
            parser.error(f"{error.argument_name}: {error.message}")
        parser.error(f"Invalid value for '{error.argument_name}': {error.message}")
    if rest:
        kind = "option" if rest[0].startswith("-") else "command"
        parser.error(f"No such {kind}: {rest[0]}")
    given.command = command
    return given


def _show_parser() -> _Parser:
    parser = _Parser(PROGRAM, f"{PROGRAM} [options]\n       {PROGRAM} pin [options]", _ABOUT)
    add = parser.add_argument
    add("--connect", metavar="URL", default="tcp:127.0.0.1:5760",
        help="the link to the boat, as for a ground station [%(default)s]")  # fmt: skip
    add("--listen", metavar="HOST:PORT", default="127.0.0.1:8080",
        help="address of the page; 0.0.0.0:80 opens it to the boat's network [%(default)s]")  # fmt: skip
    add("--map", metavar="FILE", type=Path, dest="chart", help="GeoJSON map of the water")
    add("--boat", metavar="FILE",
        help="the boat's TOML, for time and charge of plans (also an emulated boat: lake, kit)")  # fmt: skip
    add("--sign-key", metavar="FILE", type=Path, help="key of a signed link; only signed messages count")
    add("--status", metavar="FILE", type=Path, help="status file of the boat on this computer")
    add("--host", metavar="NAME", action="append", default=[], dest="hosts",
        help="further name of this computer in the page's address; repeatable")  # fmt: skip
    _add_pin_file(parser)
    add(
        "--system-id",
        metavar="N",
        type=_system_id,
        default=250,
        help="system id of this station [%(default)s]",
    )
    _add_common(parser)
    return parser


def _pin_parser() -> _Parser:
    parser = _Parser(f"{PROGRAM} pin", f"{PROGRAM} pin [options]", _ABOUT_PIN)
    _add_pin_file(parser)
    _add_common(parser)
    return parser


def _add_pin_file(parser: _Parser) -> None:
    text = "the PIN's hash [under $XDG_STATE_HOME/mavboat]"
    parser.add_argument("--pin-file", metavar="FILE", type=Path, help=text)


def _add_common(parser: _Parser) -> None:
    group = parser.add_argument_group("general")
    group.add_argument("--debug", action="store_true", help="a traceback with every error")
    group.add_argument("--version", action="version", version=__version__, help="print the version and exit")
    group.add_argument("-h", "--help", action="help", help="print this text and exit")


def _system_id(text: str) -> int:
    if not text.isascii() or not text.isdecimal() or not 1 <= int(text[:4]) <= _MOST_SYSTEM_ID:
        raise ArgumentTypeError(f"{text!r} is not in 1..{_MOST_SYSTEM_ID}")
    return int(text)
