"""How a program ends: at most one line for an error, and the exit code.

0 done, 1 the job failed, 2 wrong usage or input, 3 no vehicle or link, 130 interrupted.
"""

import json
import sys
from collections.abc import Sequence

from companion.cli.extras import missing_extra

INTERRUPTED = 130  # 128 + SIGINT, as in shells


def end(name: str, message: str, code: int, *, is_json: bool) -> int:
    """Print one line to stderr, with --json also an object to stdout; returns the exit code."""
    sys.stderr.write(f"{name}: {message}\n")
    if is_json:
        sys.stdout.write(json.dumps({"ok": False, "exit_code": code, "error": message}) + "\n")
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
        return end(name, str(error), getattr(error, "exit_code", 1), is_json=is_json)
    missing = missing_extra(name, error)
    if missing is not None:
        return end(name, missing, 2, is_json=is_json)
    if isinstance(error, OSError) and isinstance(error.filename, str):
        return end(name, f"{error.filename}: {error.strerror}", 1, is_json=is_json)
    return end(name, f"unexpected {error!r}: please report it, with what --debug says", 1, is_json=is_json)
