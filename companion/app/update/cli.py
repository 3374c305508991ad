"""`boat-companion update`."""

import fcntl
import logging
import os
import sysconfig
import time
from pathlib import Path
from typing import Annotated

import typer

from companion.app.install.accounts import USER
from companion.app.install.target import Target
from companion.app.install.unit import CONFIG
from companion.app.status_file import RUNTIME_DIRECTORY
from companion.app.update.installation import Installation, UpdateError
from companion.app.update.spool import update_from_spool
from companion.app.update.system import ThisMachine, copy_wheel
from companion.app.update.updater import STATE_FOLDER, Updater
from companion.core.wheel_file import MOST_PACKED_BYTES


def update(
    wheel: Annotated[Path | None, typer.Argument(help="A wheel of mavboat.")] = None,
    spool: Annotated[
        Path | None, typer.Option(help="Take the wheel that the page left in this folder.")
    ] = None,
) -> None:
    """Install a new version from a wheel, restart the boat, and go back if it does not come up.

    An update that was interrupted is finished or taken back first. An armed boat is not updated.

    Example:  sudo /opt/mavboat/.venv/bin/boat-companion update mavboat-0.2.0-py3-none-any.whl
    """
    if (wheel is None) == (spool is None):
        raise typer.BadParameter("expected a wheel, or --spool")
    if os.geteuid() != 0:
        raise UpdateError("only root can update: start it with sudo")
    logging.basicConfig(level=logging.INFO, format="%(message)s")
    STATE_FOLDER.mkdir(exist_ok=True)
    with (STATE_FOLDER / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        updater = _updater()
        result = updater.recover()
        if spool is not None:
            result = update_from_spool(updater, spool) or result
        elif wheel is not None:
            path = wheel
            result = updater.update(path.name, lambda goal: copy_wheel(path, goal, MOST_PACKED_BYTES))
    if result is not None:
        typer.echo(f"{result.state}: {result.text}")
        if result.state != "done":
            raise typer.Exit(1)


def _updater() -> Updater:
    # of the environment, not of this module, which may be that of the kept version
    site, programs = Path(sysconfig.get_path("purelib")), Path(sysconfig.get_path("scripts"))
    status = RUNTIME_DIRECTORY / "status.json"
    machine = ThisMachine(programs, site, CONFIG, status, Target().ids(USER))
    installation = Installation(site, programs, STATE_FOLDER / "kept")
    return Updater(STATE_FOLDER, installation, machine, time.time, time.sleep)
