"""The command line of boat-shore."""

import argparse
from argparse import ArgumentTypeError
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from companion.cli.parser import Parser

PROGRAM: Final = "boat-shore"
SHOW: Final = "show"  # the command without a name: serve the page
_MOST_SYSTEM_ID: Final = 254  # 255 is the usual number of a ground station on a laptop
_ABOUT = """Serve the boat's page until Ctrl-C or SIGTERM. It only shows until a PIN is set: boat-shore pin.

Example:  boat-shore --connect tcp:127.0.0.1:5760 --listen 0.0.0.0:8080"""
_ABOUT_PIN = """Set the PIN that the page asks for. Sessions opened with another one end.

Example:  boat-shore pin"""


def read_arguments(arguments: Sequence[str]) -> argparse.Namespace:
    """The options by name, and `command`: SHOW or "pin". SystemExit once help or version is printed."""
    is_pin = arguments[:1] == ["pin"]
    given = _pin_parser().read(arguments[1:]) if is_pin else _show_parser().read(arguments)
    given.command = "pin" if is_pin else SHOW
    return given


def _show_parser() -> Parser:
    parser = Parser(PROGRAM, _ABOUT, usage=f"{PROGRAM} [options]\n       {PROGRAM} pin [options]")
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
    parser.add_common(has_json=False)
    return parser


def _pin_parser() -> Parser:
    parser = Parser(f"{PROGRAM} pin", _ABOUT_PIN, usage=f"{PROGRAM} pin [options]")
    _add_pin_file(parser)
    parser.add_common(has_json=False)
    return parser


def _add_pin_file(parser: Parser) -> None:
    text = "the PIN's hash [under $XDG_STATE_HOME/mavboat]"
    parser.add_argument("--pin-file", metavar="FILE", type=Path, help=text)


def _system_id(text: str) -> int:
    if not text.isascii() or not text.isdecimal() or not 1 <= int(text[:4]) <= _MOST_SYSTEM_ID:
        raise ArgumentTypeError(f"{text!r} is not in 1..{_MOST_SYSTEM_ID}")
    return int(text)
