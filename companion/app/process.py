"""The program as a process: only one a boat, its end by a signal, and its fresh start."""

import fcntl
import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType
from typing import NoReturn

from companion.core.errors import StorageError


@contextmanager
def only_program(folder: str) -> Iterator[None]:
    """Lock the folder of the boat's files, if there is one that can be locked.

    A second program would drive the same pins and write the same files.

    Raises:
        StorageError: another program has locked it.
    """
    descriptor = -1
    if folder:
        path = Path(folder).expanduser()
        with suppress(OSError):  # the storage will tell
            path.mkdir(parents=True, exist_ok=True)
            descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
    try:
        if descriptor >= 0:
            _lock(descriptor, folder)
        yield
    finally:
        if descriptor >= 0:
            os.close(descriptor)


def _lock(descriptor: int, folder: str) -> None:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise StorageError(
            f"{folder}: another program runs this boat: end it (sudo systemctl stop mavboat), or change "
            "storage.folder"
        ) from None
    except OSError:  # a file system without locks
        return


class Shutdown:
    """Remembers that a signal to stop has come. A loop asks it like a function."""

    def __init__(self) -> None:
        self.signal_number = 0

    def install(self) -> None:
        """Take over SIGINT, SIGTERM and SIGHUP. A second signal is left to the system's own way."""
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, self._on_signal)

    def __call__(self) -> bool:
        """Whether it is time to stop."""
        return self.signal_number != 0

    def _on_signal(self, number: int, frame: FrameType | None) -> None:  # noqa: ARG002
        self.signal_number = number
        signal.signal(number, signal.SIG_DFL)


def restart_program() -> NoReturn:
    """Replace this process by a fresh start of the same program with the same arguments.

    Everything must be closed by now. The process keeps its number: whoever watches over it sees no end.
    """
    sys.stdout.flush()
    sys.stderr.flush()
    os.execv(sys.executable, [sys.executable, *sys.orig_argv[1:]])  # noqa: S606
