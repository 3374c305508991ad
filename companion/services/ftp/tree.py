"""The file tree seen by stations: mounts at its root, each a folder on disk or virtual.

Paths are parsed only here, into plain names, so nothing below can leave its folder through `..`, a leading
slash or a zero byte.
"""

import errno
import zlib
from collections.abc import Mapping
from typing import NamedTuple, Protocol

from companion.mavlink.ftp_frames import DATA_BYTES, Code, Refusal

Names = tuple[str, ...]
MAX_DEPTH = 16  # names in a path, including the mount
_CHUNK_BYTES = 64 * 1024


class Reading(Protocol):
    """A file open for reading, with its size at that time."""

    size: int

    def has(self, offset: int, count: int) -> bool:
        """Whether `read` can answer without the disk."""

    def read(self, offset: int, count: int) -> bytes:
        """Up to count bytes in memory; none at the end of the file."""

    def load(self, offset: int) -> None:
        """Load the part at an offset. May wait for the disk."""

    def fetch(self, offset: int, count: int) -> bytes:
        """Up to count bytes of any part. May wait for the disk; the loaded part is kept."""

    def close(self) -> None:
        """Close the file. May be called twice."""


class DirectoryEntry(NamedTuple):
    """An entry of a listing; size is None for a folder, −1 if not accessible."""

    name: str
    size: int | None


class Mount(Protocol):
    """A folder of the tree and everything below. Methods raise Refusal or OSError.

    is_disk: calls may wait for the disk and run in the worker.
    """

    is_disk: bool

    def open(self, names: Names) -> Reading:
        """Open a file for reading."""

    def entries(self, names: Names) -> list[DirectoryEntry]:
        """The entries of a folder, in a fixed order."""

    def begin(self, names: Names, keep: bool) -> bytes:
        """Check that a file may be written; returns its initial content: empty unless keep."""

    def save(self, names: Names, content: bytes) -> None:
        """Create or replace a file."""

    def truncate(self, names: Names, size: int) -> None:
        """Shorten a file."""

    def remove(self, names: Names) -> None:
        """Remove a file."""

    def make_folder(self, names: Names) -> None:
        """Make a folder."""

    def remove_folder(self, names: Names) -> None:
        """Remove an empty folder."""

    def rename(self, names: Names, to: Names) -> None:
        """Move a file or folder within this mount to a free name."""


class Place(NamedTuple):
    """A mount and the names below it."""

    mount: Mount
    names: Names


class FileTree:
    """The mounts by name. An alias is a mount that is not listed."""

    def __init__(self, mounts: Mapping[str, Mount], aliases: Mapping[str, Mount] | None = None) -> None:
        self._mounts = dict(mounts)
        self._all = {**self._mounts, **(aliases or {})}

    def find(self, path: bytes) -> Place | None:
        """Resolve a path; None is the root. Raises Refusal: no such place."""
        names = split_path(path)
        if not names:
            return None
        mount = self._all.get(names[0])
        if mount is None:
            raise Refusal(Code.FILE_NOT_FOUND)
        return Place(mount, names[1:])

    def root_entries(self) -> list[DirectoryEntry]:
        return [DirectoryEntry(name, None) for name in sorted(self._mounts)]


def split_path(path: bytes) -> Names:
    """The names of a path. Raises Refusal: it leads upwards, is not text, or is too deep."""
    try:
        text = path.rstrip(b"\x00").decode("utf-8")
    except UnicodeDecodeError:
        raise Refusal(Code.FILE_NOT_FOUND) from None
    names = tuple(name for name in text.split("/") if name not in ("", "."))
    if ".." in names or len(names) > MAX_DEPTH or not text.isprintable():
        raise Refusal(Code.FILE_NOT_FOUND)
    return names


def page_of(entries: list[DirectoryEntry], first: int) -> bytes:
    """The part of a listing from an index that fits one reply. Raises Refusal: the end of the listing."""
    page = b""
    for entry in entries[first:]:
        line = _line(entry)
        if len(page) + len(line) > DATA_BYTES:
            break
        page += line
    if not page:
        raise Refusal(Code.END_OF_FILE)
    return page


def _line(entry: DirectoryEntry) -> bytes:
    if not entry.name.isprintable() or entry.size == -1:
        line = "S"
    else:
        line = f"D{entry.name}" if entry.size is None else f"F{entry.name}\t{entry.size}"
    raw = line.encode("utf-8") + b"\x00"
    return raw if len(raw) <= DATA_BYTES else b"S\x00"


def checksum(reading: Reading) -> int:
    """CRC-32 as in MAVLink: starts with 0, not inverted at the end."""
    crc = 0xFFFFFFFF  # undoes zlib's first inversion
    offset = 0
    while part := reading.fetch(offset, _CHUNK_BYTES):
        crc = zlib.crc32(part, crc)
        offset += len(part)
    return crc ^ 0xFFFFFFFF


def refusal_of(error: OSError) -> Refusal:
    number = error.errno or errno.EIO
    for code, numbers in _CODES.items():
        if number in numbers:
            return Refusal(code)
    return Refusal(Code.FAIL_ERRNO, number)


_CODES = {
    Code.FILE_NOT_FOUND: {errno.ENOENT, errno.ENOTDIR, errno.ELOOP},
    Code.FILE_EXISTS: {errno.EEXIST},
    Code.FILE_PROTECTED: {errno.EACCES, errno.EPERM, errno.EROFS},
}
