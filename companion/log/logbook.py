"""All logs of the boat: the onboard log, and telemetry logs of its links."""

import re
from collections.abc import Callable
from pathlib import Path
from struct import Struct
from typing import Final

from companion.core.status_text import StatusText
from companion.core.storage import InlineExecutor
from companion.log.onboard import OnboardLog, TakeSnapshot
from companion.log.sink import FileSink, Sink, Worker
from companion.log.store import LogStore
from companion.router.channels import Channels

FOLDER: Final = "logs"
_MOST_TELEMETRY_LOGS: Final = 16  # open at a time
_STAMP = Struct(">Q")
_BLOCK_BYTES: Final = 8192
_FLUSH_S: Final = 1.0


class TelemetryLog:
    """All frames of a link in `.tlog` format, as of QGroundControl and MAVProxy.

    Each frame follows its time as 8 bytes, microseconds since 1970, big-endian. The channel removes
    signatures and omits frames with a signing key.
    """

    def __init__(self, sink: Sink, clock_us: Callable[[], int]) -> None:
        """clock_us: microseconds since 1970, or since boot if unknown."""
        self._sink = sink
        self._clock_us = clock_us
        self._block = bytearray()
        self._due_s = 0.0
        sink.begin()

    def add(self, frame: bytes) -> None:
        if len(self._block) > _BLOCK_BYTES:
            self._hand_over()
        self._block += _STAMP.pack(self._clock_us()) + frame

    def tick(self, now_s: float) -> None:
        """Flush periodically."""
        if now_s >= self._due_s and self._block:
            self._due_s = now_s + _FLUSH_S
            self._hand_over()

    def close(self) -> None:
        """The link has closed."""
        self._hand_over()
        self._sink.end()

    def _hand_over(self) -> None:
        if self._block:
            self._sink.write(bytes(self._block), self._clock_us() * 1e-6)
        self._block.clear()


class Logbook:
    """The destination and writer of the logs.

    onboard is set by the boat. Without a store there are no files to list or download.
    """

    def __init__(
        self,
        sink: Sink,
        store: LogStore | None = None,
        worker: Worker | None = None,
        *,
        keeps_telemetry: bool = False,
    ) -> None:
        """worker: of the store; default: everything at once."""
        self.store = store
        self.worker = worker or Worker(InlineExecutor())
        self.sink = sink
        self.onboard: OnboardLog | None = None
        self._telemetry: dict[int, TelemetryLog] = {}
        self._telemetry_store = store if keeps_telemetry else None
        self._clock_us = 0

    def note(self, notice: StatusText) -> None:
        if self.onboard is not None:
            self.onboard.note(notice)

    def tick(self, now_s: float, take_snapshot: TakeSnapshot, channels: Channels) -> None:
        """Log the tick. take_snapshot: the state of the boat; called only if something is due."""
        if self.onboard is not None:
            self.onboard.tick(now_s, take_snapshot, channels)
        for log in self._telemetry.values():
            log.tick(now_s)

    def follow(self, channels: Channels, time_s: float) -> None:
        """Before links are read: set the time of their frames, and open a log for each new one.

        time_s: Unix time, or since boot if unknown.
        """
        store = self._telemetry_store
        if store is None:
            return
        self._clock_us = round(time_s * 1e6)
        if channels.open.keys() == self._telemetry.keys():
            return
        for number in self._telemetry.keys() - channels.open.keys():
            self._telemetry.pop(number).close()
        for number in list(channels.open.keys() - self._telemetry.keys()):
            if len(self._telemetry) < _MOST_TELEMETRY_LOGS:
                log = self._open_telemetry(store, channels.open[number].link.name)
                self._telemetry[number] = log
                channels.open[number].tap = log.add

    def close(self) -> None:
        """Complete all logs and wait until they are written. May be called twice."""
        if self.onboard is not None:
            self.onboard.close()
        for log in self._telemetry.values():
            log.close()
        self._telemetry.clear()
        self.sink.close()
        self.worker.close()

    def _open_telemetry(self, store: LogStore, link: str) -> TelemetryLog:
        name = re.sub(r"[^\w.]+", "_", link, flags=re.ASCII)[:50] or "link"
        return TelemetryLog(FileSink(store, self.worker, f"-{name}.tlog"), lambda: self._clock_us)


def open_logbook(folder: Path, *, quota_mb: float, min_free_mb: float, keeps_telemetry: bool) -> Logbook:
    """A logbook in a subfolder of `folder`, written in a thread.
    Raises StorageError: the folder cannot be used.
    """
    store = LogStore(folder / FOLDER, quota_mb, min_free_mb)
    worker = Worker()
    return Logbook(FileSink(store, worker), store, worker, keeps_telemetry=keeps_telemetry)
