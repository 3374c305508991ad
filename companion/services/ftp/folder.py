"""A folder on disk as seen by stations, and nothing outside it.

Every name is opened relative to its parent and never through a link, so no link leads out, even if it appears
during the access. New content is written to a temporary file and renamed, so a power cut leaves the old or
the new file.
"""

import errno
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from companion.mavlink.ftp_frames import Code, Refusal
from companion.services.ftp.quota import Quota, size_of
from companion.services.ftp.tree import MAX_DEPTH, DirectoryEntry, Names

_WINDOW_BYTES = 256 * 1024
_MAX_ENTRIES = 10_000
_ROOT = os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC  # the root itself may be a link
_FOLDER = _ROOT | os.O_NOFOLLOW
_FILE = os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC  # do not block on a pipe


class DiskReading:
    """Satisfies `Reading`: a file with a window in memory. Later growth is ignored."""

    def __init__(self, descriptor: int, size: int) -> None:
        """Takes ownership of the descriptor."""
        self.size = size
        self._descriptor = descriptor
        self._window = (0, b"")

    def has(self, offset: int, count: int) -> bool:
        begin, window = self._window
        end = min(offset + count, self.size)
        return offset >= self.size or (begin <= offset and end <= begin + len(window))

    def read(self, offset: int, count: int) -> bytes:
        begin, window = self._window
        return window[offset - begin : offset - begin + count] if offset >= begin else b""

    def load(self, offset: int) -> None:
        """Move the window. A file that was truncated ends there."""
        window = self.fetch(offset, _WINDOW_BYTES)
        if len(window) < _WINDOW_BYTES:
            self.size = offset + len(window)
        self._window = (offset, window)

    def fetch(self, offset: int, count: int) -> bytes:
        count = min(count, self.size - offset)
        return os.pread(self._descriptor, count, offset) if self._descriptor >= 0 and count > 0 else b""

    def close(self) -> None:
        descriptor, self._descriptor = self._descriptor, -1
        if descriptor >= 0:
            os.close(descriptor)


class FolderMount:
    """Satisfies `Mount` with a folder that need not exist yet."""

    is_disk = True

    def __init__(self, folder: Path, *, quota_bytes: int = 0) -> None:
        """quota_bytes: total size limit; 0: read only."""
        self._folder = folder
        self._quota_bytes = quota_bytes
        self._quota = Quota(folder, quota_bytes)
        self._aside = folder.with_name(f".{folder.name}.new")  # on the same disk, outside the folder
        if quota_bytes:
            with suppress(OSError):  # a read-only medium; writing will say so
                folder.mkdir(parents=True, exist_ok=True)

    def open(self, names: Names) -> DiskReading:
        with self._parent(names) as (parent, name):
            reading = DiskReading(*_open_file(name, os.O_RDONLY, parent))
        try:
            reading.load(0)
        except BaseException:
            reading.close()
            raise
        return reading

    def entries(self, names: Names) -> list[DirectoryEntry]:
        """Folders and files by name; links and devices are listed without access."""
        try:
            with self._walk(names) as descriptor, os.scandir(descriptor) as found:
                entries = [_entry(one) for one, _ in zip(found, range(_MAX_ENTRIES), strict=False)]
        except FileNotFoundError:
            if names:
                raise
            return []
        return sorted(entries)

    def begin(self, names: Names, keep: bool) -> bytes:
        """Accepts a file or a free name in an existing folder."""
        self._check_writable(names)
        with self._parent(names) as (parent, name):
            try:
                descriptor, size = _open_file(name, os.O_RDONLY, parent)
            except FileNotFoundError:
                self._quota.check(0, 1)
                return b""
            try:
                if size > self._quota_bytes:
                    raise OSError(errno.EFBIG, "larger than what may be written")
                return os.pread(descriptor, size, 0) if keep else b""
            finally:
                os.close(descriptor)

    def save(self, names: Names, content: bytes) -> None:
        """Write to a temporary file, flush, rename."""
        self._check_writable(names)
        with self._parent(names) as (parent, name):
            replaced = size_of(name, parent)
            growth = len(content) - (replaced or 0), 1 if replaced is None else 0
            self._quota.check(*growth)
            try:
                with self._aside.open("wb") as file:
                    file.write(content)
                    file.flush()
                    os.fsync(file.fileno())
                os.rename(self._aside, name, dst_dir_fd=parent)
            except OSError:
                with suppress(OSError):
                    self._aside.unlink(missing_ok=True)  # on a full disk a part of it would keep its room
                raise
            self._quota.add(*growth)
            os.fsync(parent)

    def truncate(self, names: Names, size: int) -> None:
        """Shorten a file; never extend it."""
        self._check_writable(names)
        with self._parent(names) as (parent, name):
            descriptor, has = _open_file(name, os.O_WRONLY, parent)
            try:
                if size > has:
                    raise OSError(errno.EINVAL, "beyond the end")
                os.ftruncate(descriptor, size)
                self._quota.add(size - has, 0)
                os.fsync(descriptor)
            finally:
                os.close(descriptor)

    def remove(self, names: Names) -> None:
        """Remove a file or a link, not a folder."""
        self._check_writable(names)
        with self._parent(names) as (parent, name):
            size = size_of(name, parent) or 0
            os.unlink(name, dir_fd=parent)
            self._quota.add(-size, -1)

    def make_folder(self, names: Names) -> None:
        self._check_writable(names)
        with self._parent(names) as (parent, name):
            self._quota.check(0, 1)
            os.mkdir(name, dir_fd=parent)
            self._quota.add(0, 1)

    def remove_folder(self, names: Names) -> None:
        self._check_writable(names)
        with self._parent(names) as (parent, name):
            os.rmdir(name, dir_fd=parent)
            self._quota.add(0, -1)

    def rename(self, names: Names, to: Names) -> None:
        """Move within the folder, never over an existing name or beyond the depth limit."""
        self._check_writable(names)
        self._check_writable(to)
        with self._parent(names) as (source, name), self._parent(to) as (goal, new_name):
            os.stat(name, dir_fd=source, follow_symlinks=False)
            if 1 + len(to) + _height(name, source) > MAX_DEPTH:
                raise OSError(errno.ENAMETOOLONG, "too deep")
            try:
                os.stat(new_name, dir_fd=goal, follow_symlinks=False)
            except FileNotFoundError:
                os.rename(name, new_name, src_dir_fd=source, dst_dir_fd=goal)
            else:
                raise Refusal(Code.FILE_EXISTS)

    def _check_writable(self, names: Names) -> None:
        if not self._quota_bytes or not names:
            raise Refusal(Code.FILE_PROTECTED)

    @contextmanager
    def _walk(self, names: Names) -> Iterator[int]:
        """Descriptor of a folder, opened name by name without following links."""
        descriptor = os.open(self._folder, _ROOT)
        try:
            for name in names:
                below = os.open(name, _FOLDER, dir_fd=descriptor)
                os.close(descriptor)
                descriptor = below
            yield descriptor
        finally:
            os.close(descriptor)

    @contextmanager
    def _parent(self, names: Names) -> Iterator[tuple[int, str]]:
        if not names:
            raise Refusal(Code.FILE_NOT_FOUND)
        with self._walk(names[:-1]) as descriptor:
            yield descriptor, names[-1]


def _height(name: str, parent: int) -> int:
    """Depth of the deepest path below this name; 0 for a file or an empty folder."""
    if not stat.S_ISDIR(os.stat(name, dir_fd=parent, follow_symlinks=False).st_mode):
        return 0
    found = os.fwalk(name, dir_fd=parent)
    return max(path.count(os.sep) + bool(folders or files) for path, folders, files, _ in found)


def _open_file(name: str, flags: int, parent: int) -> tuple[int, int]:
    """Descriptor and size of a plain file."""
    descriptor = os.open(name, flags | _FILE, dir_fd=parent)
    status = os.fstat(descriptor)
    if not stat.S_ISREG(status.st_mode):
        os.close(descriptor)
        raise Refusal(Code.FILE_NOT_FOUND)
    return descriptor, status.st_size


def _entry(found: "os.DirEntry[str]") -> DirectoryEntry:
    if found.is_dir(follow_symlinks=False):
        return DirectoryEntry(found.name, None)
    try:
        is_file = found.is_file(follow_symlinks=False)
        return DirectoryEntry(found.name, found.stat(follow_symlinks=False).st_size if is_file else -1)
    except FileNotFoundError:  # gone while we looked
        return DirectoryEntry(found.name, -1)
