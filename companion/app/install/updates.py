"""What belongs to updates from the shore page: two units and two folders."""

from pathlib import Path
from string import Template
from typing import Final

from companion.app.install.accounts import USER
from companion.app.install.files import FileText, Folder, NoFolder
from companion.app.install.service import Enabled
from companion.app.install.steps import Step
from companion.app.install.target import Target
from companion.app.install.unit import FILES

_UNITS: Final = Path("/etc/systemd/system")
_SERVICE: Final = "mavboat-update.service"
_PATH: Final = "mavboat-update.path"
SPOOL: Final = Path("/var/lib/mavboat/update")
_STATE: Final = Path("/var/lib/mavboat-update")
_WHAT: Final = {_SERVICE: "the unit of updates", _PATH: "what starts an update"}


def has_updates(target: Target) -> bool:
    """Whether the page may update the boat already."""
    return target.path(_UNITS / _PATH).exists()


def update_steps(target: Target, programs: Path) -> list[Step]:
    """Folders and units. The environment is the folder above that of the programs."""
    steps: list[Step] = [Folder(target, SPOOL, USER, 0o700), Folder(target, _STATE)]
    for name, what in _WHAT.items():
        template = Template((FILES / name).read_text(encoding="utf-8"))
        text = template.substitute(bin=programs, environment=programs.parent)
        steps.append(FileText(target, _UNITS / name, text, what))
    return steps


def updates_enabled(target: Target, *, is_wanted: bool) -> Step:
    """A wheel in the folder starts an update, or does not."""
    return Enabled(target, is_wanted=is_wanted, unit=_PATH)


def no_update_steps(target: Target) -> list[Step]:
    """The steps that remove it again."""
    units = [FileText(target, _UNITS / name, None, what) for name, what in _WHAT.items()]
    return [
        updates_enabled(target, is_wanted=False),
        *units,
        *(NoFolder(target, one) for one in (_STATE, SPOOL)),
    ]
