"""The installed files of mavboat: kept before an update, and put back after one that failed.

Whole packages are kept and put back, not single files: pip, interrupted, leaves any mixture. The kept folder
`site` can be imported from, so that a boat whose installation is half written can still go back.
"""

import csv
import os
import re
import shutil
from pathlib import Path

from companion.core.errors import BoatError
from companion.core.wheel_file import DISTRIBUTION, PACKAGES

_PROGRAM = re.compile(r"(?:boat|mission)-[a-z]+")
_NO_CACHES = shutil.ignore_patterns("__pycache__")


class UpdateError(BoatError, OSError):
    """A step of an update failed."""


class Installation:
    """mavboat in an environment. site: its site-packages; programs: its programs; kept: the copy's folder."""

    def __init__(self, site: Path, programs: Path, kept: Path) -> None:
        self.site = site
        self.programs = programs
        self._kept = kept

    def version(self) -> str:
        """The installed version.

        Raises:
            UpdateError: none is installed here from a wheel, or two are.
        """
        found = self._infos(self.site)
        if len(found) != 1 or not (self.site / PACKAGES[0]).is_dir():
            raise UpdateError(f"{self.site}: expected one installation of {DISTRIBUTION} from a wheel")
        return found[0].name.removeprefix(f"{DISTRIBUTION}-").removesuffix(".dist-info")

    def keep(self) -> None:
        """Copy everything aside. The copy is complete under its name, or absent."""
        self.version()
        aside = self._kept.with_name(f"{self._kept.name}.new")
        for one in (aside, self._kept):
            shutil.rmtree(one, ignore_errors=True)
        (aside / "site").mkdir(parents=True)
        (aside / "programs").mkdir()
        aside.chmod(0o700)
        for source in self._ours():
            shutil.copytree(source, aside / "site" / source.name, symlinks=True, ignore=_NO_CACHES)
        for source in self._programs():
            shutil.copy2(source, aside / "programs")
        os.sync()
        aside.rename(self._kept)
        os.sync()

    def restore(self) -> None:
        """The kept files in the place of whatever is there. Can be repeated after an interruption.

        Raises:
            UpdateError: nothing was kept.
        """
        if not (self._kept / "site" / PACKAGES[0]).is_dir():
            raise UpdateError(f"{self._kept}: nothing was kept to go back to")
        for one in (*self._ours(), *self._leftovers()):
            shutil.rmtree(one)
        for source in (self._kept / "site").iterdir():
            shutil.copytree(source, self.site / source.name, symlinks=True, ignore=_NO_CACHES)
        for program in self._programs():
            program.unlink()
        for source in (self._kept / "programs").iterdir():
            shutil.copy2(source, self.programs)
        os.sync()

    def sweep(self) -> list[str]:
        """Remove files in mavboat's packages that the installed wheel does not list, and name them.

        A kernel compiled from older sources, which no RECORD lists, would be imported in place of the new.
        """
        (info,) = self._infos(self.site)
        with (info / "RECORD").open(encoding="utf-8", newline="") as file:
            listed = {row[0] for row in csv.reader(file) if row}
        swept = []
        for package in PACKAGES:
            for path in (self.site / package).rglob("*"):
                name = str(path.relative_to(self.site))
                if "__pycache__" not in path.parts and not path.is_dir() and name not in listed:
                    path.unlink()
                    swept.append(name)
        return swept

    def forget(self) -> None:
        """Remove the copy."""
        shutil.rmtree(self._kept, ignore_errors=True)

    def _infos(self, folder: Path) -> list[Path]:
        return sorted(folder.glob(f"{DISTRIBUTION}-*.dist-info"))

    def _ours(self) -> list[Path]:
        packages = [path for name in PACKAGES if (path := self.site / name).is_dir()]
        return [*packages, *self._infos(self.site)]

    def _leftovers(self) -> list[Path]:
        """Folders that pip renamed in order to remove them: the first letters are another, the first is ~."""
        ends = tuple(f"~{name[1:]}" for name in PACKAGES)
        return [
            path for path in self.site.glob("~*") if path.name in ends or path.name.startswith("~avboat-")
        ]

    def _programs(self) -> list[Path]:
        """The programs that were made for an entry point of ours."""
        if not self.programs.is_dir():
            return []
        found = [path for path in self.programs.iterdir() if _PROGRAM.fullmatch(path.name)]
        packages = "|".join(PACKAGES)
        imports = re.compile(rf"^from (?:{packages})[. ]".encode(), re.MULTILINE)
        return [path for path in found if path.is_file() and imports.search(path.read_bytes())]
