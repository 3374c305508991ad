"""The tree of files that stations see: names at its root, each a folder of the disk or one that is made up.

A path is taken to pieces here, and only here: what is left of it are plain names, so nothing below can be led
out of its folder by `..`, a leading slash or a byte of zero.
"""

import errno
import zlib
from collections.abc import Mapping
from typing import NamedTuple, Protocol

from companion.services.ftp.frames import DATA_BYTES, Code, Refusal

Names = tuple[str, ...]
MAX_DEPTH = 16  # names in a path, the mount's with them
_CHUNK_BYTES = 64 * 1024


class Reading(Protocol):
    """A file opened for reading; of the size that it had then."""

    size: int

    def has(self, offset: int, count: int) -> bool:
        """Whether `read` can answer at once, without the disk."""

    def read(self, offset: int, count: int) -> bytes:
        """Up to count bytes of what is at hand; none at the end of the file."""

    def load(self, offset: int) -> None:
        """Bring what begins at an offset to hand. May wait for the disk."""

    def fetch(self, offset: int, count: int) -> bytes:
        """Up to count bytes of any part. May wait for the disk; what is at hand stays."""

    def close(self) -> None:
        """Let the file go. May be called twice."""


class DirectoryEntry(NamedTuple):
    """One line of a folder's list; size is None for a folder, −1 for what can be neither read nor entered."""

    name: str
    size: int | None


class Mount(Protocol):
    """A folder of the tree and everything below it. All of it raises Refusal or OSError.

    is_disk: calls may wait for a medium, and are made on a worker thread.
    """

    is_disk: bool

    def open(self, names: Names) -> Reading:
        """Open a file for reading."""

    def entries(self, names: Names) -> list[DirectoryEntry]:
        """What is in a folder, in a fixed order."""

    def begin(self, names: Names, keep: bool) -> bytes:
        """Check that a file may be written; what it holds before the first write: nothing unless keep."""

    def save(self, names: Names, content: bytes) -> None:
        """Replace a file's content, or make the file."""

    def truncate(self, names: Names, size: int) -> None:
        """Cut a file short."""

    def remove(self, names: Names) -> None:
        """Remove a file."""

    def make_folder(self, names: Names) -> None:
        """Make a folder."""

    def remove_folder(self, names: Names) -> None:
        """Remove an empty folder."""

    def rename(self, names: Names, to: Names) -> None:
        """Give a file or folder another place within this mount, where nothing is yet."""


class Place(NamedTuple):
    """A mount, and names from there on."""

    mount: Mount
    names: Names


class FileTree:
    """The mounts by name. An alias is a mount that lists do not show."""

    def __init__(self, mounts: Mapping[str, Mount], aliases: Mapping[str, Mount] | None = None) -> None:
        self._mounts = dict(mounts)
        self._all = {**self._mounts, **(aliases or {})}

    def find(self, path: bytes) -> Place | None:
        """Where a path leads; None is the root itself.

        Raises:
            Refusal: no such place can be.
        """
        names = split_path(path)
        if not names:
            return None
        mount = self._all.get(names[0])
        if mount is None:
            raise Refusal(Code.FILE_NOT_FOUND)
        return Place(mount, names[1:])

    def root_entries(self) -> list[DirectoryEntry]:
        """The mounts as folders."""
        return [DirectoryEntry(name, None) for name in sorted(self._mounts)]


def split_path(path: bytes) -> Names:
    """The names of a path.

    Raises:
        Refusal: it leads upwards, is no text, or nests too deep.
    """
    try:
        text = path.rstrip(b"\x00").decode("utf-8")
    except UnicodeDecodeError:
        raise Refusal(Code.FILE_NOT_FOUND) from None
    names = tuple(name for name in text.split("/") if name not in ("", "."))
    if ".." in names or len(names) > MAX_DEPTH or not text.isprintable():
        raise Refusal(Code.FILE_NOT_FOUND)
    return names


def page_of(entries: list[DirectoryEntry], first: int) -> bytes:
    """As much of a folder's list, from an index on, as one reply holds.

    Raises:
        Refusal: the list has ended.
    """
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
    """CRC-32 as MAVLink wants it: begun with 0 and not inverted at the end."""
    crc = 0xFFFFFFFF  # undoes zlib's first inversion
    offset = 0
    while part := reading.fetch(offset, _CHUNK_BYTES):
        crc = zlib.crc32(part, crc)
        offset += len(part)
    return crc ^ 0xFFFFFFFF


def refusal_of(error: OSError) -> Refusal:
    """What the system said, as the protocol says it."""
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
