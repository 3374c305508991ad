"""Open sessions in a file, so that they outlast the program. It holds hashes, no token."""

import contextlib
import os
from pathlib import Path

import msgspec


class StoredSession(msgspec.Struct, frozen=True):
    """key: hash of the token. pin: hash of the PIN file's line. address: its owner's."""

    key: str
    pin: str
    until_unix_s: float
    address: str


class SessionFile:
    """A file that only its owner reads. One that is missing, damaged or open to others holds no sessions."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def read(self) -> list[StoredSession]:
        """The sessions, oldest first."""
        try:
            with self._path.open("rb") as file:
                if os.fstat(file.fileno()).st_mode & 0o077:
                    return []
                return msgspec.json.decode(file.read(), type=list[StoredSession])
        except (OSError, msgspec.MsgspecError, UnicodeError):
            return []

    def write(self, sessions: list[StoredSession]) -> None:
        """Replace them. A medium that cannot be written to is left alone: the PIN opens a session again."""
        aside = self._path.with_name(f".{self._path.name}.new")
        with contextlib.suppress(OSError):
            aside.unlink(missing_ok=True)
            with os.fdopen(os.open(aside, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as file:
                file.write(msgspec.json.encode(sessions))
            aside.replace(self._path)
