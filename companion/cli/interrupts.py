"""Ctrl-C at any time: one line and exit code 130, never a traceback.

The programs import for a second or more. During imports and interpreter shutdown, nothing needs cleaning up
and an interrupt ends the process at once. In between it is a KeyboardInterrupt.
"""

import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from types import FrameType

from companion.cli.program_end import INTERRUPTED, end, missing_extra

Run = Callable[[list[str]], int]
Handler = Callable[[int, FrameType | None], None]

_end_at_once: list[Handler] = []  # of the program that runs; empty while it is not to be interrupted


def program(name: str, module: str) -> tuple[Callable[[], None], Run]:
    """The entry point of a program whose module is slow to import, and what runs it in Python."""

    def load() -> Run:
        run: Run = import_module(module).run_program
        return run

    def main() -> None:
        sys.exit(run_interruptibly(name, load))

    def run_program(arguments: list[str]) -> int:
        return load()(arguments)

    return main, run_program


def run_interruptibly(name: str, load: Callable[[], Run]) -> int:
    """Load a program, run it with the command line's arguments, and return its exit code.

    load: does the slow imports and returns the program. Call it first, from the main thread.
    """
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # started in the background by a script
        return _loaded(name, load)(sys.argv[1:])

    def end_at_once(number: int, frame: FrameType | None) -> None:  # noqa: ARG001
        os.write(2, f"{name}: interrupted\n".encode())
        os._exit(INTERRUPTED)

    signal.signal(signal.SIGINT, end_at_once)
    _end_at_once[:] = [end_at_once]
    run = _loaded(name, load)
    try:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        code = run(sys.argv[1:])
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    except KeyboardInterrupt:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        sys.stderr.write(f"{name}: interrupted\n")
        return INTERRUPTED
    return code


def _loaded(name: str, load: Callable[[], Run]) -> Run:
    """The program; where its extra is not installed, one that says so."""
    try:
        return load()
    except ModuleNotFoundError as error:
        message = missing_extra(name, error)
        if message is None or "--debug" in sys.argv:
            raise
        return lambda arguments: end(name, message, 2, is_json="--json" in arguments)


@contextmanager
def importing() -> Iterator[None]:
    """Imports that a program does late: an interrupt ends it at once, as during its first imports.

    A KeyboardInterrupt within the import of a C extension may come out as another error.
    """
    if not _end_at_once or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        yield
        return
    signal.signal(signal.SIGINT, _end_at_once[0])
    yield
    signal.signal(signal.SIGINT, signal.default_int_handler)
