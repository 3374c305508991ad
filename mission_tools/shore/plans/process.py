"""Runs the planner and charts logs: one at a time, a few waiting, each with its own folder and limits."""

import asyncio
import contextlib
import os
import signal
import sys
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any, Final

import msgspec

from mission_tools.shore.plans.launcher import PLANNER, PROGRAMS, SURVEY
from mission_tools.station.words import say

LIMIT_S: Final = float(PROGRAMS[PLANNER].time_s)
MOST_WAITING: Final = 3
_LAUNCHER: Final = "mission_tools.shore.plans.launcher"
_MOST_REPORT_BYTES: Final = 8_000_000  # of 5000 items 1 MB
_NEEDS_EXTRA: Final = "needs the extra"
_PLAINLY: Final = {
    "--start-at": "the start",
    "--goal": "the goal",
    "--via": "a place",
    "--survey": "the survey",
    "--clearance": "the clearance",
    "--speed": "the speed",
    "--footprint": "the footprint",
    "--overlap": "the overlap",
    "--angle": "the angle",
    "--boat": "the boat",
    "give --spacing": "run boat-survey chart with --spacing",
}
"""The programs' options, which nobody has seen who reads its sentences on the page."""
_ONE_THREAD: Final = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
"""Each further thread of a numeric library reserves address space, and takes a core from the boat."""
BUSY: Final = say("planner.busy")
ENDING: Final = say("planner.ends")


class PlannerError(Exception):
    """The program has said no: its own sentence."""


class PlannerMissingError(Exception):
    """The program is not installed: says what installs it."""


class PlannerBusyError(Exception):
    """Too much was asked for at once, or the server ends."""


class Planner:
    """The one process of a server that plans or charts."""

    def __init__(self, limit_s: float = LIMIT_S) -> None:
        self._limit_s = limit_s
        self._one = asyncio.Lock()
        self._asked = 0
        self._process: asyncio.subprocess.Process | None = None
        self._is_closed = False

    async def run(self, arguments: list[str], folder: Path) -> dict[str, Any]:
        """What mission-plan reports as JSON, or one of the errors above. Cancel the call to end the process.

        folder: for its input and output, and its working directory.
        """
        async with self._turn():
            code = await self._run(PLANNER, [*arguments, "--json", "--items"], folder, self._limit_s)
            return await asyncio.to_thread(_report, code, folder)

    async def chart(self, log: str, water: str, folder: Path) -> None:
        """Chart the log in the folder on a map, into its folder `chart`; raises and ends as `run`."""
        async with self._turn():
            arguments = ["chart", log, "--map", water, "--out", "chart"]
            code = await self._run(SURVEY, arguments, folder, PROGRAMS[SURVEY].time_s)
            if code:
                raise await asyncio.to_thread(_refusal, SURVEY, code, folder)

    @contextlib.asynccontextmanager
    async def _turn(self) -> AsyncIterator[None]:
        """Wait until no other process runs; PlannerBusyError if too many wait."""
        if self._asked > MOST_WAITING or self._is_closed:
            raise PlannerBusyError(ENDING if self._is_closed else BUSY)
        self._asked += 1
        try:
            async with self._one:
                if self._is_closed:
                    raise PlannerBusyError(ENDING)
                yield
        finally:
            self._asked -= 1

    async def _run(self, program: str, arguments: list[str], folder: Path, limit_s: float) -> int:
        command = (sys.executable, "-m", _LAUNCHER, str(os.getpid()), program, *arguments)
        with (folder / "report.json").open("wb") as told, (folder / "errors.txt").open("wb") as errors:
            process = await asyncio.create_subprocess_exec(
                *command,
                stdin=asyncio.subprocess.DEVNULL,
                stdout=told,
                stderr=errors,
                cwd=folder,
                env={**os.environ, **_ONE_THREAD, "HOME": str(folder), "TMPDIR": str(folder)},
                start_new_session=True,
            )
            self._process = process
            try:
                async with asyncio.timeout(limit_s):
                    return await process.wait()
            except TimeoutError:
                raise PlannerError(say("planner.slow", program=program, n=limit_s)) from None
            finally:
                _kill(process)
                await asyncio.shield(process.wait())
                self._process = None

    def close(self) -> None:
        self._is_closed = True
        if self._process is not None:
            _kill(self._process)


def _kill(process: asyncio.subprocess.Process) -> None:
    """With all that it has started."""
    if process.returncode is None:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)


def _report(code: int, folder: Path) -> dict[str, Any]:
    told = _head(folder / "report.json", _MOST_REPORT_BYTES)
    try:
        report = msgspec.json.decode(told, type=dict[str, Any])
    except (msgspec.DecodeError, RecursionError, UnicodeError):
        report = {}
    if code == 0 and report.get("ok") is True:
        return report
    said = report.get("error")
    raise _refusal(PLANNER, code, folder, said if isinstance(said, str) else "")


def _refusal(program: str, code: int, folder: Path, said: str = "") -> PlannerError | PlannerMissingError:
    """What the program's last sentence and its exit code mean."""
    text = said or _last_line(folder / "errors.txt")
    text = text.removeprefix(f"{program}: ").replace(f"{folder}{os.sep}", "")
    for option, plainly in _PLAINLY.items():
        text = text.replace(option, plainly)
    if _NEEDS_EXTRA in text:
        return PlannerMissingError(say("planner.missing", program=program, why=text))
    if code in (-signal.SIGXCPU, -signal.SIGKILL):
        return PlannerError(say("planner.slow", program=program, n=PROGRAMS[program].time_s))
    if "MemoryError" in text or code < 0:
        return PlannerError(say("planner.memory", program=program))
    if not text:
        return PlannerError(say("planner.ended", program=program, n=code))
    begins_with_file = "." in text.partition(":")[0].partition(" ")[0]
    return PlannerError(text if begins_with_file else text[:1].upper() + text[1:])


def _head(path: Path, most: int) -> bytes:
    with path.open("rb") as file:
        return file.read(most)


def _last_line(path: Path) -> str:
    lines = _head(path, 65_536).decode("utf-8", "replace").strip().splitlines()
    return lines[-1].strip() if lines else ""
