"""Command-line programs built on typer: they end as `program_end` says."""

import sys
from collections.abc import Callable, Sequence
from typing import Annotated

import typer

from companion import __version__
from companion.cli.program_end import INTERRUPTED, end, end_with

HELP_NAMES = {"help_option_names": ["-h", "--help"]}


def _print_version(is_asked: bool) -> None:
    if is_asked:
        typer.echo(__version__)
        raise typer.Exit


Version = Annotated[
    bool, typer.Option("--version", callback=_print_version, is_eager=True, help="print the version and exit")
]


def _options(
    debug: Annotated[bool, typer.Option("--debug", help="a traceback with every error")] = False,
    version: Version = False,
) -> None:
    """What goes before the command; --debug is looked for where errors end."""


def program_app(text: str) -> typer.Typer:
    """The app of a program with several commands. text: what the program is."""
    app = typer.Typer(
        no_args_is_help=True,
        add_completion=False,
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
        context_settings=HELP_NAMES,
        help=text,
    )
    app.callback()(_options)
    return app


def run_app(
    app: typer.Typer, name: str, arguments: Sequence[str], expected: tuple[type[Exception], ...]
) -> int:
    """Run a typer app and return the exit code. With --debug every error keeps its traceback.

    expected: roots of the errors that a user can correct; each has its own `exit_code`.
    """
    is_json = "--json" in arguments
    try:
        code = app(args=list(arguments), prog_name=name, standalone_mode=False)
    except typer.Abort:
        return end(name, "interrupted", INTERRUPTED, is_json=is_json)
    except KeyboardInterrupt as error:
        return end_with(error, name, arguments, expected)
    except expected as error:
        return end_with(error, name, arguments, expected)
    except Exception as error:
        message: Callable[[], str] | None = getattr(error, "format_message", None)
        if type(error).__name__ == "NoArgsIsHelpError" and message is not None:
            sys.stderr.write(message() + "\n")
            return 2
        if message is not None:  # typer's own usage error
            return end(name, f"{' '.join(message().split())} (see {name} --help)", 2, is_json=is_json)
        return end_with(error, name, arguments, expected)
    if code == INTERRUPTED:  # some versions of typer turn the interrupt into this
        return end(name, "interrupted", INTERRUPTED, is_json=is_json)
    return code if isinstance(code, int) else 0
