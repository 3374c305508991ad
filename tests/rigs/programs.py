"""The installed programs as processes: started in a room of their own, watched, and cleaned up after.

Each has a home and a folder for temporary files that nobody else uses, and a session of its own, so that
whatever it leaves behind, file or process, can be found.
"""

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from patience import JOB_S, MOMENT_S

SCRIPTS = Path(sys.executable).parent
END_S = MOMENT_S  # a program that was told to end has this long
START_S = JOB_S  # and this long to say what it is waited for


class Ended(NamedTuple):
    """What a program left: its exit code and its words."""

    code: int
    out: str
    err: str


class Program:
    """One running program. Its output goes to files, so that it never waits for us."""

    def __init__(
        self, room: Path, arguments: Sequence[str], environment: Mapping[str, str] | None = None
    ) -> None:
        """arguments: an installed script's name or a path, then what it is given."""
        room.mkdir(parents=True)
        self.room = room
        self.temporary = room / "tmp"
        self.temporary.mkdir()
        self._out, self._err = room / "stdout", room / "stderr"
        script = SCRIPTS / arguments[0]
        command = [str(script) if script.exists() else arguments[0], *arguments[1:]]
        if script.suffix == ".py":
            command.insert(0, sys.executable)
        own = {
            "HOME": str(room),
            "XDG_STATE_HOME": str(room / "state"),
            "TMPDIR": str(self.temporary),
            "PYTHONUNBUFFERED": "1",
        }
        with self._out.open("wb") as out, self._err.open("wb") as err:
            self._process = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=out,
                stderr=err,
                cwd=room,
                env={**os.environ, **own, **(environment or {})},
                start_new_session=True,
            )

    @property
    def pid(self) -> int:
        """The process's number, which is its session's too."""
        return self._process.pid

    @property
    def is_running(self) -> bool:
        """Whether it has not ended."""
        return self._process.poll() is None

    @property
    def out(self) -> str:
        """What it has said so far."""
        return self._out.read_text(encoding="utf-8")

    @property
    def err(self) -> str:
        """What it has complained of so far."""
        return self._err.read_text(encoding="utf-8")

    def wait_for(
        self, pattern: str, timeout_s: float = START_S, *, after: int = 0, stream: str = "out"
    ) -> re.Match[str]:
        """Wait until its output, from character `after` on, matches."""
        give_up_s = time.monotonic() + timeout_s
        while True:
            was_running = self.is_running
            found = re.compile(pattern, re.MULTILINE).search(getattr(self, stream), after)
            if found is not None:
                return found
            if not was_running or time.monotonic() > give_up_s:
                how = "not said in time" if was_running else f"ended with {self._process.returncode}"
                raise AssertionError(f"{pattern!r}: {how}; stdout: {self.out!r}; stderr: {self.err!r}")
            time.sleep(0.01)

    def say(self, line: str) -> None:
        """Type a line."""
        assert self._process.stdin is not None
        self._process.stdin.write(line.encode() + b"\n")
        self._process.stdin.flush()

    def hang_up(self) -> None:
        """No more will be typed."""
        assert self._process.stdin is not None
        self._process.stdin.close()

    def send(self, number: signal.Signals) -> None:
        """Send a signal."""
        self._process.send_signal(number)

    def kill(self) -> None:
        """The power goes: no handler, no clean-up, no last word."""
        self._process.kill()
        self._process.wait(END_S)

    def wait(self, timeout_s: float = END_S) -> Ended:
        """Wait for its end."""
        try:
            code = self._process.wait(timeout_s)
        except subprocess.TimeoutExpired:
            raise AssertionError(
                f"still running after {timeout_s} s; stdout: {self.out!r}; stderr: {self.err!r}"
            ) from None
        return Ended(code, self.out, self.err)

    def close(self) -> None:
        """End it whatever it takes, then see that nothing is left: no process, no temporary file."""
        try:
            if self.is_running:
                self.send(signal.SIGINT)
                try:
                    self._process.wait(END_S)
                except subprocess.TimeoutExpired:
                    self.kill()
                    raise AssertionError(f"{self.room.name} did not end when interrupted") from None
        finally:
            if self._process.stdin is not None and not self._process.stdin.closed:
                self._process.stdin.close()
            left = processes_of(self.pid)
            for pid in left:
                os.kill(pid, signal.SIGKILL)
        assert left == [], f"{self.room.name} left processes behind"
        files = sorted(str(path) for path in self.temporary.rglob("*"))
        assert files == [], f"{self.room.name} left files behind"


def until(condition: Callable[[], object], timeout_s: float = END_S) -> None:
    """Wait until something holds."""
    give_up_s = time.monotonic() + timeout_s
    while not condition():
        assert time.monotonic() < give_up_s, f"it did not come about within {timeout_s} s"
        time.sleep(0.01)


def processes_of(session: int) -> list[int]:
    """The processes of a session that have not ended."""
    found = []
    for entry in Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            # pid (name) state ppid pgrp session …; the name may hold anything, the rest is plain
            fields = (entry / "stat").read_text(encoding="utf-8").rpartition(")")[2].split()
        except OSError:
            continue
        if int(fields[3]) == session and fields[0] != "Z":
            found.append(int(entry.name))
    return sorted(found)


class RunningBoat(NamedTuple):
    """A boat in the emulator, ready for stations on a port that the system chose."""

    program: Program
    port: int

    @property
    def url(self) -> str:
        """As people write it for MAVProxy and pymavlink."""
        return f"tcp:127.0.0.1:{self.port}"


def start_boat(room: Path, *arguments: str) -> RunningBoat:
    """`boat-sitl serve`, waited for until it says that it is ready."""
    program = Program(room, ["boat-sitl", "serve", *arguments, "--tcp", "0", "--no-udp"])
    try:
        port = int(program.wait_for(r"on tcpin:127\.0\.0\.1:(\d+)$")[1])
        program.wait_for(r"^boat-sitl: ready; Ctrl-C ends$")
    except BaseException:
        program.kill()
        raise
    return RunningBoat(program, port)


RunProgram = Callable[..., Program]  # script and arguments, environment=…
RunBoat = Callable[..., RunningBoat]  # arguments of `boat-sitl serve`
