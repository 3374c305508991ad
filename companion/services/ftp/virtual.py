"""Files that are on no disk: made when they are opened, and perhaps taken in when they are written."""

import errno
from collections.abc import Callable, Mapping
from typing import NamedTuple

from companion.services.ftp.frames import Code, Refusal
from companion.services.ftp.tree import DirectoryEntry, Names

_MAX_UPLOAD_BYTES = 64 * 1024


class Options(NamedTuple):
    """What stands behind a `?` in a file's name, such as `start=10&count=5`."""

    values: Mapping[str, str]

    def whole(self, key: str) -> int:
        """An option as a number; 0 when it is not there.

        Raises:
            OSError: it is no such number.
        """
        text = self.values.get(key, "0")
        if not (text.isascii() and text.isdigit() and len(text) <= 9):
            raise self.wrong(key)
        return int(text)

    def wrong(self, key: str) -> OSError:
        """What to raise of an option that cannot be met."""
        return OSError(errno.EINVAL, f"{key}={self.values.get(key)}")


class VirtualFile(NamedTuple):
    """make: the content, given the options. take: what is done with an uploaded one; None: read only."""

    make: Callable[[Options], bytes]
    take: Callable[[bytes], None] | None = None


class Content:
    """Satisfies `Reading`: all of it is at hand, and stays as it was when it was opened."""

    def __init__(self, content: bytes) -> None:
        self.size = len(content)
        self._content = content

    def has(self, offset: int, count: int) -> bool:  # noqa: ARG002
        """Always."""
        return True

    def read(self, offset: int, count: int) -> bytes:
        """Up to count bytes."""
        return self._content[offset : offset + count]

    def load(self, offset: int) -> None:
        """Nothing to wait for."""

    def fetch(self, offset: int, count: int) -> bytes:
        """The same as `read`."""
        return self.read(offset, count)

    def close(self) -> None:
        """Nothing to let go."""


class VirtualMount:
    """Satisfies `Mount`: one folder of virtual files."""

    is_disk = False

    def __init__(self, files: Mapping[str, VirtualFile]) -> None:
        self._files = dict(files)

    def open(self, names: Names) -> Content:
        """Make the content now; it does not change while it is read."""
        name, _, query = _single(names).partition("?")
        pairs = (pair.partition("=") for pair in query.split("&"))
        options = Options({key: value for key, _, value in pairs})
        return Content(self._file(name).make(options))

    def entries(self, names: Names) -> list[DirectoryEntry]:
        """The files with the sizes that they would have now."""
        if names:
            raise Refusal(Code.FILE_NOT_FOUND)
        nothing = Options({})
        return [DirectoryEntry(name, len(file.make(nothing))) for name, file in sorted(self._files.items())]

    def begin(self, names: Names, keep: bool) -> bytes:  # noqa: ARG002
        """Only what is taken in; an upload always begins with nothing."""
        if self._file(_single(names)).take is None:
            raise Refusal(Code.FILE_PROTECTED)
        return b""

    def save(self, names: Names, content: bytes) -> None:
        """Take the content in."""
        take = self._file(_single(names)).take
        if take is None:
            raise Refusal(Code.FILE_PROTECTED)
        if len(content) > _MAX_UPLOAD_BYTES:
            raise OSError(errno.EFBIG, "too long")
        take(content)

    def truncate(self, names: Names, size: int) -> None:  # noqa: ARG002
        """Never."""
        raise Refusal(Code.FILE_PROTECTED)

    def remove(self, names: Names) -> None:  # noqa: ARG002
        """Never."""
        raise Refusal(Code.FILE_PROTECTED)

    def make_folder(self, names: Names) -> None:  # noqa: ARG002
        """Never."""
        raise Refusal(Code.FILE_PROTECTED)

    def remove_folder(self, names: Names) -> None:  # noqa: ARG002
        """Never."""
        raise Refusal(Code.FILE_PROTECTED)

    def rename(self, names: Names, to: Names) -> None:  # noqa: ARG002
        """Never."""
        raise Refusal(Code.FILE_PROTECTED)

    def _file(self, name: str) -> VirtualFile:
        file = self._files.get(name)
        if file is None:
            raise Refusal(Code.FILE_NOT_FOUND)
        return file


def _single(names: Names) -> str:
    if len(names) != 1:
        raise Refusal(Code.FILE_NOT_FOUND)
    return names[0]
