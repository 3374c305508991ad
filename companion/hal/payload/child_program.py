"""Programs of the owner's: in a process group of their own, with a time limit, their output in the log.

A thread starts the program and reads its output, so that the tick does not wait. When the program ends, or
its time is over, its whole group is ended.
"""

import contextlib
import logging
import os
import select
import shutil
import signal
import subprocess
import threading
import time
from collections.abc import Sequence
from pathlib import Path

from companion.config.payload import CameraSetting
from companion.core.status_text import one_line

logger = logging.getLogger(__name__)

_MOST_LINES = 200  # of a run, in the log
_LONGEST_LINE = 500
_GRACE_S = 2.0  # from SIGTERM to SIGKILL
_LOOK_S = 0.1  # how often the thread checks for the end
_CHUNK = 4096  # bytes in a read
_FULL_PIPE = 16  # reads that empty a pipe: 64 KiB, pipe(7)
_PRIVATE = ("NOTIFY_SOCKET", "WATCHDOG_PID", "WATCHDOG_USEC")  # between systemd and the boat's program
_FILE = "{file}"
_MB = 1e6


class ChildProgram:
    """One program; one run at a time."""

    def __init__(self, title: str, run: Sequence[str], timeout_s: float, folder: str = "") -> None:
        """run: the program and its arguments. folder: its working directory, empty for the boat's."""
        self._title = title
        self._arguments = list(run)
        self._timeout_s = timeout_s
        self._folder = folder or None
        self._thread: threading.Thread | None = None
        self._end: str | None = None  # of the last run, until told
        self._stop = threading.Event()

    @property
    def is_running(self) -> bool:
        return self._thread is not None and self._thread.is_alive()

    def start(self) -> str:
        self._begin(self._arguments)
        return ""

    def _begin(self, arguments: list[str]) -> None:
        if self.is_running or self._stop.is_set():
            return
        self._end = None
        self._thread = threading.Thread(target=self._run, args=(arguments,), name=self._title, daemon=True)
        self._thread.start()

    def poll(self) -> str | None:
        if self.is_running:
            return None
        end, self._end = self._end, None
        return end

    def end(self) -> None:
        self._stop.set()

    def close(self) -> None:
        self.end()
        if self._thread is not None:
            self._thread.join(_GRACE_S + 1.0)

    def _run(self, arguments: list[str]) -> None:
        environment = {name: value for name, value in os.environ.items() if name not in _PRIVATE}
        try:
            process = subprocess.Popen(  # noqa: S603  the owner's own list, without a shell
                arguments,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                cwd=self._folder,
                env=environment,
                start_new_session=True,
            )
        except OSError as error:
            self._end = f"cannot be started: {error.strerror or error}"
            return
        with process:
            end = self._follow(process)
            _end_group(process)
        code = process.returncode
        if not end and code:
            end = f"exit code {code}" if code > 0 else f"ended by signal {signal.Signals(-code).name}"
        self._end = end or self._verify()

    def _verify(self) -> str:
        """What is missing after a run that ended well; empty if nothing."""
        return ""

    def _follow(self, process: subprocess.Popen[bytes]) -> str:
        """Read the output until the program ends. Returns why it has to be ended, or empty."""
        deadline_s = time.monotonic() + self._timeout_s
        fileno = -1 if process.stdout is None else process.stdout.fileno()
        rest, lines, is_open = b"", 0, True
        while process.poll() is None:
            if self._stop.is_set():
                return "the boat's program ends"
            if time.monotonic() >= deadline_s:
                return f"not done within {self._timeout_s:g} s"
            if not is_open:
                time.sleep(_LOOK_S)
            elif select.select([fileno], [], [], _LOOK_S)[0]:
                rest, lines, is_open = self._log(fileno, rest, lines)
        for _ in range(_FULL_PIPE):  # what a program of its own goes on to write is not waited for
            if not is_open or not select.select([fileno], [], [], 0.0)[0]:
                break
            rest, lines, is_open = self._log(fileno, rest, lines)
        if rest and lines < _MOST_LINES:
            self._log_line(rest)
        return ""

    def _log(self, fileno: int, rest: bytes, lines: int) -> tuple[bytes, int, bool]:
        """Log whole lines. Returns the rest of the last, the number of lines, and whether more can come."""
        chunk = os.read(fileno, _CHUNK)
        *whole, rest = (rest + chunk).split(b"\n")
        for line in whole:
            lines += 1
            if lines <= _MOST_LINES:
                self._log_line(line)
            elif lines == _MOST_LINES + 1:
                logger.info("%s: more lines are left out", self._title)
        return rest[-_LONGEST_LINE:], lines, bool(chunk)

    def _log_line(self, line: bytes) -> None:
        text = line[:_LONGEST_LINE].decode("utf-8", "replace")
        logger.info("%s: %s", self._title, one_line(text))


def _end_group(process: subprocess.Popen[bytes]) -> None:
    """End the program, if it still runs, and what it has started."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGTERM)
        if process.poll() is None:
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(_GRACE_S)
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


class CaptureProgram(ChildProgram):
    """The command that takes an image. Images are numbered on from those in the folder."""

    def __init__(self, setting: CameraSetting) -> None:
        super().__init__("camera", setting.capture, setting.capture_timeout_s)
        self._images = Path(setting.folder).expanduser() if setting.folder else None
        self._number = 0
        self._path = ""  # of the latest image
        self._space_mb = (0.0, 0.0)
        if self._images is not None:
            with contextlib.suppress(OSError):
                self._images.mkdir(parents=True, exist_ok=True)
            for path in self._images.glob("image-*.jpg"):
                digits = path.stem.removeprefix("image-")
                self._number = max(self._number, int(digits) if digits.isdecimal() else 0)
        self._measure_space()

    def start(self) -> str:
        """Take an image. Returns its path, empty without a folder."""
        path = ""
        if self._images is not None and not self.is_running:
            self._number += 1
            path = self._path = str(self._images / f"image-{self._number:05d}.jpg")
        self._begin([argument.replace(_FILE, path) for argument in self._arguments])
        return path

    def _verify(self) -> str:
        self._measure_space()
        is_missing = bool(self._path) and _FILE in "".join(self._arguments) and not Path(self._path).exists()
        return f"it left no file {self._path}" if is_missing else ""

    def space_mb(self) -> tuple[float, float]:
        """Size of the folder's medium, and free space after the latest image. Never waits for the medium."""
        return self._space_mb

    def _measure_space(self) -> None:
        """At the start, then in the program's thread."""
        if self._images is not None:
            with contextlib.suppress(OSError):
                usage = shutil.disk_usage(self._images)
                self._space_mb = usage.total / _MB, usage.free / _MB
