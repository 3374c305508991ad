"""What survives a power cut: which step an update has reached, and how the latest one ended."""

import os
from pathlib import Path
from typing import Literal

import msgspec

State = Literal["running", "done", "went back", "refused"]


class Journal(msgspec.Struct, frozen=True):
    """An update under way. installing: files may be half written. installed: they are new, and checked."""

    step: Literal["installing", "installed"]
    version: str
    before: str


class Result(msgspec.Struct, frozen=True):
    """For the page. before: the version that was installed; at_s: Unix time."""

    state: State
    version: str
    before: str
    text: str
    at_s: float


def read_journal(path: Path) -> Journal | None:
    """None: no update is under way. One that cannot be read counts as half written."""
    try:
        return msgspec.json.decode(path.read_bytes(), type=Journal)
    except FileNotFoundError:
        return None
    except msgspec.MsgspecError:
        return Journal("installing", "", "")


def write_durably(path: Path, content: msgspec.Struct, mode: int = 0o644) -> None:
    """The old file or the new one after a power cut."""
    aside = path.with_name(f".{path.name}.new")
    aside.unlink(missing_ok=True)
    with aside.open("wb") as file:
        os.fchmod(file.fileno(), mode)
        file.write(msgspec.json.encode(content))
        file.flush()
        os.fsync(file.fileno())
    aside.replace(path)
    _sync_folder(path.parent)


def remove_durably(path: Path) -> None:
    """Gone after a power cut, too."""
    path.unlink(missing_ok=True)
    _sync_folder(path.parent)


def _sync_folder(path: Path) -> None:
    number = os.open(path, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(number)
    finally:
        os.close(number)
