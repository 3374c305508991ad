"""A log on its way from the boat: a small window in memory, filled no faster than it is read."""

import asyncio
from collections import deque
from collections.abc import AsyncIterator, Iterator
from contextlib import contextmanager
from typing import Final

from mission_tools.station.ftp.client import FtpClient
from mission_tools.station.ftp.jobs import FtpFailure

WINDOW_BYTES: Final = 2 * 160 * 1024  # two of the station's bursts: one is read while the other comes
MOST_BYTES: Final = 2_000_000_000


class LogLostError(Exception):
    """The boat does not send it, or not all of it. text: for people."""

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self.text = text


class LogStream:
    """Satisfies `Sink`. size: None until the boat has opened it."""

    def __init__(self) -> None:
        self.size: int | None = None
        self.sent = 0  # bytes read from here
        self._parts: deque[bytes] = deque()
        self._held = 0
        self._failure: str | None = None
        self._is_ended = False
        self._change = asyncio.Event()

    def begin(self, size: int) -> None:
        self.size = size
        self._change.set()

    def write(self, data: bytes) -> None:
        self._parts.append(data)
        self._held += len(data)
        self._change.set()

    def room(self) -> int:
        return WINDOW_BYTES - self._held

    def end(self, failure: FtpFailure | None) -> None:
        """The transfer is over."""
        self._failure = None if failure is None else failure.text
        self._is_ended = True
        self._change.set()

    async def opened(self) -> int:
        """Wait for the boat to open it; returns the size, or raises LogLostError."""
        while self.size is None:
            self._check()
            await self._wait()
        return self.size

    async def parts(self) -> AsyncIterator[bytes]:
        """The bytes as they come; LogLostError if they end too early."""
        while True:
            while self._parts:
                part = self._parts.popleft()
                yield part
                self._held -= len(part)
                self.sent += len(part)
            self._check()
            if self._is_ended:
                return
            await self._wait()

    def _check(self) -> None:
        if self._failure is not None:
            raise LogLostError(self._failure)

    async def _wait(self) -> None:
        self._change.clear()
        await self._change.wait()


@contextmanager
def fetching(files: FtpClient, path: str, most_bytes: int = MOST_BYTES) -> Iterator[LogStream]:
    """A log while it is fetched; whoever leaves early ends the transfer."""
    stream = LogStream()
    job = files.read(path, stream, stream.end, most_bytes=most_bytes, grows=True)
    try:
        yield stream
    finally:
        files.cancel(job)
