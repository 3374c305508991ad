"""Quota of a folder: bytes and entries."""

import errno
import os
import stat
from pathlib import Path

MOST_ENTRIES = 1000
"""Files, folders and links altogether. A list of them goes out in some 100 replies."""


class Quota:
    """The content is counted once, updated with each change, and counted again before a refusal, as files may
    have been removed.
    """

    def __init__(self, folder: Path, most_bytes: int) -> None:
        self._folder = folder
        self._most_bytes = most_bytes
        self._bytes = self._entries = 0
        self._is_counted = False

    def check(self, more_bytes: int, more_entries: int) -> None:
        """Check for room. Raises OSError: there is none."""
        if self._is_counted and self._has_room(more_bytes, more_entries):
            return
        self._count()
        if not self._has_room(more_bytes, more_entries):
            raise OSError(errno.ENOSPC, "quota")

    def add(self, more_bytes: int, more_entries: int) -> None:
        self._bytes += more_bytes
        self._entries += more_entries

    def _has_room(self, more_bytes: int, more_entries: int) -> bool:
        # Shrinking is always allowed
        return (more_bytes <= 0 or self._bytes + more_bytes <= self._most_bytes) and (
            more_entries <= 0 or self._entries + more_entries <= MOST_ENTRIES
        )

    def _count(self) -> None:
        self._bytes = self._entries = 0
        for _, folders, files, descriptor in os.fwalk(self._folder):
            self._entries += len(folders) + len(files)
            self._bytes += sum(size_of(name, descriptor) or 0 for name in files)
        self._is_counted = True


def size_of(name: str, parent: int) -> int | None:
    """Size of a file, 0 for a folder or link; None if it does not exist."""
    try:
        status = os.stat(name, dir_fd=parent, follow_symlinks=False)
    except FileNotFoundError:
        return None
    return status.st_size if stat.S_ISREG(status.st_mode) else 0
