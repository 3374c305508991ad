"""Files that a program writes for its user: whole under their name, or not there."""

import contextlib
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from companion.core.errors import OutputError


@contextmanager
def output_file(path: Path) -> Iterator[Path]:
    """Where to write what a file is to hold: a name beside it, of the same suffix, that becomes the file's
    once the block has ended well. Folders on the way are made. Devices and pipes are written to as they are.

    Raises:
        OutputError: the file cannot be written; it is as it was before.
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
    """Write a file of text.

    Raises:
        OutputError: as `output_file`.
    """
    with output_file(path) as aside:
        aside.write_text(text, encoding="utf-8")


def output_folder(path: Path) -> Path:
    """Make a folder for files, if need be.

    Raises:
        OutputError: it cannot be made.
    """
    with _named(path):
        path.mkdir(parents=True, exist_ok=True)
    return path


@contextmanager
def _named(path: Path) -> Iterator[None]:
    """Name the file in whatever the system says."""
    try:
        yield
    except OutputError:
        raise
    except OSError as error:
        raise OutputError.of(path, error) from None
