"""Files with a checksum and a generation number; the newest two generations are kept.

The first line of a file:

    # mavboat generation 17, 1234 bytes, crc32 0a1b2c3d

The checksum covers the line up to the comma before `crc32`, and the content after the line. CRC-32 detects
every error of one or two bits and every burst of up to 32 bits in a file of this size (Koopman, "32-Bit
Cyclic Redundancy Codes for Internet Applications", DSN 2002). The line is a comment in parameter files; other
JSON readers must skip it.

A write goes to `NAME.new` and is flushed; then `NAME` becomes `NAME.old`, and `NAME.new` becomes `NAME`.
After a power cut at any point at least one of the three is intact; of the intact ones, the highest generation
is used.

A file without the line is accepted as it is: earlier versions wrote such files, and users create them. It
takes precedence over every generation.
"""

import contextlib
import errno
import logging
import os
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

_MARKS = (b"# mavboat generation", b"crc32")
"""A damaged first line still has one of these: a single bit error cannot break both."""
_HEAD_BYTES = 96  # longer than any first line; damage may have inserted a line end
_MOST_DIGITS = 18  # of a generation; Python rejects numbers of thousands of digits
_OLD, _NEW = ".old", ".new"


class DamagedError(ValueError):
    """The content differs from what was written."""


class Generation(NamedTuple):
    """Content of a file. number: 0 if it has no generation line."""

    number: int
    content: bytes


class Found(NamedTuple):
    """The newest intact generation, empty if there is none, and the damage of a newer one."""

    generation: Generation
    damage: str
    is_aside: bool  # it is in NAME.new: power was cut before the last rename


Write = Callable[[Path, bytes, Path | None], None]
"""Replaces a file; the present content is kept under the third argument, if given."""


def seal(generation: Generation) -> bytes:
    """The file of a generation."""
    number, content = generation
    head = b"# mavboat generation %d, %d bytes" % (number, len(content))
    return b"%s, crc32 %08x\n%s" % (head, zlib.crc32(content, zlib.crc32(head)), content)


def unseal(file: bytes) -> Generation:
    """Content of a file, with or without a generation line. Raises DamagedError: it is damaged."""
    line, _, content = file.partition(b"\n")
    if not any(mark in file[:_HEAD_BYTES] for mark in _MARKS):
        # Our files are never empty, have no zero bytes, and are never cut off within the first line
        if not file or b"\x00" in file or _MARKS[0].startswith(file):
            raise DamagedError("it is cut off or overwritten")
        return Generation(0, file)
    number = line.removeprefix(_MARKS[0]).partition(b",")[0].strip()
    if not number.isdigit() or len(number) > _MOST_DIGITS:
        raise DamagedError("its first line is damaged")
    generation = Generation(int(number), content)
    if seal(generation) != file:
        raise DamagedError("its checksum is wrong")
    return generation


def find_newest(path: Path) -> Found:
    """The newest intact generation of a file. Raises OSError: a file exists but cannot be read."""
    none = Generation(0, b"")
    current, fault = _read(path)
    if current is not None and not current.number:
        return Found(current, "", is_aside=False)
    aside, _ = _read(path.with_name(path.name + _NEW))  # may be an incomplete write
    old, old_fault = _read(path.with_name(path.name + _OLD))
    if aside is not None and aside.number > (current or none).number:
        return Found(aside, "", is_aside=True)
    if current is not None:
        return Found(current, "", is_aside=False)
    if not fault and (old is not None or old_fault):
        fault = "it is missing"
    return Found(old or none, fault, is_aside=False)


def save_next(path: Path, content: bytes, write: Write) -> None:
    """Write the next generation of a file, and keep the newest intact one.
    Raises OSError: the medium refuses.
    """
    found = find_newest(path)
    if found.is_aside:  # it is the only copy
        path.with_name(path.name + _NEW).replace(path)
    old = path.with_name(path.name + _OLD)
    number = 1 + max(found.generation.number, _number_of(old))
    has_whole = not found.damage and path.exists()
    write(path, seal(Generation(number, content)), old if has_whole else None)


def write_atomically(
    path: Path, content: bytes, keep: Path | None = None, *, is_private: bool = False
) -> None:
    """Replace a file so that a power cut leaves the old or the new content.

    keep: name under which the present file is kept. is_private: readable by its owner only, as every *.key
    is. On failure no temporary file is left.
    """
    aside = path.with_name(path.name + _NEW)
    try:
        if is_private or path.suffix == ".key":
            aside.unlink(missing_ok=True)
            aside.touch(mode=0o600, exist_ok=False)
        with aside.open("wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        if keep is not None:
            path.replace(keep)
        aside.replace(path)
    except OSError:
        with contextlib.suppress(OSError):
            if keep is None or path.exists():
                aside.unlink(missing_ok=True)
        raise
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


def _read(path: Path) -> tuple[Generation | None, str]:
    """Content of a file, or its damage; (None, "") if it does not exist."""
    try:
        return unseal(path.read_bytes()), ""
    except FileNotFoundError:
        return None, ""
    except DamagedError as error:
        return None, str(error)
    except OSError as error:
        if error.errno != errno.EIO:  # a bad block of a worn card
            raise
        return None, "the medium cannot read it"


def _number_of(path: Path) -> int:
    generation, _ = _read(path)
    return 0 if generation is None else generation.number


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
        try:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            save_next(self._path, content, write_atomically)
        except OSError as error:
            _log.warning("%s: cannot be written: %s", self._path, error)
