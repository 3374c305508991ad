"""Output files: complete under their name, or absent."""

import contextlib
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from companion.core.errors import OutputError


def state_home() -> Path:
    """The folder for what the user's programs keep between starts (XDG Base Directory Specification)."""
    return Path(os.environ.get("XDG_STATE_HOME") or Path("~/.local/state").expanduser()) / "mavboat"


@contextmanager
def output_file(path: Path) -> Iterator[Path]:
    """Yield a temporary path that becomes the file when the block succeeds. Missing folders are created.
    Devices and pipes are written directly. After an OutputError an existing file is unchanged.
    """
    if path.exists() and not path.is_file():
        with _named(path):
            yield path
        return
    goal = Path(os.path.realpath(path))  # a link stays one
    aside = goal.with_name(f".{goal.name}.new{goal.suffix}")
    with _named(path):
        goal.parent.mkdir(parents=True, exist_ok=True)
        try:
            yield aside
            aside.replace(goal)
        except BaseException:
            with contextlib.suppress(OSError):
                aside.unlink(missing_ok=True)
            raise


def write_text(path: Path, text: str) -> None:
    """Write a text file. Raises OutputError: as `output_file`."""
    with output_file(path) as aside:
        aside.write_text(text, encoding="utf-8")


def output_folder(path: Path) -> Path:
    """Create a folder if necessary. Raises OutputError: it cannot be created."""
    with _named(path):
        path.mkdir(parents=True, exist_ok=True)
    return path


@contextmanager
def _named(path: Path) -> Iterator[None]:
    """Add the path to system errors."""
    try:
        yield
    except OutputError:
        raise
    except OSError as error:
        raise OutputError.of(path, error) from None
