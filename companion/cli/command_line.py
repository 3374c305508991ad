"""Programs with several commands. A command is a function: its parameters, annotated with Option or Argument,
are its command line, and its docstring is its help.
"""

import functools
import importlib
import inspect
import sys
import types
from argparse import SUPPRESS, ArgumentTypeError, Namespace
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Final, Literal, Union, get_args, get_origin, get_type_hints

from companion.cli.interrupts import importing
from companion.cli.parser import Parser, number
from companion.cli.program_end import end_with
from companion.core.errors import UsageError

Command = Callable[..., int | None]

_NO_VALUE: Final = (None, False, "")


class Option:
    """An option. names: with their dashes; by default the parameter's. least, most: bounds of a number."""

    def __init__(
        self,
        *names: str,
        help: str = "",
        metavar: str | None = None,
        least: float | None = None,
        most: float | None = None,
        is_hidden: bool = False,
    ) -> None:
        self.names, self.help, self.metavar = names, help, metavar
        self.least, self.most, self.is_hidden = least, most, is_hidden


ConfigFile = Annotated[Path, Option("--config", "-c", help="The boat's TOML file.")]


@dataclass(frozen=True)
class Argument:
    """The argument without a name; several of a list."""

    metavar: str
    help: str


@dataclass(frozen=True)
class Program:
    """A program. name: as it is started. text: what it is. commands: functions, or MODULE:FUNCTION to be
    imported when it is called. expected: roots of the errors that a user can correct; each has its own
    `exit_code`.
    """

    name: str
    text: str
    commands: Sequence[Command | str]
    expected: tuple[type[Exception], ...]

    def run(self, arguments: Sequence[str]) -> int:
        """Run the command that is named; returns the exit code. With --debug errors keep their traceback."""
        rest = [argument for argument in arguments if argument != "--debug"]
        try:
            if not rest:
                self._parser().print_help(sys.stderr)
                return 2
            named = {_typed(command): command for command in self.commands}
            if rest[0] not in named:
                self._parser().read(rest[:1])  # --help, --version, or an error that says what is wrong
            command = _function(named[rest[0]])
            given = command_parser(self.name, command).read(rest[1:])
            return command(**_values(command, given)) or 0
        except SystemExit as done:  # --help and --version
            return done.code if isinstance(done.code, int) else 0
        except (KeyboardInterrupt, Exception) as error:
            return end_with(error, self.name, arguments, (UsageError, *self.expected))

    def by_name(self) -> dict[str, Command]:
        """The commands under the names that a user types."""
        return {_typed(command): _function(command) for command in self.commands}

    def _parser(self) -> Parser:
        known = self.by_name()
        width = max(len(name) for name in known)
        lines = [f"  {name:{width}}  {_first_sentence(command)}" for name, command in known.items()]
        text = "\n".join([self.text, "", "commands:", *lines])
        parser = Parser(self.name, text, usage=f"{self.name} [options] COMMAND ...")
        parser.add_common(has_json=False)
        return parser


def _typed(command: Command | str) -> str:
    name = command if isinstance(command, str) else command.__name__
    return name.rpartition(":")[2].replace("_", "-")


def _function(command: Command | str) -> Command:
    if not isinstance(command, str):
        return command
    module, _, name = command.partition(":")
    with importing():
        function: Command = getattr(importlib.import_module(module), name)
        return function


def echo(text: str, *, is_error: bool = False, newline: str = "\n") -> None:
    """Print a line to stdout, or to stderr."""
    stream = sys.stderr if is_error else sys.stdout
    stream.write(text + newline)
    stream.flush()


def ask(question: str, default: str | None = None) -> str:
    """The user's answer; an empty one stands for the default, without which the question is repeated. The end
    of the input is a KeyboardInterrupt.
    """
    shown = f" [{default}]" if default else ""
    while True:
        try:
            answer = input(f"{question}{shown}: ").strip()
        except EOFError:
            raise KeyboardInterrupt from None
        if answer or default is not None:
            return answer or str(default)


def command_parser(program: str, command: Command) -> Parser:
    """The parser of one command."""
    parameters = _parameters(command)
    argument = next((one for one in parameters if isinstance(one.made, Argument)), None)
    positional = argument.made.metavar if argument is not None else ""
    text = inspect.getdoc(command) or ""
    if argument is not None:
        text = f"{text}\n\n{positional}: {argument.made.help}{argument.default_text}"
    name = f"{program} {command.__name__.replace('_', '-')}"
    is_required = argument is not None and argument.is_required
    takes_many = argument is not None and argument.is_list
    parser = Parser(name, text, positional, is_required=is_required, takes_many=takes_many)
    for one in parameters:
        if isinstance(one.made, Option):
            one.add_to(parser)
    parser.add_common(has_json=False)
    return parser


@dataclass(frozen=True)
class _Parameter:
    name: str
    made: Any  # Option or Argument
    kind: Any  # the type of one value
    is_list: bool
    default: Any

    @property
    def is_required(self) -> bool:
        return self.default is inspect.Parameter.empty

    @property
    def default_text(self) -> str:
        is_told = self.is_required or any(self.default is one or self.default == one for one in _NO_VALUE)
        return "" if is_told or self.made.help.endswith("]") else f" [{self.default}]"

    def add_to(self, parser: Parser) -> None:
        option: Option = self.made
        names = option.names or (f"--{self.name.replace('_', '-')}",)
        about: dict[str, Any] = {"dest": self.name, "help": SUPPRESS if option.is_hidden else option.help}
        if self.kind is bool:
            parser.add_argument(*names, action="store_true", **about)
            return
        about["help"] += "" if option.is_hidden else self.default_text
        if get_origin(self.kind) is Literal:
            about["choices"] = get_args(self.kind)
        else:
            about["metavar"] = option.metavar or self.name.removesuffix("_m").upper()
            about["type"] = functools.partial(_converted, kind=self.kind, option=option)
        parser.add_argument(
            *names,
            action="append" if self.is_list else "store",
            required=self.is_required,
            default=None if self.is_required else self.default,
            **about,
        )


def _parameters(command: Command) -> list[_Parameter]:
    hints = get_type_hints(command, include_extras=True)
    found = []
    for parameter in inspect.signature(command).parameters.values():
        kind, made = get_args(hints[parameter.name])
        if get_origin(kind) in (Union, types.UnionType):
            kind = next(one for one in get_args(kind) if one is not type(None))
        is_list = get_origin(kind) is list
        kind = get_args(kind)[0] if is_list else kind
        found.append(_Parameter(parameter.name, made, kind, is_list, parameter.default))
    return found


def _values(command: Command, given: Namespace) -> dict[str, Any]:
    """The arguments of the call; an Argument that was left out keeps its default."""
    values = {}
    for one in _parameters(command):
        if isinstance(one.made, Option):
            values[one.name] = getattr(given, one.name)
        elif one.is_list:
            values[one.name] = [one.kind(source) for source in given.sources]
        elif given.source is not None:
            values[one.name] = one.kind(given.source)
    return values


def _converted(text: str, kind: Any, option: Option) -> Any:  # noqa: ANN401 (of the type that is named)
    if kind in (str, Path):
        return kind(text)
    try:
        value = int(text) if kind is int else number(text)
    except ValueError:
        raise ArgumentTypeError(f"{text!r} is not a whole number") from None
    if option.least is not None and value < option.least:
        raise ArgumentTypeError(f"{text} is less than {option.least:g}")
    if option.most is not None and value > option.most:
        raise ArgumentTypeError(f"{text} is more than {option.most:g}")
    return value


def _first_sentence(command: Command) -> str:
    paragraph = " ".join((inspect.getdoc(command) or "").partition("\n\n")[0].split())
    return paragraph.partition(". ")[0].removesuffix(".")
