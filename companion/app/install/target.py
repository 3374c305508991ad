"""The system that is installed to: this machine, or the root folder of another one."""

import grp
import os
import pwd
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

from companion.core.errors import BoatError

_LONGEST_S = 60.0  # for one of the system's own programs


class InstallError(BoatError, OSError):
    """A step of an installation failed."""


class UnmetError(InstallError):
    """Something that has to be there before an installation."""

    exit_code = 2


@dataclass(frozen=True, slots=True)
class Target:
    """Paths are absolute on the target. What needs its systemd to run is done on this machine only."""

    root: Path = Path("/")

    @property
    def is_this_machine(self) -> bool:
        """Whether the target is the running system."""
        return self.root == Path("/")

    def path(self, path: Path) -> Path:
        """Where the target's path lies here."""
        return self.root / path.relative_to("/")

    def run(self, *command: str) -> str:
        """Run one of the system's programs, such as useradd; its output. InstallError: with what it said."""
        try:
            done = subprocess.run(  # noqa: S603
                command, check=True, capture_output=True, text=True, timeout=_LONGEST_S
            )
        except FileNotFoundError:
            raise InstallError(f"{command[0]}: not installed") from None
        except subprocess.SubprocessError as error:
            said = str(getattr(error, "stderr", "") or error)
            raise InstallError(f"{' '.join(command)}: {' '.join(said.split())}") from None
        return done.stdout

    def accounts_option(self) -> list[str]:
        """For useradd and its kin: whose accounts to change."""
        return [] if self.is_this_machine else ["--prefix", str(self.root)]

    def groups(self) -> dict[str, set[str]]:
        """The members of each group of the target."""
        return {fields[0]: set(filter(None, fields[3].split(","))) for fields in self._accounts("group", 4)}

    def users(self) -> set[str]:
        return {fields[0] for fields in self._accounts("passwd", 7)}

    def ids(self, user: str) -> tuple[int, int]:
        """A user's number and that of its group; root's if there is no such user."""
        for fields in self._accounts("passwd", 7):
            if fields[0] == user:
                return int(fields[2]), int(fields[3])
        return 0, 0

    def _accounts(self, name: str, length: int) -> list[list[str]]:
        if self.is_this_machine:  # accounts may come from elsewhere than its files
            if name == "group":
                return [[one.gr_name, "", str(one.gr_gid), ",".join(one.gr_mem)] for one in grp.getgrall()]
            return [[one.pw_name, "", str(one.pw_uid), str(one.pw_gid), "", "", ""] for one in pwd.getpwall()]
        try:
            lines = (self.root / "etc" / name).read_text(encoding="utf-8").splitlines()
        except FileNotFoundError:
            raise InstallError(
                f"{self.root}: no etc/{name}; expected the root folder of a Linux system"
            ) from None
        return [fields for fields in (line.split(":") for line in lines) if len(fields) == length]


def need_programs(*names: str) -> None:
    """The system's own programs that the steps will run. An UnmetError names the first that is missing."""
    for name in names:
        if shutil.which(name) is None:
            raise UnmetError(f"{name}: not installed; expected a Linux system with systemd and passwd")


def is_readable_by_others(path: Path) -> bool:
    """Whether any user can read a file: its folders let everybody through."""
    folders = [parent.stat().st_mode & 0o001 for parent in path.parents]
    return all(folders) and os.access(path, os.R_OK)
