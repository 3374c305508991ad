"""A child process that outlives the restart of its parent, whose number stays."""

import json
import os
import select
import signal
import subprocess
from pathlib import Path
from typing import NamedTuple

_VARIABLE = "BOAT_SITL_SHORE_PAGE"  # from this program to its own next start


class KeptPage(NamedTuple):
    """What the next start of the emulator has to know of its page. number: the UDP port of its link."""

    process: int
    folder: Path
    number: int
    pin: str
    address: str


def hand_over(page: KeptPage) -> None:
    """For the next start of this process."""
    os.environ[_VARIABLE] = json.dumps(page._asdict() | {"folder": str(page.folder)})


def take_over() -> KeptPage | None:
    """What the start before has handed over, if that child still runs."""
    text = os.environ.pop(_VARIABLE, None)
    if text is None:
        return None
    told = json.loads(text)
    page = KeptPage(**{**told, "folder": Path(told["folder"])})
    try:
        has_ended = os.waitid(os.P_PID, page.process, os.WEXITED | os.WNOHANG | os.WNOWAIT)
    except ChildProcessError:  # no child of this process
        return None
    return page if has_ended is None else None


class KeptChild:
    """A child by its number, with as much of `subprocess.Popen` as is needed."""

    stdout = None

    def __init__(self, process: int) -> None:
        self.pid = process
        self._handle = os.pidfd_open(process)
        self._code: int | None = None

    def wait(self, timeout: float | None = None) -> int:
        """Its exit code; negative: the signal that ended it.

        Raises:
            subprocess.TimeoutExpired: it still runs.
        """
        if self._code is None:
            poll = select.poll()
            poll.register(self._handle, select.POLLIN)
            if not poll.poll(None if timeout is None else timeout * 1e3):
                raise subprocess.TimeoutExpired(str(self.pid), timeout or 0.0)
            try:
                self._code = os.waitstatus_to_exitcode(os.waitpid(self.pid, 0)[1])
            except ChildProcessError:  # another thread has waited for it
                self._code = self._code or 0
        return self._code

    def terminate(self) -> None:
        """Ask it to end."""
        self._send(signal.SIGTERM)

    def kill(self) -> None:
        """End it."""
        self._send(signal.SIGKILL)

    def _send(self, number: signal.Signals) -> None:
        if self._code is None:
            signal.pidfd_send_signal(self._handle, number)
