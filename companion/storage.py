"""The boat's memory: small files that hold the old content or the new, never a mixture.

A save writes a file aside, flushes it to the medium and renames it over the old one (write, fsync, rename),
on a worker thread, because an SD card may take a tenth of a second and the control loop must not wait.
"""

import logging
import os
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor, wait
from pathlib import Path
from typing import Protocol

from companion.errors import StorageError

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

    def save(self, name: str, content: bytes) -> Saving:
        """Replace the content under this name."""
        self.content[name] = content
        return _Done()

    def close(self) -> None:
        """Nothing to wait for."""


class _FutureSaving:
    def __init__(self, future: "Future[None]") -> None:
        self._future = future

    def is_done(self) -> bool:
        return self._future.done()

    def error(self) -> str:
        fault = self._future.exception(timeout=0)
        return "" if fault is None else str(fault) or type(fault).__name__


class FolderStorage:
    """Files in a folder, which is made when missing.

    Raises:
        StorageError: the folder cannot be made, or a file in it cannot be read.
    """

    def __init__(self, folder: Path, write: Callable[[Path, bytes], None] | None = None) -> None:
        self._folder = folder
        self._write = write or write_atomically
        self._worker = ThreadPoolExecutor(max_workers=1, thread_name_prefix="storage")
        self._under_way: list[Future[None]] = []
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise StorageError(f"{folder}: cannot be used to store missions: {error.strerror}") from None

    @property
    def folder(self) -> Path:
        """Where it all is."""
        return self._folder

    def load(self, name: str) -> bytes:
        """The content last saved under this name, empty when there is none."""
        try:
            wait(self._under_way)
            return (self._folder / name).read_bytes()
        except FileNotFoundError:
            return b""
        except OSError as error:
            raise StorageError(f"{self._folder / name}: cannot be read: {error.strerror}") from None

    def save(self, name: str, content: bytes) -> Saving:
        """Begin to replace the content under this name; saves are carried out in order."""
        saving = self._worker.submit(self._write, self._folder / name, content)
        self._under_way = [saving]  # one worker: the last to begin is the last to end
        return _FutureSaving(saving)

    def close(self) -> None:
        """Wait for what is under way."""
        self._worker.shutdown(wait=True)


def write_atomically(path: Path, content: bytes) -> None:
    """Replace a file so that a power cut leaves the old content or the new. A *.key is its owner's alone."""
    aside = path.with_name(path.name + ".new")
    if path.suffix == ".key":
        aside.unlink(missing_ok=True)
        aside.touch(mode=0o600, exist_ok=False)
    with aside.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    aside.replace(path)
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)
