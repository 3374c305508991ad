"""Virtual files: generated when opened, optionally processed when written."""

import errno
from collections.abc import Callable, Mapping
from typing import NamedTuple

from companion.mavlink.ftp_frames import Code, Refusal
from companion.services.ftp.tree import DirectoryEntry, Names

_MAX_UPLOAD_BYTES = 64 * 1024


class Options(NamedTuple):
    """Options after a `?` in a file name, such as `start=10&count=5`."""

    values: Mapping[str, str]

    def whole(self, key: str) -> int:
        """An option as a number; 0 if missing. Raises OSError: not a number."""
        text = self.values.get(key, "0")
        if not (text.isascii() and text.isdigit() and len(text) <= 9):
            raise self.wrong(key)
        return int(text)

    def wrong(self, key: str) -> OSError:
        return OSError(errno.EINVAL, f"{key}={self.values.get(key)}")


class VirtualFile(NamedTuple):
    """make: returns the content for the options. take: processes an upload; None: read only."""

    make: Callable[[Options], bytes]
    take: Callable[[bytes], None] | None = None


class Content:
    """Satisfies `Reading` with constant content in memory."""

    def __init__(self, content: bytes) -> None:
        self.size = len(content)
        self._content = content

    def has(self, offset: int, count: int) -> bool:  # noqa: ARG002
        return True

    def read(self, offset: int, count: int) -> bytes:
        return self._content[offset : offset + count]

    fetch = read

    def load(self, offset: int) -> None:
        """No effect."""

    def close(self) -> None:
        """No effect."""


class VirtualMount:
    """Satisfies `Mount`: a folder of virtual files."""

    is_disk = False

    def __init__(self, files: Mapping[str, VirtualFile]) -> None:
        self._files = dict(files)

    def open(self, names: Names) -> Content:
        name, _, query = _single(names).partition("?")
        pairs = (pair.partition("=") for pair in query.split("&"))
        options = Options({key: value for key, _, value in pairs})
        return Content(self._file(name).make(options))

    def entries(self, names: Names) -> list[DirectoryEntry]:
        """The files with their present sizes."""
        if names:
            raise Refusal(Code.FILE_NOT_FOUND)
        nothing = Options({})
        return [DirectoryEntry(name, len(file.make(nothing))) for name, file in sorted(self._files.items())]

    def begin(self, names: Names, keep: bool) -> bytes:  # noqa: ARG002
        """Only for writable files; an upload always starts empty."""
        if self._file(_single(names)).take is None:
            raise Refusal(Code.FILE_PROTECTED)
        return b""

    def save(self, names: Names, content: bytes) -> None:
        take = self._file(_single(names)).take
        if take is None:
            raise Refusal(Code.FILE_PROTECTED)
        if len(content) > _MAX_UPLOAD_BYTES:
            raise OSError(errno.EFBIG, "too long")
        take(content)

    def truncate(self, names: Names, to: object = None) -> None:  # noqa: ARG002
        """Never: the files of a virtual folder are fixed."""
        raise Refusal(Code.FILE_PROTECTED)

    remove = make_folder = remove_folder = rename = truncate

    def _file(self, name: str) -> VirtualFile:
        file = self._files.get(name)
        if file is None:
            raise Refusal(Code.FILE_NOT_FOUND)
        return file


def _single(names: Names) -> str:
    if len(names) != 1:
        raise Refusal(Code.FILE_NOT_FOUND)
    return names[0]
