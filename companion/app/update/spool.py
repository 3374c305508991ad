"""The folder in which the page leaves a wheel: `new/NAME.whl`, complete as soon as `start` exists.

It belongs to the boat's user. Root opens it without following a link, by its number from then on.
"""

import contextlib
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from companion.app.update.journal import Result
from companion.app.update.system import copy_wheel
from companion.app.update.updater import Updater
from companion.core.errors import ConfigError
from companion.core.wheel_file import MOST_PACKED_BYTES

_FOLDER = os.O_RDONLY | os.O_NOFOLLOW | os.O_DIRECTORY


def update_from_spool(updater: Updater, spool: Path) -> Result | None:
    """The result; None if nothing lies there. The spool is empty afterwards, so that nothing starts again."""
    with _open(spool) as folder:
        if "start" not in os.listdir(folder):
            return None
        try:
            return _update(updater, folder)
        finally:
            for name in ("new", "start"):
                _remove(name, folder)


def _update(updater: Updater, folder: int) -> Result:
    def fail(text: str, _: Path) -> None:
        raise ConfigError(text)

    try:
        with _open("new", folder) as new:
            names = os.listdir(new)
            if len(names) != 1:
                return updater.update("none", partial(fail, "new: expected one wheel"))
            name = names[0]
            return updater.update(name, lambda goal: copy_wheel(name, goal, MOST_PACKED_BYTES, new))
    except ConfigError as error:
        return updater.update("none", partial(fail, str(error)))


@contextmanager
def _open(path: str | Path, folder: int | None = None) -> Iterator[int]:
    try:
        number = os.open(path, _FOLDER, dir_fd=folder)
    except OSError as error:
        raise ConfigError(f"{path}: not a folder of its own: {error.strerror}") from None
    try:
        yield number
    finally:
        os.close(number)


def _remove(name: str, folder: int) -> None:
    with contextlib.suppress(FileNotFoundError):
        try:
            os.unlink(name, dir_fd=folder)
        except (IsADirectoryError, PermissionError):
            shutil.rmtree(name, dir_fd=folder)
