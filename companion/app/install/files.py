"""Steps that make or remove files and folders."""

import contextlib
import os
import shutil
from pathlib import Path

from companion.app.install.target import InstallError, Target


class FileText:
    """A file with this text; None: no such file. keeps: a file that exists stays as it is."""

    def __init__(
        self,
        target: Target,
        path: Path,
        text: str | None,
        what: str,
        *,
        mode: int = 0o644,
        keeps: bool = False,
    ) -> None:
        self._target = target
        self._path = path
        self._text = text
        self._what = what
        self._mode = mode
        self._keeps = keeps
        self._before: tuple[bytes, int] | None = None

    def describe(self) -> str:
        """What it does."""
        verb = "remove" if self._text is None else "write"
        kept = ", unless there is one" if self._keeps else ""
        return f"{verb} {self._path}: {self._what}{kept}"

    def is_done(self) -> bool:
        """Whether the file is as wanted."""
        now = self._now()
        if self._text is None or now is None or self._keeps:
            return (now is None) == (self._text is None)
        return now == (self._text.encode(), self._mode)

    def apply(self) -> None:
        """Write or remove it."""
        self._before = self._now()
        self._write(None if self._text is None else (self._text.encode(), self._mode))

    def undo(self) -> None:
        """The file as it was, or none."""
        self._write(self._before)

    def _now(self) -> tuple[bytes, int] | None:
        path = self._target.path(self._path)
        with contextlib.suppress(FileNotFoundError):
            return path.read_bytes(), path.stat().st_mode & 0o777
        return None

    def _write(self, wanted: tuple[bytes, int] | None) -> None:
        path = self._target.path(self._path)
        if wanted is None:
            path.unlink(missing_ok=True)
            return
        aside = path.with_name(f".{path.name}.new")
        try:
            aside.write_bytes(wanted[0])
            aside.chmod(wanted[1])
            aside.replace(path)
        except OSError:
            aside.unlink(missing_ok=True)
            raise


class Folder:
    """A folder of a user's, with its parents, which are root's. mode None: one that exists stays as it is."""

    def __init__(self, target: Target, path: Path, user: str = "root", mode: int | None = 0o755) -> None:
        self._target = target
        self._path = path
        self._user = user
        self._mode = mode
        self._made: list[Path] = []  # innermost last
        self._before: os.stat_result | None = None

    def describe(self) -> str:
        """What it does."""
        return f"make the folder {self._path} of {self._user}"

    def is_done(self) -> bool:
        """Whether it is there, with owner and mode."""
        path = self._target.path(self._path)
        if not path.is_dir() or self._mode is None:
            return path.is_dir()
        now = path.stat()
        is_owned = not self._may_chown or (now.st_uid, now.st_gid) == self._target.ids(self._user)
        return is_owned and now.st_mode & 0o777 == self._mode

    @property
    def _may_chown(self) -> bool:
        return os.geteuid() == 0  # a test tree belongs to whoever makes it

    def apply(self) -> None:
        """Make it, or correct owner and mode."""
        path = self._target.path(self._path)
        missing = [one for one in (path, *path.parents) if not one.exists()]
        self._before = None if missing else path.stat()
        try:
            for one in reversed(missing):
                one.mkdir(mode=0o755)
                self._made.append(one)
            path.chmod(self._mode or 0o755)
            if self._may_chown:
                os.chown(path, *self._target.ids(self._user))
        except OSError:
            self.undo()
            raise

    def undo(self) -> None:
        """Remove what was made; restore owner and mode of what was there."""
        path = self._target.path(self._path)
        if self._before is not None:
            path.chmod(self._before.st_mode & 0o777)
            if self._may_chown:
                os.chown(path, self._before.st_uid, self._before.st_gid)
        while self._made:
            with contextlib.suppress(OSError):  # somebody has put something there
                self._made[-1].rmdir()
            self._made.pop()


class NoFolder:
    """A folder is removed with all that it holds. This cannot be undone: it is a last step."""

    def __init__(self, target: Target, path: Path) -> None:
        self._target = target
        self._path = path

    def describe(self) -> str:
        """What it does."""
        return f"remove the folder {self._path} with all its files"

    def is_done(self) -> bool:
        """Whether it is gone."""
        return not self._target.path(self._path).exists()

    def apply(self) -> None:
        """Remove it."""
        shutil.rmtree(self._target.path(self._path))

    def undo(self) -> None:
        """Its files are gone.

        Raises:
            InstallError: always.
        """
        raise InstallError("its files are deleted")
