"""Files with a checksum and a generation number, of which the disk keeps the newest two.

The first line of a file seals it:

    # mavboat generation 17, 1234 bytes, crc32 0a1b2c3d

The checksum covers the line up to the comma before `crc32`, and the content behind the line. CRC-32 detects
every error of one or two bits and every burst of up to 32 bits in a file of this size (Koopman, "32-Bit
Cyclic Redundancy Codes for Internet Applications", DSN 2002). The line is a comment in parameter files; JSON
readers other than ours have to skip it.

A write goes to `NAME.new`, is flushed, and then `NAME` becomes `NAME.old` and `NAME.new` becomes `NAME`.
After a power cut at any point at least one of the three is whole; of those that are whole, the one with the
highest generation counts.

A file without the line is taken as it is: earlier versions of the program wrote such files, and people put
them there by hand. It takes precedence over every generation.
"""

import contextlib
import errno
import os
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

_MARKS = (b"# mavboat generation", b"crc32")
"""A damaged first line still has one of these: a flipped bit cannot break both."""
_HEAD_BYTES = 96  # longer than any first line of ours; damage may have put a line's end into it
_MOST_DIGITS = 18  # of a generation; Python refuses to read a number of thousands of digits
_OLD, _NEW = ".old", ".new"


class DamagedError(ValueError):
    """The content is not what was written."""


class Generation(NamedTuple):
    """What one file holds. number is 0 where it is not sealed."""

    number: int
    content: bytes


class Found(NamedTuple):
    """The newest whole generation, an empty one where there is none, and what is wrong with a newer one."""

    generation: Generation
    damage: str
    is_aside: bool  # it is in NAME.new: power was cut between the last flush and the last rename


Write = Callable[[Path, bytes, Path | None], None]
"""Replaces a file; where the third is given, the file's present content is kept under that name."""


def seal(generation: Generation) -> bytes:
    """The file of a generation."""
    number, content = generation
    head = b"# mavboat generation %d, %d bytes" % (number, len(content))
    return b"%s, crc32 %08x\n%s" % (head, zlib.crc32(content, zlib.crc32(head)), content)


def unseal(file: bytes) -> Generation:
    """What a file holds, sealed or not.

    Raises:
        DamagedError: it is not what was written.
    """
    line, _, content = file.partition(b"\n")
    if not any(mark in file[:_HEAD_BYTES] for mark in _MARKS):
        # Nothing of ours is empty, holds zero bytes, or is cut off within its first line
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
    """The newest whole generation of a file.

    Raises:
        OSError: a file is there, but cannot be read.
    """
    none = Generation(0, b"")
    current, fault = _read(path)
    if current is not None and not current.number:
        return Found(current, "", is_aside=False)
    aside, _ = _read(path.with_name(path.name + _NEW))  # a write that was cut off may leave a part there
    old, old_fault = _read(path.with_name(path.name + _OLD))
    if aside is not None and aside.number > (current or none).number:
        return Found(aside, "", is_aside=True)
    if current is not None:
        return Found(current, "", is_aside=False)
    if not fault and (old is not None or old_fault):
        fault = "it is missing"
    return Found(old or none, fault, is_aside=False)


def save_next(path: Path, content: bytes, write: Write) -> None:
    """Write the next generation of a file, and keep the newest whole one there is.

    Raises:
        OSError: the medium refuses.
    """
    found = find_newest(path)
    if found.is_aside:  # the only copy of it must not be overwritten
        path.with_name(path.name + _NEW).replace(path)
    old = path.with_name(path.name + _OLD)
    number = 1 + max(found.generation.number, _number_of(old))
    has_whole = not found.damage and path.exists()
    write(path, seal(Generation(number, content)), old if has_whole else None)


def write_atomically(path: Path, content: bytes, keep: Path | None = None) -> None:
    """Replace a file so that a power cut leaves the old content or the new. A *.key is its owner's alone.

    keep: the name under which the present file is kept. Nothing is left lying about when the medium refuses.
    """
    aside = path.with_name(path.name + _NEW)
    try:
        if path.suffix == ".key":
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
            if path.exists():
                aside.unlink(missing_ok=True)
        raise
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


def _read(path: Path) -> tuple[Generation | None, str]:
    """What a file holds, or what is wrong with it; (None, "") where there is none."""
    try:
        return unseal(path.read_bytes()), ""
    except FileNotFoundError:
        return None, ""
    except DamagedError as error:
        return None, str(error)
    except OSError as error:
        if error.errno != errno.EIO:  # which a worn card answers for a single bad block
            raise
        return None, "the medium cannot read it"


def _number_of(path: Path) -> int:
    generation, _ = _read(path)
    return 0 if generation is None else generation.number
