"""The command-line parser of all programs: argparse, which is loaded in 20 ms.

Options may stand before and after the file they belong to, a value may begin with a minus sign
(`--goal -33.8,151.2`), and a mistake is a UsageError.
"""

import argparse
import math
import re
import shutil
from argparse import ArgumentTypeError
from collections.abc import Iterable, Sequence
from typing import Any, NoReturn

from companion import __version__
from companion.core.errors import UsageError

_NEGATIVE = re.compile(r"-[\d.]")


class _Help(argparse.RawDescriptionHelpFormatter):
    """One column for options, as wide as the terminal."""

    def __init__(self, prog: str) -> None:
        super().__init__(prog, max_help_position=30, width=min(shutil.get_terminal_size().columns, 110))

    def add_usage(
        self,
        usage: str | None,
        actions: Iterable[argparse.Action],
        groups: Iterable[Any],
        prefix: str | None = None,  # noqa: ARG002 - argparse passes none
    ) -> None:
        super().add_usage(usage, actions, groups, "Usage: ")


class Parser(argparse.ArgumentParser):
    """A parser of one program. positional: the name of its argument, if any. takes_many: or several."""

    def __init__(
        self,
        program: str,
        description: str,
        positional: str = "",
        *,
        usage: str = "",
        is_required: bool = False,
        takes_many: bool = False,
    ) -> None:
        shown = f" {positional}{'…' * takes_many}" if is_required else f" [{positional}]"
        usage = usage or f"{program} [options]{shown if positional else ''}"
        super().__init__(
            program,
            usage,
            description,
            formatter_class=_Help,
            add_help=False,
            allow_abbrev=False,
            exit_on_error=False,
        )
        self._positional = positional
        self._is_required = is_required
        self._takes_many = takes_many

    def add_common(self, *, has_json: bool = True) -> None:
        """--json, --debug, --version and --help, which every program has."""
        group = self.add_argument_group("general")
        if has_json:
            group.add_argument("--json", action="store_true", dest="as_json", help="result as JSON on stdout")
        group.add_argument("--debug", action="store_true", help="log everything; tracebacks")
        group.add_argument("--version", action="version", version=__version__, help="print the version")
        group.add_argument("-h", "--help", action="help", help="print this text")

    def read(self, arguments: Sequence[str]) -> argparse.Namespace:
        """Parse; the positional argument is `source`, None without, and all of them are `sources`. A
        UsageError says what was expected.
        """
        try:
            given, rest = self.parse_known_args(self._with_negative_values(arguments))
        except argparse.ArgumentError as error:
            if error.message.startswith("expected"):
                self.error(f"{error.argument_name}: {error.message}")
            self.error(f"Invalid value for '{error.argument_name}': {error.message}")
        unknown = [argument for argument in rest if argument.startswith("-") and argument not in ("-", "--")]
        if unknown:
            self.error(f"No such option: {unknown[0]}")
        named = [argument for argument in rest if argument != "--"]
        if named and not self._positional:
            self.error(f"No such command: {named[0]}")
        if len(named) > 1 and not self._takes_many:
            self.error(f"one {self._positional} is expected, not also {' '.join(named[1:])}")
        if self._is_required and not named:
            self.error(f"{self._positional} is missing")
        given.source, given.sources = named[0] if named else None, named
        return given

    def error(self, message: str) -> NoReturn:
        """Raise UsageError, with advice."""
        said = message.replace("the following arguments are required:", "Missing option")
        raise UsageError(f"{said} (see {self.prog} --help)")

    def _with_negative_values(self, arguments: Sequence[str]) -> list[str]:
        """`--goal -33.8,151.2` as one word, because argparse takes the second for an option."""
        joined: list[str] = []
        for argument in arguments:
            before = joined[-1] if joined else ""
            action = self._option_string_actions.get(before)
            if action is not None and action.nargs is None and _NEGATIVE.match(argument):
                joined[-1] = f"{before}={argument}"
            else:
                joined.append(argument)
        return joined


def number(text: str) -> float:
    """A finite number, for `type=`."""
    try:
        value = float(text)
    except ValueError:
        raise ArgumentTypeError(f"{text!r} is not a number") from None
    if math.isnan(value):
        raise ArgumentTypeError(f"{text!r} is not a number")
    return value


def system_id(text: str) -> int:
    """A MAVLink system id, for `type=`."""
    if not text.isascii() or not text.isdecimal() or not 1 <= int(text[:4]) <= 255:
        raise ArgumentTypeError(f"{text!r} is not in 1..255")
    return int(text)
