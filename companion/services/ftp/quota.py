"""How much stations may leave in a folder: bytes, and entries, which take room even if empty."""

import errno
import os
import stat
from pathlib import Path

MOST_ENTRIES = 1000
"""Files, folders and links altogether. A list of them goes out in some 100 replies."""


class Quota:
    """What the folder holds is counted once, then kept up with every change, and counted again before a
    refusal: the owner of the boat may have made room meanwhile.
    """

    def __init__(self, folder: Path, most_bytes: int, most_entries: int = MOST_ENTRIES) -> None:
        self._folder = folder
        self._most_bytes = most_bytes
        self._most_entries = most_entries
        self._bytes = self._entries = 0
        self._is_counted = False

    def check(self, more_bytes: int, more_entries: int) -> None:
        """See whether there is room for this much more.

        Raises:
            OSError: there is not.
        """
        if self._is_counted and self._has_room(more_bytes, more_entries):
            return
        self._count()
        if not self._has_room(more_bytes, more_entries):
            raise OSError(errno.ENOSPC, "quota")

    def add(self, more_bytes: int, more_entries: int) -> None:
        """So much has come, or gone where it is negative."""
        self._bytes += more_bytes
        self._entries += more_entries

    def _has_room(self, more_bytes: int, more_entries: int) -> bool:
        # What makes the folder smaller always fits, even where it holds too much
        return (more_bytes <= 0 or self._bytes + more_bytes <= self._most_bytes) and (
            more_entries <= 0 or self._entries + more_entries <= self._most_entries
        )

    def _count(self) -> None:
        self._bytes = self._entries = 0
        for _, folders, files, descriptor in os.fwalk(self._folder):
            self._entries += len(folders) + len(files)
            self._bytes += sum(size_of(name, descriptor) or 0 for name in files)
        self._is_counted = True


def size_of(name: str, parent: int) -> int | None:
    """The bytes that a name counts for: a file's, none for a folder or link; None where nothing has it."""
    try:
        status = os.stat(name, dir_fd=parent, follow_symlinks=False)
    except FileNotFoundError:
        return None
    return status.st_size if stat.S_ISREG(status.st_mode) else 0
