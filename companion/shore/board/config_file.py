"""The boat's configuration file: read, replaced whole, and its five latest predecessors kept beside it.

A power cut leaves the old file or the new one: the new text is on the medium before it takes the name.
"""

import contextlib
import hashlib
import os
import stat
from pathlib import Path
from typing import Final

from msgspec import Struct

from companion.core.errors import ConfigError, StorageError
from companion.shore.words import say

MOST_BYTES: Final = 64_000
KEPT: Final = 5


class ConfigText(Struct, frozen=True):
    """hash: of its bytes, to be named by whoever replaces it. time_s: when it was written, Unix time."""

    text: str
    hash: str
    time_s: float


class Kept(Struct, frozen=True):
    """An earlier configuration. number: 1 is the latest."""

    number: int
    time_s: float


class ChangedError(ConfigError):
    """The file is no longer the one that was read."""


class ConfigFile:
    """A TOML file. Every method blocks: call them in a thread, one at a time."""

    def __init__(self, path: Path) -> None:
        self.path = path.resolve()

    def read(self, number: int = 0) -> ConfigText:
        """The configuration, or an earlier one by its number.

        Raises:
            StorageError: it cannot be read, is too large, or no UTF-8.
        """
        path = self._kept(number)
        content, time_s = _read(path)
        try:
            text = content.decode()
        except UnicodeDecodeError:
            raise StorageError(say("board.not_utf8", file=str(path))) from None
        return ConfigText(text, _hash(content), time_s)

    def kept(self) -> list[Kept]:
        """The earlier ones, latest first."""
        found = []
        for number in range(1, KEPT + 1):
            with contextlib.suppress(OSError):
                found.append(Kept(number, self._kept(number).lstat().st_mtime))
        return found

    def write(self, text: str, replaced: str) -> ConfigText:
        """Replace the text. replaced: the hash of the one to replace.

        Raises:
            ChangedError: the file has another hash.
            StorageError: it cannot be written.
        """
        content = encode(text)
        before, _ = _read(self.path)
        if _hash(before) != replaced:
            raise ChangedError(say("board.changed"))
        if content != before:
            try:
                self._replace(before, content)
            except OSError as error:
                raise StorageError(
                    say("board.unwritable", file=str(self.path), why=error.strerror or "")
                ) from None
        return self.read()

    def _replace(self, before: bytes, content: bytes) -> None:
        """The earlier ones move up by one, and the present text becomes the first of them."""
        status = self.path.stat()
        for number in range(KEPT - 1, 0, -1):
            with contextlib.suppress(FileNotFoundError):
                self._kept(number).replace(self._kept(number + 1))
        _put(self._kept(1), before, status.st_mode)
        os.utime(self._kept(1), ns=(status.st_atime_ns, status.st_mtime_ns))
        _put(self.path, content, status.st_mode)

    def _kept(self, number: int) -> Path:
        if not 0 <= number <= KEPT:
            raise StorageError(say("board.no_earlier", n=number, most=KEPT))
        return self.path.with_name(f"{self.path.name}.{number}") if number else self.path


def encode(text: str) -> bytes:
    """The bytes of a configuration.

    Raises:
        ConfigError: no UTF-8, or too large.
    """
    try:
        content = text.encode()
    except UnicodeEncodeError:
        raise ConfigError(say("board.not_unicode")) from None
    if len(content) > MOST_BYTES:
        raise ConfigError(say("board.too_long", n=len(content), most=MOST_BYTES))
    return content


def _read(path: Path) -> tuple[bytes, float]:
    """The content and when it was written."""
    flags = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
    try:
        with os.fdopen(os.open(path, flags), "rb") as file:
            status = os.fstat(file.fileno())
            content = file.read(MOST_BYTES + 1) if stat.S_ISREG(status.st_mode) else None
    except OSError as error:
        raise StorageError(say("board.unreadable", file=str(path), why=error.strerror or "")) from None
    if content is None:
        raise StorageError(say("board.no_file", file=str(path)))
    if len(content) > MOST_BYTES:
        raise StorageError(say("board.too_large", file=str(path), most=MOST_BYTES))
    return content, status.st_mtime


def _put(path: Path, content: bytes, mode: int) -> None:
    """A file as a whole, on the medium before it takes the name."""
    aside = path.with_name(f".{path.name}.new")
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC
    aside.unlink(missing_ok=True)  # of a write that a power cut ended
    try:
        with os.fdopen(os.open(aside, flags, 0o600), "wb") as file:
            file.write(content)
            os.fchmod(file.fileno(), stat.S_IMODE(mode))
            file.flush()
            os.fsync(file.fileno())
        aside.replace(path)
        _sync_folder(path.parent)
    except OSError:
        aside.unlink(missing_ok=True)
        raise


def _hash(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def _sync_folder(folder: Path) -> None:
    number = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(number)
    finally:
        os.close(number)
