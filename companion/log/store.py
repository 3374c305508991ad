"""The folder of logs: numbered files; the oldest are removed when they grow too large.

`files` is replaced as a whole and may be read from any thread. All other methods access the medium and run in
the log's worker.
"""

import logging
import os
import re
import shutil
from pathlib import Path
from typing import BinaryIO, NamedTuple

from companion.core.errors import StorageError

logger = logging.getLogger(__name__)

_NAME = re.compile(r"(\d{5,9})(?:-[\w.-]{1,60})?\.(bin|tlog)", re.ASCII)
_LAST = "LASTLOG.TXT"
_MB = 1_000_000
_EARLIEST_S = 1.0e9  # an earlier date means that the computer's clock was not set


class LogFile(NamedTuple):
    """One file. unix_s: time of the last write, 0 if unknown."""

    number: int
    name: str
    size_bytes: int
    unix_s: float

    @property
    def is_onboard_log(self) -> bool:
        """Whether it is an onboard log; the others are telemetry logs."""
        return self.name.endswith(".bin")


class LogStore:
    """Numbers are never reused, even after erasing: LASTLOG.TXT stores the last.
    Raises StorageError: the folder cannot be created or listed.
    """

    def __init__(self, folder: Path, quota_mb: float, min_free_mb: float = 0.0) -> None:
        self.folder = folder
        self.files: tuple[LogFile, ...] = ()  # oldest first
        self._last_number = 0
        self._quota_bytes = quota_mb * _MB
        self._min_free_mb = min_free_mb
        self._open: set[str] = set()
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self._scan()
        except OSError as error:
            raise StorageError(f"{folder}: cannot be used for logs: {error.strerror}") from None

    @property
    def logs(self) -> tuple[LogFile, ...]:
        """The onboard logs, oldest first."""
        return tuple(file for file in self.files if file.is_onboard_log)

    def find(self, name: str) -> LogFile | None:
        return next((file for file in self.files if file.name == name), None)

    def open(self, name: str) -> BinaryIO:
        """Open a listed file for reading. Raises StorageError: no such file, or it cannot be read."""
        if self.find(name) is None:
            raise StorageError(f"{name}: no such log")
        try:
            return (self.folder / name).open("rb")
        except OSError as error:
            raise StorageError(f"{name}: cannot be read: {error.strerror}") from None

    def create(self, suffix: str) -> tuple[str, BinaryIO]:
        """Make room and create a file; returns its name and the open file. `finish` ends it.
        Raises OSError: the medium is full or refuses.
        """
        self.make_room()
        free_mb = shutil.disk_usage(self.folder).free / _MB
        if free_mb < self._min_free_mb:
            raise OSError(f"only {free_mb:.0f} MB free, {self._min_free_mb:g} must stay free")
        number = self._last_number + 1
        name = f"{number:05d}{suffix}"
        last = self.folder / _LAST
        aside = last.with_suffix(".new")
        aside.write_bytes(b"%d\r\n" % number)  # DOS line ends, as ArduPilot writes it
        aside.replace(last)
        file = (self.folder / name).open("xb", buffering=0)
        self._last_number = number
        self._open.add(name)
        self.files = (*self.files, LogFile(number, name, 0, 0.0))
        return name, file

    def grew(self, name: str, size_bytes: int, unix_s: float) -> None:
        """Update size and time. unix_s: Unix time, 0 if unknown."""
        self.files = tuple(
            file._replace(size_bytes=size_bytes, unix_s=unix_s) if file.name == name else file
            for file in self.files
        )

    def date(self, name: str) -> None:
        """Set a file's date from the boat's time; the computer's may be wrong.
        Raises OSError: the medium refuses.
        """
        if (file := self.find(name)) is not None:
            os.utime(self.folder / name, (file.unix_s, file.unix_s))

    def finish(self, name: str) -> None:
        """A file is complete and may be removed."""
        self._open.discard(name)

    def drop_empty(self, name: str) -> None:
        """Remove an empty file after an error."""
        file = self.find(name)
        if file is not None and not file.size_bytes:
            self._remove(file)

    def make_room(self) -> None:
        """Remove the oldest files until the quota is met, except open ones."""
        excess = sum(file.size_bytes for file in self.files) - self._quota_bytes
        for file in self.files:
            if excess <= 0.0:
                return
            if self._remove(file):
                excess -= file.size_bytes

    def erase(self) -> None:
        """Remove all files except open ones."""
        for file in self.files:
            self._remove(file)

    def _remove(self, file: LogFile) -> bool:
        if file.name in self._open:
            return False
        try:
            (self.folder / file.name).unlink(missing_ok=True)
        except OSError as error:
            logger.warning("log %s cannot be removed: %s", file.name, error.strerror)
            return False
        self.files = tuple(one for one in self.files if one.name != file.name)
        return True

    def _scan(self) -> None:
        found: list[LogFile] = []
        for entry in os.scandir(self.folder):
            match = _NAME.fullmatch(entry.name)
            if match and entry.is_file(follow_symlinks=False):
                status = entry.stat()
                date_s = status.st_mtime if status.st_mtime > _EARLIEST_S else 0.0
                found.append(LogFile(int(match[1]), entry.name, status.st_size, date_s))
        self.files = tuple(sorted(found))
        self._last_number = max([0, _last_number(self.folder), *(file.number for file in found)])


def _last_number(folder: Path) -> int:
    try:
        return int((folder / _LAST).read_text(encoding="ascii"))
    except (OSError, ValueError):
        return 0
