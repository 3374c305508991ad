"""What is under way with the boats' logs: downloads, and voyages.

Voyages are logs fetched to a file without a name and read by a process of its own; the latest are kept."""

import asyncio
import logging
import shutil
import sys
import tempfile
from collections import OrderedDict
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, NamedTuple

import msgspec

from mission_tools.shore.clock import Clock
from mission_tools.shore.web.logs.stream import LogLostError, LogStream, fetching
from mission_tools.station.boats import Boats
from mission_tools.station.messages import LogFile
from mission_tools.station.words import LocalizedText, say

MOST_DOWNLOADS: Final = 8
MOST_LOG_BYTES: Final = 200_000_000
_MOST_KEPT: Final = 4
_MOST_ANSWER_BYTES: Final = 4_000_000  # 2000 samples take about 200 kB
_MUST_STAY_FREE_BYTES: Final = 100_000_000  # on the disk
_LEFT_S: Final = 20.0  # a page that does not ask for so long has gone
_READ_S: Final = 180.0
_READER: Final = (sys.executable, "-m", "mission_tools.shore.voyage")
_FOLDER: Final = Path("/var/tmp")  # noqa: S108 (a disk; /tmp may be memory)

_log = logging.getLogger(__name__)


class Waiting(NamedTuple):
    """share: of the log that has come; step: fetching or reading."""

    step: str
    share: float


class Lost(NamedTuple):
    """Why it cannot be shown, for people."""

    text: str


@dataclass(slots=True)
class _Voyage:
    asked_s: float
    state: Waiting | Lost | bytes
    task: "asyncio.Task[None] | None" = None


class _Reason(msgspec.Struct):
    """What the reader says, as `LocalizedText.to_page`."""

    text: str
    key: str
    values: dict[str, Any]


class Voyages:
    """By boat, name and size of the log. One log is fetched and read at a time."""

    def __init__(self, boats: Boats, clock: Clock) -> None:
        self._boats = boats
        self._clock = clock
        self._kept: OrderedDict[tuple[int, str, int], _Voyage] = OrderedDict()
        self._one = asyncio.Lock()

    def get(self, boat: int, log: LogFile) -> Waiting | Lost | bytes:
        """A voyage as JSON, how far it is, or why there is none. To be asked for again while it waits."""
        key, now_s = (boat, log.name, log.bytes), self._clock.now_s()
        voyage = self._kept.get(key)
        if voyage is None:
            self._drop_oldest(_MOST_KEPT - 1)
            voyage = self._kept[key] = _Voyage(now_s, Waiting("fetching", 0.0))
            voyage.task = asyncio.create_task(self._make(voyage, boat, log.name))
        voyage.asked_s = now_s
        self._kept.move_to_end(key)
        if isinstance(voyage.state, Lost):
            del self._kept[key]  # the next one who asks tries again
        return voyage.state

    def close(self) -> None:
        self._drop_oldest(0)

    def _drop_oldest(self, left: int) -> None:
        while len(self._kept) > left:
            _, oldest = self._kept.popitem(last=False)
            if oldest.task is not None:
                oldest.task.cancel()

    async def _make(self, voyage: _Voyage, boat: int, name: str) -> None:
        try:
            async with self._one:
                voyage.state = await self._read(voyage, boat, name)
        except LogLostError as error:
            voyage.state = Lost(error.text)
        except OSError as error:
            voyage.state = Lost(say("log.no_disk", why=error.strerror or ""))
        except Exception:
            _log.exception("the voyage of %s", name)
            voyage.state = Lost(say("log.failed"))

    async def _read(self, voyage: _Voyage, boat: int, name: str) -> Lost | bytes:
        found = self._boats.get(boat)
        path = None if found is None else found.logs.path(name)
        if found is None or path is None:
            raise LogLostError(say("log.unknown"))
        folder = _FOLDER if _FOLDER.is_dir() else Path(tempfile.gettempdir())
        with tempfile.TemporaryFile(dir=folder, prefix="mavboat-log-") as file:
            with fetching(found.files, path, MOST_LOG_BYTES) as stream:
                size = await stream.opened()
                if shutil.disk_usage(folder).free < size + _MUST_STAY_FREE_BYTES:
                    raise LogLostError(say("log.no_room"))
                async for part in stream.parts():
                    await asyncio.to_thread(file.write, part)
                    voyage.state = Waiting("fetching", stream.sent / max(size, 1))
                    if self._clock.now_s() - voyage.asked_s > _LEFT_S:
                        raise LogLostError(say("log.left"))
            await asyncio.to_thread(file.flush)
            voyage.state = Waiting("reading", 1.0)
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
        self.voyages = Voyages(boats, clock)
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
