"""Downloads of logs, and logs fetched for a process that reads them: one at a time, the latest are kept."""

import asyncio
import logging
import shutil
import sys
import tempfile
from abc import ABC, abstractmethod
from collections import OrderedDict
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any, Final, NamedTuple

import msgspec

from mission_tools.shore.clock import Clock
from mission_tools.shore.web.logs.stream import LogLostError, LogStream, fetching
from mission_tools.station.boats import Boats
from mission_tools.station.messages import LogFile
from mission_tools.station.words import LocalizedText, say

MOST_DOWNLOADS: Final = 8
MOST_LOG_BYTES: Final = 200_000_000
_MOST_KEPT: Final = 4  # of each kind
_MOST_ANSWER_BYTES: Final = 4_000_000  # 2000 samples take about 200 kB
_MUST_STAY_FREE_BYTES: Final = 100_000_000  # on the disk
_LEFT_S: Final = 20.0  # a page that does not ask for so long has gone
_READ_S: Final = 180.0
_READER: Final = (sys.executable, "-m", "mission_tools.shore.voyage")
_DISK: Final = Path("/var/tmp")  # noqa: S108 (/tmp may be memory)
FOLDER: Final = _DISK if _DISK.is_dir() else Path(tempfile.gettempdir())

_log = logging.getLogger(__name__)


class Waiting(NamedTuple):
    """share: of the log that has come; step: fetching, reading or charting."""

    step: str
    share: float


class Lost(NamedTuple):
    """Why it cannot be shown, for people."""

    text: str


@dataclass(slots=True)
class Job:
    """A log that is fetched and read. size: its bytes then; folder: of the result's files."""

    size: int
    asked_s: float
    state: Waiting | Lost | bytes
    is_told: bool = False
    folder: Path | None = None
    task: "asyncio.Task[None] | None" = None


class LogJobs(ABC):
    """By boat and name of the log. one: held while a log is fetched and read."""

    def __init__(self, boats: Boats, clock: Clock, one: asyncio.Lock) -> None:
        self._boats = boats
        self._clock = clock
        self._kept: OrderedDict[tuple[int, str], Job] = OrderedDict()
        self._one = one

    @abstractmethod
    async def _work(self, job: Job, boat: int, name: str) -> Lost | bytes:
        """The result as JSON. What it raises of LogLostError and OSError is told as Lost."""

    def get(self, boat: int, log: LogFile) -> Waiting | Lost | bytes:
        """The result as JSON, how far it is, or why there is none. To be asked for again while it waits."""
        key, now_s = (boat, log.name), self._clock.now_s()
        job = self._kept.get(key)
        if job is not None and job.is_told and job.size != log.bytes:  # the log has grown since
            self.cancel(*key)
            job = None
        if job is None:
            while len(self._kept) >= _MOST_KEPT:
                self.cancel(*next(iter(self._kept)))
            job = self._kept[key] = Job(log.bytes, now_s, Waiting("fetching", 0.0))
            job.task = asyncio.create_task(self._make(job, *key))
        job.asked_s = now_s
        self._kept.move_to_end(key)
        if isinstance(job.state, Lost):
            del self._kept[key]  # the next one who asks tries again
        job.is_told = isinstance(job.state, bytes)
        return job.state

    def cancel(self, boat: int, name: str) -> None:
        """End and forget a job, if there is one."""
        job = self._kept.pop((boat, name), None)
        if job is not None and job.task is not None:
            job.task.cancel()
        if job is not None and job.folder is not None:
            shutil.rmtree(job.folder, ignore_errors=True)

    def close(self) -> None:
        for key in list(self._kept):
            self.cancel(*key)

    async def _make(self, job: Job, boat: int, name: str) -> None:
        try:
            async with self._one:
                job.state = await self._work(job, boat, name)
        except LogLostError as error:
            job.state = Lost(error.text)
        except OSError as error:
            job.state = Lost(say("log.no_disk", why=error.strerror or ""))
        except Exception:
            _log.exception("the log %s", name)
            job.state = Lost(say("log.failed"))

    async def _fetch(self, job: Job, boat: int, name: str, file: IO[bytes]) -> None:
        """The log from the boat into a file below FOLDER."""
        found = self._boats.get(boat)
        path = None if found is None else found.logs.path(name)
        if found is None or path is None:
            raise LogLostError(say("log.unknown"))
        with fetching(found.files, path, MOST_LOG_BYTES) as stream:
            size = await stream.opened()
            if shutil.disk_usage(FOLDER).free < size + _MUST_STAY_FREE_BYTES:
                raise LogLostError(say("log.no_room"))
            async for part in stream.parts():
                await asyncio.to_thread(file.write, part)
                job.state = Waiting("fetching", stream.sent / max(size, 1))
                if self._clock.now_s() - job.asked_s > _LEFT_S:
                    raise LogLostError(say("log.left"))
        await asyncio.to_thread(file.flush)


class _Reason(msgspec.Struct):
    """What the reader says, as `LocalizedText.to_page`."""

    text: str
    key: str
    values: dict[str, Any]


class Voyages(LogJobs):
    """The result is a voyage. The log is fetched to a file without a name."""

    async def _work(self, job: Job, boat: int, name: str) -> Lost | bytes:
        with tempfile.TemporaryFile(dir=FOLDER, prefix="mavboat-log-") as file:
            await self._fetch(job, boat, name, file)
            job.state = Waiting("reading", 1.0)
            return await _voyage_of(file.fileno())


async def _voyage_of(descriptor: int) -> Lost | bytes:
    """By the reader's process, which limits itself; its end is waited for."""
    process = await asyncio.create_subprocess_exec(
        *_READER,
        f"/dev/fd/{descriptor}",
        stdin=asyncio.subprocess.DEVNULL,
        stdout=asyncio.subprocess.PIPE,
        stderr=asyncio.subprocess.DEVNULL,
        pass_fds=[descriptor],
        limit=_MOST_ANSWER_BYTES,
    )
    try:
        async with asyncio.timeout(_READ_S):
            answer, _ = await process.communicate()
    except TimeoutError:
        return Lost(say("log.slow"))
    finally:
        if process.returncode is None:
            process.kill()
            await process.wait()
    if process.returncode == 0 and len(answer) <= _MOST_ANSWER_BYTES:
        return answer
    try:
        reason = msgspec.json.decode(answer, type=_Reason)
    except msgspec.DecodeError:
        return Lost(say("log.failed"))
    said = LocalizedText(reason.text)
    said.key, said.values = reason.key, reason.values
    return Lost(said)


class LogService:
    """Logs of all boats."""

    def __init__(self, boats: Boats, clock: Clock) -> None:
        self.one = asyncio.Lock()
        self.voyages = Voyages(boats, clock, self.one)
        self._boats = boats
        self._under_way: list[tuple[int, str, LogStream]] = []

    def fetched(self, boat: int) -> dict[str, int]:
        """Bytes of each log that have gone to a browser, while it is downloaded; of several the farthest."""
        return {
            name: stream.sent
            for of, name, stream in sorted(self._under_way, key=lambda one: one[2].sent)
            if of == boat
        }

    @contextmanager
    def download(self, boat: int, name: str) -> Iterator[LogStream | None]:
        """A listed log while it is fetched; None if too many are."""
        found = self._boats.get(boat)
        path = None if found is None else found.logs.path(name)
        if found is None or path is None or len(self._under_way) >= MOST_DOWNLOADS:
            yield None
            return
        with fetching(found.files, path) as stream:
            one = boat, name, stream
            self._under_way.append(one)
            try:
                yield stream
            finally:
                self._under_way.remove(one)
