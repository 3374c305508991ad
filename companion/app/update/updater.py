"""An update from a wheel, which ends with the new version whole or the old one whole.

    copied, checked -> kept -> [installing] pip, sweep, compile, check -> [installed] restart -> done
                                    \\__________ any failure _________________/ -> kept files back, restart

The steps in brackets are in the journal. After a power cut the next run goes back from *installing*, and
repeats the restart of *installed*.
"""

import logging
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from companion.app.update.installation import Installation, UpdateError
from companion.app.update.journal import (
    Journal,
    Result,
    State,
    read_journal,
    remove_durably,
    write_durably,
)
from companion.app.update.system import System
from companion.core.errors import ConfigError
from companion.core.wheel_file import inspect_wheel

STATE_FOLDER: Final = Path("/var/lib/mavboat-update")
_ARMED: Final = "The boat is armed, or may be: disarm it first"
_WAIT_S: Final = 2.0

logger = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Updater:
    """folder: journal, result, and the copy of the wheel, root's. unix_s: the time; pause: waits seconds."""

    folder: Path
    installation: Installation
    system: System
    unix_s: Callable[[], float]
    pause: Callable[[float], None]

    def update(self, name: str, copy: Callable[[Path], None]) -> Result:
        """Install the wheel of this name, which `copy` writes to a path of ours.

        Nothing is raised for a wheel that is refused or fails: the result says so.
        """
        before = self._before()
        self._say("running", "", before, "checks the file")
        place = self.folder / "wheel"
        shutil.rmtree(place, ignore_errors=True)
        try:
            place.mkdir(mode=0o700)
            wheel = place / Path(name).name
            copy(wheel)
            version = inspect_wheel(wheel).version
            if self.system.is_armed():
                return self._say("refused", version, before, _ARMED)
            self._say("running", version, before, "keeps the present version")
            self.installation.keep()
            return self._install(wheel, version, before)
        except (ConfigError, OSError) as error:
            return self._say("refused", "", before, str(error))
        finally:
            shutil.rmtree(place, ignore_errors=True)

    def recover(self) -> Result | None:
        """Finish an update that was interrupted, or go back; None: there was none."""
        journal = read_journal(self._journal)
        if journal is None:
            self.installation.forget()
            return None
        if journal.step == "installing":
            return self._go_back(journal, "it was interrupted", waits=True)
        self._wait_until_disarmed(journal)
        return self._restart(journal)

    def _install(self, wheel: Path, version: str, before: str) -> Result:
        journal = Journal("installing", version, before)
        write_durably(self._journal, journal)
        if self.system.is_armed():
            self._end()
            return self._say("refused", version, before, _ARMED)
        self._say("running", version, before, "installs")
        try:
            self.system.install(wheel)
            for swept in self.installation.sweep():
                logger.info("removed %s, which the new version does not list", swept)
            self.system.compile()
            if (found := self.installation.version()) != version:
                raise UpdateError(f"{found} is installed instead of {version}")
            self.system.check()
        except OSError as error:
            return self._go_back(journal, str(error))
        journal = Journal("installed", version, before)
        write_durably(self._journal, journal)
        if self.system.is_armed():
            return self._go_back(journal, "the boat was armed meanwhile", restarts=False)
        return self._restart(journal)

    def _restart(self, journal: Journal) -> Result:
        self._say("running", journal.version, journal.before, "restarts the boat")
        try:
            self.system.restart()
        except OSError as error:
            return self._go_back(journal, str(error))
        result = self._say("done", journal.version, journal.before, f"{journal.version} runs")
        self._end()
        return result

    def _go_back(self, journal: Journal, why: str, *, restarts: bool = True, waits: bool = False) -> Result:
        """waits: until the boat is disarmed, with the old files in their place already."""
        write_durably(self._journal, Journal("installing", journal.version, journal.before))
        self.installation.restore()
        text = f"Went back to {journal.before}: {why}"
        try:
            self.system.compile()
            if waits:
                self._wait_until_disarmed(journal)
            if restarts:
                self.system.restart()
        except OSError as error:
            text += f"; then {error}"
        result = self._say("went back", journal.version, journal.before, text)
        self._end()
        return result

    def _wait_until_disarmed(self, journal: Journal) -> None:
        is_said = False
        while self.system.is_armed():
            if not is_said:
                self._say("running", journal.version, journal.before, "waits until the boat is disarmed")
                is_said = True
            self.pause(_WAIT_S)

    def _before(self) -> str:
        try:
            return self.installation.version()
        except UpdateError:
            return ""

    def _end(self) -> None:
        remove_durably(self._journal)
        self.installation.forget()

    @property
    def _journal(self) -> Path:
        return self.folder / "journal.json"

    def _say(self, state: State, version: str, before: str, text: str) -> Result:
        result = Result(state, version, before, text, self.unix_s())
        write_durably(self.folder / "result.json", result)
        logger.info("update %s: %s", state, text)
        return result
