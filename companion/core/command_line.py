"""Common end of a command-line program: one line for an error, and the exit code.

0 done, 1 the job failed, 2 wrong usage or input, 3 no vehicle or link, 130 interrupted.
"""

import errno
import json
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Annotated

import typer

from companion import __version__
from companion.core.errors import BoatError, LinkError
from companion.core.interrupts import INTERRUPTED

HELP_NAMES = {"help_option_names": ["-h", "--help"]}


def _print_version(is_asked: bool) -> None:
    if is_asked:
        typer.echo(__version__)
        raise typer.Exit


Version = Annotated[
    bool, typer.Option("--version", callback=_print_version, is_eager=True, help="print the version and exit")
]


class PortInUseError(BoatError):
    """Another program uses the port."""

    exit_code = 2


@contextmanager
def busy_port_explained(advice: str) -> Iterator[None]:
    """Explain what to do about a port in use. advice: how to choose another port.

    Raises:
        PortInUseError: in place of the LinkError.
    """
    try:
        yield
    except LinkError as error:
        if os.strerror(errno.EADDRINUSE) not in str(error):
            raise
        raise PortInUseError(
            f"{error}: another program has this port, perhaps an earlier start of this one (ss -tulpn lists "
            f"them): end it, or {advice}"
        ) from None


def run_app(
    app: typer.Typer, name: str, arguments: Sequence[str], expected: tuple[type[Exception], ...]
) -> int:
    """Run a typer app and return the exit code. With --debug every error keeps its traceback.

    expected: roots of the errors that a user can correct; each has its own `exit_code`.
    """
    is_debug, is_json = "--debug" in arguments, "--json" in arguments
    try:
        code = app(args=list(arguments), prog_name=name, standalone_mode=False)
    except (KeyboardInterrupt, typer.Abort):
        return _end(name, "interrupted", INTERRUPTED, is_json)
    except expected as error:
        if is_debug:
            raise
        return _end(name, str(error), getattr(error, "exit_code", 1), is_json)
    except Exception as error:
        message: Callable[[], str] | None = getattr(error, "format_message", None)
        if type(error).__name__ == "NoArgsIsHelpError" and message is not None:
            sys.stderr.write(message() + "\n")
            return 2
        if message is not None:  # typer's own usage error
            return _end(name, f"{' '.join(message().split())} (see {name} --help)", 2, is_json)
        if is_debug:
            raise
        if isinstance(error, OSError) and isinstance(error.filename, str):
            return _end(name, f"{error.filename}: {error.strerror}", 1, is_json)
        return _end(name, f"unexpected {error!r}: please report it, with what --debug says", 1, is_json)
    if code == INTERRUPTED:  # some versions of typer turn the interrupt into this
        return _end(name, "interrupted", INTERRUPTED, is_json)
    return code if isinstance(code, int) else 0


def _end(name: str, message: str, code: int, is_json: bool) -> int:
    sys.stderr.write(f"{name}: {message}\n")
    if is_json:
        sys.stdout.write(json.dumps({"ok": False, "exit_code": code, "error": message}) + "\n")
    return code
