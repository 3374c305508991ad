"""The program as a process: only one a boat, its end by a signal, and its fresh start."""

import contextlib
import fcntl
import os
import signal
import socket
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType
from typing import Final, NoReturn

from companion.core.errors import StorageError


@contextmanager
def only_program(folder: str) -> Iterator[None]:
    """Lock the folder of the boat's files, if there is one that can be locked.

    A second program would drive the same pins and write the same files: it gets a StorageError.
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


_USEC: Final = 1e6
RESTART_WATCHDOG_S: Final = 30.0  # while the program replaces itself: imports take 10 s on a Pi Zero 2


class ServiceNotifier:
    """Reports readiness, the watchdog's keep-alive, one status line, and the end. No call blocks or raises.

    A message that the manager's full queue does not take is sent again at the next tick.
    """

    def __init__(self, environment: Mapping[str, str]) -> None:
        address = environment.get("NOTIFY_SOCKET", "")  # @: the abstract namespace
        self._address = "\0" + address[1:] if address.startswith("@") else address
        self._watchdog_usec = _watchdog_usec(environment)
        self._socket: socket.socket | None = None
        self._is_ready = False
        self._status = ""
        self._due_s = 0.0
        if self._address.startswith(("/", "\0")):
            self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_CLOEXEC)
            self._socket.setblocking(False)

    @property
    def is_supervised(self) -> bool:
        """Whether a service manager has started the program."""
        return self._socket is not None

    def tick(self, now_s: float, status: str) -> None:
        """To be called at the end of every tick. status: one line, sent when it changes."""
        lines = []
        if not self._is_ready:
            lines.append("READY=1")
            if self._watchdog_usec:  # `restarting` may have changed it
                lines.append(f"WATCHDOG_USEC={self._watchdog_usec}")
        if status != self._status:
            lines.append(f"STATUS={status}")
        if self._watchdog_usec and now_s >= self._due_s:
            lines.append("WATCHDOG=1")
        if lines and self._send(lines):
            self._is_ready = True
            self._status = status
            self._due_s = now_s + self._watchdog_usec / 2.0 / _USEC  # as sd_watchdog_enabled(3) recommends

    def restarting(self) -> None:
        """The process is about to be replaced by a fresh start of the program."""
        lines = ["RELOADING=1"]
        if self._watchdog_usec:
            lines += [f"WATCHDOG_USEC={RESTART_WATCHDOG_S * _USEC:.0f}", "WATCHDOG=1"]
        if self._is_ready:
            self._send(lines)

    def stopping(self) -> None:
        """Tell the manager that the program ends."""
        self._send(["STOPPING=1"])

    def close(self) -> None:
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def _send(self, lines: list[str]) -> bool:
        if self._socket is None:
            return True
        with contextlib.suppress(OSError):
            self._socket.sendto("\n".join(lines).encode(), self._address)
            return True
        return False


def _watchdog_usec(environment: Mapping[str, str]) -> int:
    """0 without a watchdog, or with one for another process."""
    own, usec = str(os.getpid()), environment.get("WATCHDOG_USEC", "")
    is_for_us = environment.get("WATCHDOG_PID", own) == own
    return int(usec) if is_for_us and usec.isascii() and usec.isdigit() else 0
