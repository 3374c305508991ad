"""A small file of a part's own calibration, which survives a power cut in the middle of a write."""

import logging
from pathlib import Path

from companion.core.generations import find_newest, save_next, write_atomically

_log = logging.getLogger(__name__)


class ProfileFile:
    """Read and written by the part's thread. Damage and a full disk cost the profile, nothing else."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def load(self) -> bytes:
        """The newest intact profile, empty without one."""
        try:
            return find_newest(self._path).generation.content
        except OSError as error:
            _log.warning("%s: cannot be read: %s", self._path, error)
            return b""

    def save(self, content: bytes) -> None:
        """Replace the profile."""
        try:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            save_next(self._path, content, write_atomically)
        except OSError as error:
            _log.warning("%s: cannot be written: %s", self._path, error)
