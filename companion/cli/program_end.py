"""How a program ends: at most one line for an error, and the exit code.

0 done, 1 the job failed, 2 wrong usage or input, 3 no vehicle or link, 130 interrupted.
"""

import errno
import json
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Final

from companion.core.errors import BoatError, LinkError

INTERRUPTED = 130  # 128 + SIGINT, as in shells


def end(
    name: str, message: str, code: int, *, is_json: bool, figures: Mapping[str, object] | None = None
) -> int:
    """Print one line to stderr, with --json also an object to stdout; returns the exit code."""
    sys.stderr.write(f"{name}: {message}\n")
    if is_json:
        tree = {"ok": False, "exit_code": code, "error": message, **(figures or {})}
        sys.stdout.write(json.dumps(tree) + "\n")
    return code


def end_with(
    error: BaseException, name: str, arguments: Sequence[str], expected: tuple[type[Exception], ...]
) -> int:
    """The exit code after an error. With --debug every error keeps its traceback.

    expected: roots of the errors that a user can correct; each has its own `exit_code`.
    """
    is_json = "--json" in arguments
    if isinstance(error, KeyboardInterrupt):
        return end(name, "interrupted", INTERRUPTED, is_json=is_json)
    if "--debug" in arguments or not isinstance(error, Exception):
        raise error
    if isinstance(error, expected):
        code, figures = getattr(error, "exit_code", 1), getattr(error, "figures", None)
        return end(name, str(error), code, is_json=is_json, figures=figures)
    missing = missing_extra(name, error)
    if missing is not None:
        return end(name, missing, 2, is_json=is_json)
    if isinstance(error, OSError) and isinstance(error.filename, str):
        return end(name, f"{error.filename}: {error.strerror}", 1, is_json=is_json)
    return end(name, f"unexpected {error!r}: please report it, with what --debug says", 1, is_json=is_json)


_OURS: Final = ("companion", "mission_tools", "sitl")
_OF_PROGRAM: Final = {"boat-shore": "web", "boat-sitl": "sitl", "boat-survey": "survey"} | {
    f"mission-{name}": "planner" for name in ("check", "download", "plan", "trace", "upload")
}


def how_to_install(extra: str) -> str:
    """What installs an extra. The package is on no index: its sources or its wheel are at hand."""
    return f"pip install '.[{extra}]' in a clone of mavboat, or 'FILE.whl[{extra}]' with its wheel"


def missing_extra(program: str, error: BaseException) -> str | None:
    """The message about the extra that a program needs; None unless a package of others is missing."""
    if not isinstance(error, ModuleNotFoundError) or error.name is None:
        return None
    package = error.name.partition(".")[0]
    if package in _OURS:
        return None
    extra = _OF_PROGRAM.get(program)
    if extra is None:  # the base of the package is incomplete
        return f"the Python module {package!r} is missing: pip install . in a clone of mavboat"
    return f"needs the extra {extra!r} (no module {package!r}): {how_to_install(extra)}"


class PortInUseError(BoatError):
    """Another program uses the port."""

    exit_code = 2


@contextmanager
def busy_port_explained(advice: str) -> Iterator[None]:
    """A PortInUseError in place of its LinkError. advice: how to choose another port."""
    try:
        yield
    except LinkError as error:
        if os.strerror(errno.EADDRINUSE) not in str(error):
            raise
        raise PortInUseError(
            f"{error}: another program has this port, perhaps an earlier start of this one (ss -tulpn lists "
            f"them): end it, or {advice}"
        ) from None
