"""What an update does to the system: pip, the new program's check, and the services."""

import os
import stat
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Protocol

import msgspec

from companion.app.install.page import SHORE_UNIT
from companion.app.install.service import UNIT
from companion.app.update.installation import UpdateError
from companion.core.errors import ConfigError

STALE_S: Final = 5.0  # the boat writes its status once a second
STAYS_S: Final = (
    8.0  # WatchdogSec=2 and RestartSec=1 of the unit: a boat that hangs has been restarted by then
)
_POLL_S: Final = 0.5
_LONGEST_S: Final = 300.0  # pip on a Pi Zero
_MOST_STATUS_BYTES: Final = 1_000_000
_PATH = "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"


class System(Protocol):
    """What the update needs of the boat's computer. Every method raises UpdateError when it fails."""

    def is_armed(self) -> bool:
        """Whether the boat is armed, or may be."""

    def install(self, wheel: Path) -> None:
        """Put the wheel's files in the place of the installed ones."""

    def compile(self) -> None:
        """Compile the installed sources, without running them."""

    def check(self) -> None:
        """Have the installed program read the boat's configuration."""

    def restart(self) -> None:
        """Restart the services, and wait until they have run for a while."""


class _Armed(msgspec.Struct):
    """What is used of `BoatStatus`, which another version may have written."""

    armed: bool | None = None


def read_armed(path: Path, unix_s: float) -> bool:
    """What a running boat's status file says. One that is missing, stale or none of ours counts as armed.

    The file belongs to the boat's user, so no link is followed and no pipe waited for.
    """
    try:
        number = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
    except OSError:
        return True
    with os.fdopen(number, "rb") as file:
        status = os.fstat(number)
        if not stat.S_ISREG(status.st_mode) or abs(unix_s - status.st_mtime) > STALE_S:
            return True
        try:
            return msgspec.json.decode(file.read(_MOST_STATUS_BYTES), type=_Armed).armed is not False
        except msgspec.MsgspecError:
            return True


@dataclass(frozen=True, slots=True)
class ThisMachine:
    """The running system. programs: the environment's; site: its packages; user: ids of the boat's user."""

    programs: Path
    site: Path
    config: Path
    status: Path
    user: tuple[int, int]
    sleep: Callable[[float], None] = time.sleep

    def is_armed(self) -> bool:
        """A stopped boat is disarmed: its unit switched the motors off."""
        shown = self._show(UNIT, "ActiveState", "SubState")
        if shown.get("ActiveState") in ("inactive", "failed") or shown.get("SubState") == "auto-restart":
            return False
        return read_armed(self.status, time.time())

    def install(self, wheel: Path) -> None:
        """By pip, which runs nothing of a wheel."""
        options = [
            "--no-index",
            "--no-deps",
            "--force-reinstall",
            "--no-compile",
            "--no-cache-dir",
            "--no-input",
        ]
        options += ["--disable-pip-version-check", "--root-user-action=ignore", "--quiet"]
        self._run([*self._python("pip"), "install", *options, str(wheel)], "pip")

    def compile(self) -> None:
        """Only what the boat imports."""
        self._run([*self._python("compileall"), "-q", str(self.site / "companion")], "compiling")

    def check(self) -> None:
        """As the boat's user: it is new code."""
        uid, gid = self.user
        as_user = {"user": uid, "group": gid} if os.geteuid() == 0 else None
        command = [*self._python("companion"), "check", "--config", str(self.config)]
        self._run(command, "the new program's check", as_user)

    def restart(self) -> None:
        """First the boat, then the page, if there is one."""
        for unit in (UNIT, SHORE_UNIT):
            if self._show(unit, "UnitFileState").get("UnitFileState") in ("enabled", "enabled-runtime"):
                self._restart(unit)

    def _restart(self, unit: str) -> None:
        self._run(["systemctl", "restart", unit], f"restarting {unit}")
        names = ("ActiveState", "MainPID", "NRestarts")
        first = self._show(unit, *names)
        for _ in range(round(STAYS_S / _POLL_S)):
            now = self._show(unit, *names)
            if now.get("ActiveState") not in ("active", "reloading") or now != {**first, **_state(now)}:
                raise UpdateError(f"{unit} does not stay up")
            self.sleep(_POLL_S)

    def _show(self, unit: str, *names: str) -> dict[str, str]:
        lines = self._run(
            ["systemctl", "show", unit, f"--property={','.join(names)}"], "systemctl"
        ).splitlines()
        return dict(line.split("=", 1) for line in lines if "=" in line)

    def _python(self, module: str) -> list[str]:
        return [str(self.programs / "python"), "-I", "-m", module]

    def _run(self, command: list[str], what: str, as_user: dict[str, int] | None = None) -> str:
        ids = as_user or {}
        try:
            done = subprocess.run(  # noqa: S603
                command,
                capture_output=True,
                text=True,
                errors="replace",
                timeout=_LONGEST_S,
                check=False,
                cwd="/",
                env={"PATH": _PATH, "LC_ALL": "C.UTF-8"},
                user=ids.get("user"),
                group=ids.get("group"),
                extra_groups=[] if as_user else None,
            )
        except (OSError, subprocess.SubprocessError) as error:
            raise UpdateError(f"{what} failed: {error}") from None
        if done.returncode != 0:
            said = " ".join((done.stderr or done.stdout).split())
            raise UpdateError(f"{what} failed: {said[-300:] or f'exit code {done.returncode}'}")
        return done.stdout


def _state(shown: dict[str, str]) -> dict[str, str]:
    return {"ActiveState": shown.get("ActiveState", "")}


def copy_wheel(source: str | Path, goal: Path, most_bytes: int, folder: int | None = None) -> None:
    """Copy a plain file without following a link. folder: the open folder that holds it.

    Raises:
        ConfigError: not a plain file, or too large.
    """
    try:
        number = os.open(source, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK, dir_fd=folder)
    except OSError as error:
        raise ConfigError(f"{source}: cannot be opened: {error.strerror}") from None
    with os.fdopen(number, "rb") as file, goal.open("xb") as copy:
        if not stat.S_ISREG(os.fstat(number).st_mode):
            raise ConfigError(f"{source}: not a plain file")
        left = most_bytes
        while content := file.read(1 << 16):
            left -= len(content)
            if left < 0:
                raise ConfigError(f"{source}: more than {most_bytes} bytes")
            copy.write(content)
