"""Steps that make or remove files and folders."""

import contextlib
import os
import shutil
from pathlib import Path

from companion.app.install.steps import InstallStep
from companion.app.install.target import InstallError, Target


def file_step(
    target: Target, path: Path, text: str | None, what: str, *, mode: int = 0o644, keeps: bool = False
) -> InstallStep:
    """Write a file with this text; None: remove it. keeps: a file that exists stays as it is."""
    here = target.path(path)
    wanted = None if text is None else (text.encode(), mode)
    before: tuple[bytes, int] | None = None

    def now() -> tuple[bytes, int] | None:
        with contextlib.suppress(FileNotFoundError):
            return here.read_bytes(), here.stat().st_mode & 0o777
        return None

    def is_done() -> bool:
        found = now()
        if wanted is None or found is None or keeps:
            return (found is None) == (wanted is None)
        return found == wanted

    def apply() -> None:
        nonlocal before
        before = now()
        _write(here, wanted)

    verb, kept = "remove" if text is None else "write", ", unless there is one" if keeps else ""
    return InstallStep(f"{verb} {path}: {what}{kept}", is_done, apply, lambda: _write(here, before))


def _write(path: Path, wanted: tuple[bytes, int] | None) -> None:
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


def folder_step(target: Target, path: Path, user: str = "root", mode: int | None = 0o755) -> InstallStep:
    """Make a folder of a user's, with its parents, which are root's.

    mode None: a folder that exists stays as it is.
    """
    here = target.path(path)
    may_chown = os.geteuid() == 0  # a test tree belongs to whoever makes it
    made: list[Path] = []  # innermost last
    before: os.stat_result | None = None

    def is_done() -> bool:
        if not here.is_dir() or mode is None:
            return here.is_dir()
        now = here.stat()
        is_owned = not may_chown or (now.st_uid, now.st_gid) == target.ids(user)
        return is_owned and now.st_mode & 0o777 == mode

    def apply() -> None:
        nonlocal before
        missing = [one for one in (here, *here.parents) if not one.exists()]
        before = None if missing else here.stat()
        try:
            for one in reversed(missing):
                one.mkdir(mode=0o755)
                made.append(one)
            here.chmod(mode or 0o755)
            if may_chown:
                os.chown(here, *target.ids(user))
        except OSError:
            undo()
            raise

    def undo() -> None:
        if before is not None:
            here.chmod(before.st_mode & 0o777)
            if may_chown:
                os.chown(here, before.st_uid, before.st_gid)
        while made:
            with contextlib.suppress(OSError):  # somebody has put something there
                made[-1].rmdir()
            made.pop()

    return InstallStep(f"make the folder {path} of {user}", is_done, apply, undo)


def no_folder_step(target: Target, path: Path) -> InstallStep:
    """Remove a folder with all that it holds. This cannot be undone: it is a last step."""
    here = target.path(path)

    def undo() -> None:
        raise InstallError("its files are deleted")

    text = f"remove the folder {path} with all its files"
    return InstallStep(text, lambda: not here.exists(), lambda: shutil.rmtree(here), undo)
