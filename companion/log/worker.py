"""Worker for file access: the control loop submits jobs and never waits."""

import logging
import threading
from collections import deque
from collections.abc import Callable
from typing import Protocol

logger = logging.getLogger(__name__)

Job = Callable[[], None]

_MOST_BYTES = 1 << 20
_MOST_JOBS = 4096


class Worker(Protocol):
    """Runs jobs in order."""

    @property
    def room_bytes(self) -> int:
        """Bytes that may still be queued."""

    def submit(self, job: Job, size_bytes: int = 0) -> bool:
        """Queue a job of this size; False if too much is queued."""

    def close(self) -> None:
        """Finish the queue. May be called twice."""


class InlineWorker:
    """Runs each job at once: for lockstep runs and tests."""

    room_bytes = _MOST_BYTES

    def submit(self, job: Job, size_bytes: int = 0) -> bool:  # noqa: ARG002
        """Run it."""
        _do(job)
        return True

    def close(self) -> None:
        """No effect."""


class ThreadWorker:
    """A thread. Only one other thread may submit."""

    def __init__(self, most_bytes: int = _MOST_BYTES, most_jobs: int = _MOST_JOBS) -> None:
        self._most_bytes = most_bytes
        self._most_jobs = most_jobs
        self._jobs: deque[tuple[Job, int]] = deque()
        self._waiting = threading.Semaphore(0)
        # Two counters, each with one writer, need no lock
        self._taken_bytes = 0
        self._done_bytes = 0
        self._is_closing = False
        self._thread = threading.Thread(target=self._run, name="log", daemon=True)
        self._thread.start()

    @property
    def room_bytes(self) -> int:
        """Bytes that may still be queued."""
        return self._most_bytes - (self._taken_bytes - self._done_bytes)

    def submit(self, job: Job, size_bytes: int = 0) -> bool:
        """Queue it."""
        if self._is_closing or size_bytes > self.room_bytes or len(self._jobs) >= self._most_jobs:
            return False
        self._taken_bytes += size_bytes
        self._jobs.append((job, size_bytes))
        self._waiting.release()
        return True

    def close(self) -> None:
        """Finish the queue and the thread."""
        if not self._is_closing:
            self._is_closing = True
            self._waiting.release()
            self._thread.join()

    def _run(self) -> None:
        while True:
            self._waiting.acquire()
            if not self._jobs:
                return  # released without a job: closing
            job, size_bytes = self._jobs.popleft()
            _do(job)
            self._done_bytes += size_bytes


def _do(job: Job) -> None:
    try:
        job()
    except Exception:
        logger.exception("a job on the log's files went wrong")
