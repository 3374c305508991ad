"""An installation as a list of steps. A step that fails has the steps before it undone, in reverse order."""

import contextlib
import os
import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from companion.app.install.target import InstallError, Target

USER = "mavboat"
_NO_LOGIN = "/usr/sbin/nologin"
UNIT = "mavboat.service"
_UDEV = Path("/run/udev/control")
_COMPILE = """
import compileall, importlib.util, pathlib, companion.app.cli
for name in ("gpiozero", "lgpio", "smbus2", "colorzero"):
    if spec := importlib.util.find_spec(name):
        origin = pathlib.Path(spec.origin)
        if origin.name == "__init__.py":
            compileall.compile_dir(origin.parent, quiet=2)
        else:
            compileall.compile_file(origin, quiet=2)
"""
_WANTS = Path("/etc/systemd/system/multi-user.target.wants")

Say = Callable[[str], None]


@dataclass(slots=True)
class InstallStep:
    """One change of the system to a wanted state, or none where the system has it already.

    text: what it does, as a sentence without a full stop. apply: leaves nothing half done if it raises
    OSError. undo: restores what was there before `apply`.
    """

    text: str
    is_done: Callable[[], bool]
    apply: Callable[[], object]
    undo: Callable[[], object]


def apply_steps(steps: Sequence[InstallStep], say: Say) -> None:
    """Apply all steps, or none: a step's OSError comes out after the steps before it have been undone."""
    applied: list[InstallStep] = []
    try:
        for step in steps:
            if step.is_done():
                say(f"  already  {step.text}")
                continue
            step.apply()
            applied.append(step)
            say(f"  done     {step.text}")
    except BaseException:
        for step in reversed(applied):
            try:
                step.undo()
                say(f"  undone   {step.text}")
            except OSError as error:
                say(f"  NOT undone  {step.text}: {error}")
        raise


def describe_steps(steps: Sequence[InstallStep], say: Say) -> None:
    """Say what `apply_steps` would do."""
    for step in steps:
        say(f"  {'already ' if step.is_done() else 'to do   '} {step.text}")


def file_step(target: Target, path: Path, text: str | None, what: str, *, keeps: bool = False) -> InstallStep:
    """Write a file with this text, in folders of root's; None: remove it. keeps: a file that exists stays."""
    here = target.path(path)
    wanted = None if text is None else (text.encode(), 0o644)
    before: tuple[bytes, int] | None = None
    made: list[Path] = []

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
        if wanted is not None:
            _make_folders(here.parent, made)
        _write(here, wanted)

    def undo() -> None:
        _write(here, before)
        _remove_folders(made)

    verb, kept = "remove" if text is None else "write", ", unless there is one" if keeps else ""
    return InstallStep(f"{verb} {path}: {what}{kept}", is_done, apply, undo)


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


def _make_folders(path: Path, made: list[Path]) -> None:
    """A folder with its parents. made: those that were missing are added, innermost last."""
    for one in reversed([one for one in (path, *path.parents) if not one.exists()]):
        one.mkdir(mode=0o755)
        made.append(one)


def _remove_folders(made: list[Path]) -> None:
    while made:
        with contextlib.suppress(OSError):  # somebody has put something there
            made.pop().rmdir()


def folder_step(target: Target, path: Path, user: str = "root") -> InstallStep:
    """Make a folder of a user's, with its parents, which are root's."""
    here = target.path(path)
    may_chown = os.geteuid() == 0  # a test tree belongs to whoever makes it
    made: list[Path] = []
    before: os.stat_result | None = None

    def is_done() -> bool:
        if not here.is_dir():
            return False
        now = here.stat()
        is_owned = not may_chown or (now.st_uid, now.st_gid) == target.ids(user)
        return is_owned and now.st_mode & 0o777 == 0o755

    def apply() -> None:
        nonlocal before
        before = here.stat() if here.exists() else None
        try:
            _make_folders(here, made)
            change(0o755, target.ids(user))
        except OSError:
            undo()
            raise

    def change(mode: int, ids: tuple[int, int]) -> None:
        here.chmod(mode)
        if may_chown:
            os.chown(here, *ids)

    def undo() -> None:
        if before is not None:
            change(before.st_mode & 0o777, (before.st_uid, before.st_gid))
        _remove_folders(made)

    return InstallStep(f"make the folder {path} of {user}", is_done, apply, undo)


def no_folder_step(target: Target, path: Path) -> InstallStep:
    """Remove a folder with all that it holds. This cannot be undone: it is a last step."""
    here = target.path(path)

    def undo() -> None:
        raise InstallError("its files are deleted")

    text = f"remove the folder {path} with all its files"
    return InstallStep(text, lambda: not here.exists(), lambda: shutil.rmtree(here), undo)


def group_step(target: Target, name: str) -> InstallStep:
    option = target.accounts_option()
    return InstallStep(
        f"make the group {name}",
        lambda: name in target.groups(),
        lambda: target.run("groupadd", "--system", *option, name),
        lambda: target.run("groupdel", *option, name),
    )


def user_step(target: Target, name: str, groups: Sequence[str], home: Path) -> InstallStep:
    """Make a system user that cannot log in, with a group of its own, as a member of other groups."""
    option = target.accounts_option()
    options = ["--system", "--user-group", "--groups", ",".join(groups), "--no-create-home"]
    options += ["--home-dir", str(home), "--shell", _NO_LOGIN, "--comment", "mavboat companion"]

    def undo() -> None:
        target.run("userdel", *option, name)
        if name in target.groups():  # userdel removes it where login.defs says so
            target.run("groupdel", *option, name)

    return InstallStep(
        f"make the user {name}",
        lambda: name in target.users(),
        lambda: target.run("useradd", *option, *options, name),
        undo,
    )


def no_user_step(target: Target, name: str, user: InstallStep) -> InstallStep:
    """Remove the user that a step makes."""
    text = f"remove the user {name} and its group"
    return InstallStep(text, lambda: name not in target.users(), user.undo, user.apply)


def member_step(target: Target, user: str, groups: Sequence[str]) -> InstallStep:
    """Add a user to the groups that it lacks."""
    option = target.accounts_option()
    added: list[str] = []

    def lacks() -> list[str]:
        members = target.groups()
        return [group for group in groups if user not in members.get(group, ())]

    def apply() -> None:
        added[:] = lacks()
        target.run("usermod", *option, "--append", "--groups", ",".join(added), user)

    def undo() -> None:
        target.run("usermod", *option, "--remove", "--groups", ",".join(added), user)

    return InstallStep(f"add {user} to the groups {', '.join(groups)}", lambda: not lacks(), apply, undo)


def enabled_step(target: Target, unit: str = UNIT, *, is_wanted: bool = True) -> InstallStep:
    """Let a unit start with the machine, or not."""
    root = [] if target.is_this_machine else ["--root", str(target.root)]

    def switch(is_on: bool) -> None:
        now = ["--now"] if target.is_this_machine and not is_on else []
        target.run("systemctl", *root, "enable" if is_on else "disable", *now, unit)

    return InstallStep(
        f"start {unit} with the machine" if is_wanted else f"stop {unit}, and start it no more",
        lambda: target.path(_WANTS / unit).is_symlink() == is_wanted,
        lambda: switch(is_wanted),
        lambda: switch(not is_wanted),
    )


def compiled_step(target: Target, programs: Path) -> InstallStep:
    """Compile what the boat imports, as root: its user may not write beside the sources, and would compile
    them again at every start. Drivers' libraries, which are imported late, are named. It is always repeated,
    which takes no time if nothing is new; a read-only environment stays as it is.
    """
    return InstallStep(
        "compile what the boat imports",
        lambda: False,
        lambda: target.run(str(programs / "python"), "-I", "-c", _COMPILE),
        lambda: None,  # Python ignores compiled files without their sources
    )


def reloaded_step(target: Target) -> InstallStep:
    """Have the running systemd, journal and udev read what was written. It is always repeated."""

    def reload() -> None:
        target.run("systemctl", "daemon-reload")
        target.run("systemctl", "try-restart", "systemd-journald.service")
        if not _UDEV.exists():
            return  # a container
        target.run("udevadm", "control", "--reload")
        for subsystem in ("tty", "pwm", "gpio", "i2c-dev"):
            target.run("udevadm", "trigger", "--subsystem-match", subsystem)

    text = "let systemd, the journal and udev read the new files"
    return InstallStep(text, lambda: False, reload, lambda: None)  # the files are restored, and read later
