"""The boat's memory: small files that hold the old content or the new, never a mixture.

Each has a checksum and a generation number, and the generation before the newest is kept (`generations.py`).
A save runs on a worker thread, because an SD card may take a tenth of a second and the control loop must not
wait. Saves of one name that wait for the worker become one: the newest content is written, and all of them
are done when the medium has it.
"""

import logging
import threading
from concurrent.futures import Executor, Future, ThreadPoolExecutor, wait
from pathlib import Path
from typing import Protocol

from companion.core.errors import StorageError
from companion.persistence.generations import Write, find_newest, save_next, write_atomically

logger = logging.getLogger(__name__)


class Saving(Protocol):
    """A save under way."""

    def is_done(self) -> bool:
        """Whether the medium has it, or has refused it."""

    def error(self) -> str:
        """Why it failed; empty when it did not. Only once done."""


class Storage(Protocol):
    """Named blobs that survive a power cut."""

    def load(self, name: str) -> bytes:
        """The content last saved under this name, empty when there is none. Waits for saves under way."""

    def damage(self, name: str) -> str:
        """What the last load of this name found damaged, and what it returned instead; empty when all was
        well."""

    def save(self, name: str, content: bytes) -> Saving:
        """Begin to replace the content under this name."""

    def close(self) -> None:
        """Wait for what is under way. May be called twice."""


class _Done:
    def is_done(self) -> bool:
        return True

    def error(self) -> str:
        return ""


class MemoryStorage:
    """Keeps everything for as long as the process lives, and saves at once: for lockstep and tests."""

    def __init__(self) -> None:
        self.content: dict[str, bytes] = {}

    def load(self, name: str) -> bytes:
        """The content last saved under this name, empty when there is none."""
        return self.content.get(name, b"")

    def damage(self, name: str) -> str:  # noqa: ARG002
        """Memory does not decay."""
        return ""

    def save(self, name: str, content: bytes) -> Saving:
        """Replace the content under this name."""
        self.content[name] = content
        return _Done()

    def close(self) -> None:
        """Nothing to wait for."""


class _Write:
    """A write that waits for the worker or is under way; every save that it includes holds it."""

    def __init__(self, content: bytes) -> None:
        self.content = content
        self.future: Future[None] = Future()

    def is_done(self) -> bool:
        return self.future.done()

    def error(self) -> str:
        fault = self.future.exception(timeout=0)
        return "" if fault is None else str(fault) or type(fault).__name__


class FolderStorage:
    """Files in a folder, which is made when missing.

    Raises:
        StorageError: the folder cannot be made, or a file in it cannot be read.
    """

    def __init__(self, folder: Path, write: Write = write_atomically, worker: Executor | None = None) -> None:
        """worker: where writes run, one after the other; a thread unless given."""
        self._folder = folder
        self._write = write
        self._worker = worker or ThreadPoolExecutor(max_workers=1, thread_name_prefix="storage")
        self._lock = threading.Lock()
        self._waiting: dict[str, _Write] = {}  # by name; the worker takes a write out when it begins it
        self._last: Future[None] | None = None  # one worker: the last to begin is the last to end
        self._damage: dict[str, str] = {}
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise StorageError(f"{folder}: cannot be used to store missions: {error.strerror}") from None

    @property
    def folder(self) -> Path:
        """Where it all is."""
        return self._folder

    def load(self, name: str) -> bytes:
        """The newest whole generation saved under this name, empty when there is none."""
        if self._last is not None:
            wait([self._last])
        try:
            generation, damage, _ = find_newest(self._folder / name)
        except OSError as error:
            raise StorageError(f"{self._folder / name}: cannot be read: {error.strerror}") from None
        if damage:
            taken = "the previous one is in use" if generation.content else "there is no previous one"
            damage = f"{name} is damaged, {taken}"
            logger.error("%s: %s", self._folder / name, damage)
        self._damage[name] = damage
        return generation.content

    def damage(self, name: str) -> str:
        """What the last load of this name found damaged, and what it returned instead."""
        return self._damage.get(name, "")

    def save(self, name: str, content: bytes) -> Saving:
        """Begin to replace the content under this name."""
        with self._lock:
            if (write := self._waiting.get(name)) is not None:
                write.content = content
                return write
            write = self._waiting[name] = _Write(content)
        self._last = write.future
        self._worker.submit(self._carry_out, name)
        return write

    def close(self) -> None:
        """Wait for what is under way."""
        self._worker.shutdown(wait=True)

    def _carry_out(self, name: str) -> None:
        with self._lock:
            write = self._waiting.pop(name)
        try:
            save_next(self._folder / name, write.content, self._write)
        except OSError as error:
            why = error.strerror or str(error) or type(error).__name__
            write.future.set_exception(StorageError(f"{name}: {why}"))
        except Exception as error:
            write.future.set_exception(error)
        else:
            write.future.set_result(None)
