"""The medium that the boat stores on, which may be full."""

import errno
import os
from pathlib import Path

from companion.core.generations import Write, write_atomically
from companion.core.storage import Saving, Storage
from sitl.world.computer import Computer

_FULL = os.strerror(errno.ENOSPC)


class _Refused:
    def is_done(self) -> bool:
        return True

    def error(self) -> str:
        return _FULL


class Disk:
    """Satisfies `companion.core.storage.Storage` over another one. It outlives the boat's program."""

    def __init__(self, storage: Storage, computer: Computer) -> None:
        self._storage = storage
        self._computer = computer

    def load(self, name: str) -> bytes:
        """The content last saved under this name, empty when there is none."""
        return self._storage.load(name)

    def damage(self, name: str) -> str:
        """What the last load of this name found damaged."""
        return self._storage.damage(name)

    def save(self, name: str, content: bytes) -> Saving:
        """Replace the content under this name, unless there is no room."""
        return _Refused() if self._computer.disk_is_full else self._storage.save(name, content)

    def close(self) -> None:
        """Let the storage go."""
        self._storage.close()


def file_writer(computer: Computer) -> Write:
    """Writes files, for `FolderStorage`, as long as there is room."""

    def write(path: Path, content: bytes, keep: Path | None) -> None:
        if computer.disk_is_full:
            raise OSError(errno.ENOSPC, _FULL, str(path))
        write_atomically(path, content, keep)

    return write
