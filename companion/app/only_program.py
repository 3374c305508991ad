"""One program a boat: a second one would drive the same pins and write the same files."""

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from companion.core.errors import StorageError


@contextmanager
def only_program(folder: str) -> Iterator[None]:
    """Lock the folder of the boat's files, if there is one that can be locked.

    Raises:
        StorageError: another program has locked it.
    """
    descriptor = -1
    if folder:
        path = Path(folder).expanduser()
        with suppress(OSError):  # the storage will tell
            path.mkdir(parents=True, exist_ok=True)
            descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
    try:
        if descriptor >= 0:
            _lock(descriptor, folder)
        yield
    finally:
        if descriptor >= 0:
            os.close(descriptor)


def _lock(descriptor: int, folder: str) -> None:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise StorageError(
            f"{folder}: another program runs this boat: end it (sudo systemctl stop mavboat), or change "
            "storage.folder"
        ) from None
    except OSError:  # a file system without locks
        return
