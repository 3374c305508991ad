"""The simulated computer of the boat: power, clock, disk and radio.

`Lockstep` and `Server` run the `Boat` on it while there is power, and build a new one over the same storage
when `boots` increases.
"""

import errno
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

from companion.core.generations import Write, write_atomically
from companion.core.storage import Saving, Storage, ended
from sitl.radio.channel import WHOLE, Quality

_FULL = os.strerror(errno.ENOSPC)


class Clocked(Protocol):
    """A driver that stamps readings with the computer's clock and loses them at a restart."""

    clock_offset_s: float

    def restart(self) -> None:
        """Forget all readings."""


class Computer:
    """clock_offset_s: its clock minus the world's. load: simulated share of a tick that the program needs."""

    def __init__(self, drivers: Sequence[Clocked] = ()) -> None:
        self._drivers = drivers
        self.boots = 1
        self.has_power = True
        self.clock_offset_s = 0.0
        self.disk_is_full = False
        self.load = 0.0
        self.link_quality: Quality = WHOLE  # of every link, on top of its own

    def lose_power(self) -> None:
        """Stop the program at once; unstored data is lost."""
        self.has_power = False

    def begin(self, now_s: float) -> None:
        """Restart the program; its clock starts at zero."""
        self.has_power = True
        self.boots += 1
        self.set_clock_offset(-now_s)
        for driver in self._drivers:
            driver.restart()

    def set_clock_offset(self, offset_s: float) -> None:
        """Set the offset of the computer's clock from the world's."""
        self.clock_offset_s = offset_s
        for driver in self._drivers:
            driver.clock_offset_s = offset_s


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
        return ended(_FULL) if self._computer.disk_is_full else self._storage.save(name, content)

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
