"""Storage of small files that have the old or the new content, never a mixture.

Each has a checksum and a generation number, and the previous generation is kept (`generations.py`). Saves run
in a worker thread, as an SD card may take a tenth of a second. Waiting saves of one name are merged: the
newest content is written, and all are done when it is stored.
"""

import logging
import threading
from concurrent.futures import Executor, Future, ThreadPoolExecutor, wait
from pathlib import Path
from typing import Any, Protocol

from companion.core.errors import StorageError
from companion.core.generations import Write, find_newest, save_next, write_atomically

logger = logging.getLogger(__name__)


class InlineExecutor(Executor):
    """Runs jobs at once: for a boat without a disk, and for tests."""

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> "Future[Any]":  # noqa: ANN401
        """Run the job; its exceptions go to the future."""
        future: Future[Any] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


class Saving:
    """A save in progress, shared by those that it includes."""

    def __init__(self, content: bytes = b"") -> None:
        self.content = content
        self.future: Future[None] = Future()

    def is_done(self) -> bool:
        """Whether it is stored, or has failed."""
        return self.future.done()

    def error(self) -> str:
        """The error, empty on success. Only once done."""
        fault = self.future.exception(timeout=0)
        return "" if fault is None else str(fault) or type(fault).__name__


def ended(error: str = "") -> Saving:
    """A save that is over."""
    saving = Saving()
    if error:
        saving.future.set_exception(StorageError(error))
    else:
        saving.future.set_result(None)
    return saving


class Storage(Protocol):
    """Named blobs that survive a power cut."""

    def load(self, name: str) -> bytes:
        """The last saved content, empty if there is none. Waits for saves in progress."""

    def damage(self, name: str) -> str:
        """Damage found by the last load of this name, and what was returned instead; empty if intact."""

    def save(self, name: str, content: bytes) -> Saving:
        """Start replacing the content."""

    def close(self) -> None:
        """Wait for saves in progress. May be called twice."""


class MemoryStorage:
    """In-memory storage for lockstep runs and tests; saves are immediate."""

    def __init__(self) -> None:
        self.content: dict[str, bytes] = {}

    def load(self, name: str) -> bytes:
        """The last saved content, empty if there is none."""
        return self.content.get(name, b"")

    def damage(self, name: str) -> str:  # noqa: ARG002
        return ""

    def save(self, name: str, content: bytes) -> Saving:
        self.content[name] = content
        return ended()

    def close(self) -> None:
        """No effect."""


class FolderStorage:
    """Files in a folder, which is created if missing.
    Raises StorageError: the folder cannot be created, or a file in it cannot be read.
    """

    def __init__(self, folder: Path, write: Write = write_atomically, worker: Executor | None = None) -> None:
        """worker: runs the writes in order; default: a thread."""
        self.folder = folder
        self._write = write
        self._worker = worker or ThreadPoolExecutor(max_workers=1, thread_name_prefix="storage")
        self._lock = threading.Lock()
        self._waiting: dict[str, Saving] = {}  # by name; the worker removes a write when it starts
        self._last: Future[None] | None = None  # with one worker, the last to start is the last to end
        self._damage: dict[str, str] = {}
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise StorageError(f"{folder}: cannot be used to store missions: {error.strerror}") from None

    def load(self, name: str) -> bytes:
        """The newest intact generation, empty if there is none."""
        if self._last is not None:
            wait([self._last])
        try:
            generation, damage, _ = find_newest(self.folder / name)
        except OSError as error:
            raise StorageError(f"{self.folder / name}: cannot be read: {error.strerror}") from None
        if damage:
            taken = "the previous one is in use" if generation.content else "there is no previous one"
            damage = f"{name} is damaged, {taken}"
            logger.error("%s: %s", self.folder / name, damage)
        self._damage[name] = damage
        return generation.content

    def damage(self, name: str) -> str:
        return self._damage.get(name, "")

    def save(self, name: str, content: bytes) -> Saving:
        with self._lock:
            if (write := self._waiting.get(name)) is not None:
                write.content = content
                return write
            write = self._waiting[name] = Saving(content)
        self._last = write.future
        self._worker.submit(self._carry_out, name)
        return write

    def close(self) -> None:
        """Wait for saves in progress."""
        self._worker.shutdown(wait=True)

    def _carry_out(self, name: str) -> None:
        with self._lock:
            write = self._waiting.pop(name)
        try:
            save_next(self.folder / name, write.content, self._write)
        except OSError as error:
            why = error.strerror or str(error) or type(error).__name__
            write.future.set_exception(StorageError(f"{name}: {why}"))
        except Exception as error:
            write.future.set_exception(error)
        else:
            write.future.set_result(None)
