"""Destination of log blocks: a numbered file, written by a worker. The control loop never waits."""

import contextlib
import logging
import os
from collections.abc import Callable
from concurrent.futures import Executor, ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import BinaryIO, Protocol

from companion.core.errors import OutputError, StorageError
from companion.log.store import LogStore

logger = logging.getLogger(__name__)

_SYNC_EVERY = 4  # blocks: loss by a power cut against wear

Job = Callable[[], None]

_MOST_BYTES = 1 << 20
_MOST_JOBS = 4096


class Worker:
    """Runs jobs in order, and takes only so much ahead. Only one other thread may submit."""

    def __init__(
        self, executor: Executor | None = None, most_bytes: int = _MOST_BYTES, most_jobs: int = _MOST_JOBS
    ) -> None:
        """executor: does one job after the other; default: a thread."""
        self._executor = executor or ThreadPoolExecutor(1, thread_name_prefix="log")
        self._most_bytes = most_bytes
        self._most_jobs = most_jobs
        # Counters with one writer each need no lock
        self._taken_bytes = self._done_bytes = 0
        self._taken = self._done = 0
        self._is_closed = False

    @property
    def room_bytes(self) -> int:
        """Bytes that may still be queued."""
        return self._most_bytes - (self._taken_bytes - self._done_bytes)

    def submit(self, job: Job, size_bytes: int = 0) -> bool:
        """Queue a job of this size; False if too much is queued."""
        is_full = size_bytes > self.room_bytes or self._taken - self._done >= self._most_jobs
        if self._is_closed or is_full:
            return False
        self._taken_bytes += size_bytes
        self._taken += 1
        self._executor.submit(self._do, job, size_bytes)
        return True

    def close(self) -> None:
        """Finish the queue. May be called twice."""
        self._is_closed = True
        self._executor.shutdown()

    def _do(self, job: Job, size_bytes: int) -> None:
        try:
            job()
        except Exception:
            logger.exception("a job on the log's files went wrong")
        self._done_bytes += size_bytes
        self._done += 1


class Sink(Protocol):
    """Takes a log block by block."""

    @property
    def fault(self) -> str:
        """Why the present log has failed, or empty."""

    @property
    def room_bytes(self) -> int:
        """Bytes that can be taken now."""

    def begin(self) -> bool:
        """Begin a new log. False if not possible now."""

    def write(self, block: bytes, unix_s: float) -> bool:
        """Write a block; False if it is lost. unix_s: Unix time, 0 if unknown."""

    def end(self) -> None:
        """Complete the log."""

    def close(self) -> None:
        """Close the sink. May be called twice."""


class FileSink:
    """Files in the store, written and flushed by the worker; never waits."""

    def __init__(self, store: LogStore, worker: Worker, suffix: str = ".bin") -> None:
        self.fault = ""
        self._store = store
        self._worker = worker
        self._suffix = suffix
        self._file: BinaryIO | None = None  # owned by the worker, like the following
        self._name = ""
        self._size_bytes = 0
        self._unsynced = 0

    @property
    def room_bytes(self) -> int:
        """Room in the worker's queue."""
        return self._worker.room_bytes

    def begin(self) -> bool:
        self.fault = ""
        return self._worker.submit(self._open)

    def write(self, block: bytes, unix_s: float) -> bool:
        return self._worker.submit(partial(self._append, block, unix_s), len(block))

    def end(self) -> None:
        """Queue the end of the file, if there is one; closing the worker waits for it."""
        self._worker.submit(self._close)

    close = end

    def _open(self) -> None:
        self._close()
        try:
            self._name, self._file = self._store.create(self._suffix)
        except OSError as error:
            self._fail(error)
        self._size_bytes = self._unsynced = 0

    def _append(self, block: bytes, unix_s: float) -> None:
        if self._file is None:
            return
        try:
            rest = memoryview(block)
            while rest:  # a full medium may take a part
                rest = rest[self._file.write(rest) :]
            self._size_bytes += len(block)
            self._store.grew(self._name, self._size_bytes, unix_s)
            self._unsynced += 1
            if self._unsynced >= _SYNC_EVERY:
                self._sync(self._file)
        except OSError as error:
            self._fail(error)

    def _sync(self, file: BinaryIO) -> None:
        self._unsynced = 0
        os.fsync(file.fileno())
        self._store.date(self._name)
        self._store.make_room()

    def _close(self) -> None:
        file, self._file = self._file, None
        if file is None:
            return
        try:
            self._sync(file)
        except OSError as error:
            logger.warning("log %s: %s", self._name, error)
        with contextlib.suppress(OSError):
            file.close()
        self._store.finish(self._name)

    def _fail(self, error: OSError) -> None:
        why = error.strerror or str(error)
        self.fault = f"{self._name}: {why}" if self._file is not None else why
        self._close()
        self._store.drop_empty(self._name)


class SingleFile:
    """One file, written immediately: for lockstep runs. A second log is appended.
    Raises StorageError: the file cannot be written.
    """

    room_bytes = _MOST_BYTES

    def __init__(self, path: Path) -> None:
        self.fault = ""
        self._path = path
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = path.open("wb")
        except OSError as error:
            raise StorageError(f"{path}: cannot be written: {error.strerror}") from None

    def begin(self) -> bool:
        return True

    def write(self, block: bytes, unix_s: float) -> bool:  # noqa: ARG002
        return self._attempt(lambda: self._file.write(block))

    def end(self) -> None:
        self._attempt(self._file.flush)

    def close(self) -> None:
        """Close the file. May be called twice."""
        self._attempt(self._file.close)

    def _attempt(self, work: Callable[[], object]) -> bool:
        """Use the file; after an error it is closed."""
        if self.fault:
            return False
        try:
            work()
        except OSError as error:
            self.fault = str(OutputError.of(self._path, error))
            with contextlib.suppress(OSError):
                self._file.close()
        return not self.fault
