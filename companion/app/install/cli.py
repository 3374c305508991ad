"""`boat-companion install` and `uninstall`."""

import os
import sys
from pathlib import Path
from typing import Annotated

from companion.app.composition import check_config
from companion.app.init.presets import preset_text
from companion.app.install import plan
from companion.app.install.steps import UNIT, USER, apply_steps, describe_steps
from companion.app.install.target import InstallError, Target, is_readable_by_others, need_programs
from companion.app.install.usb_names import usb_rules
from companion.cli.command_line import Option, echo
from companion.config.boat_config import load_config
from companion.core.errors import UsageError

Root = Annotated[Path, Option("--root", help="Root folder of the system: / or that of an image.")]
DryRun = Annotated[bool, Option("--dry-run", help="Say what would be done, and do nothing.")]


def install(
    config: Annotated[Path | None, Option("--config", "-c", help="The boat's TOML file to copy.")] = None,
    root: Root = Path("/"),
    programs: Annotated[Path | None, Option(help="Folder of boat-companion on that system.")] = None,
    usb: Annotated[
        list[str] | None, Option(help="NAME=DEVICE: call this USB adapter /dev/mavboat-NAME.")
    ] = None,
    page: Annotated[bool, Option("--page", help="Also the shore page, on port 80.")] = False,
    page_map: Annotated[
        Path | None, Option("--page-map", help="GeoJSON map of the water for the page.")
    ] = None,
    dry_run: DryRun = False,
) -> None:
    """Install the boat as a service: user, folders, configuration, udev names, unit. Changes nothing twice.

    A step that fails has the steps before it undone. The configuration is never overwritten.

    Example:  sudo /opt/mavboat/.venv/bin/boat-companion install --config boat.toml
    """
    target = _target(root, needs_root=not dry_run)
    if programs is None:
        programs = Path(sys.executable).parent if target.is_this_machine else plan.PROGRAMS
    if config is not None:
        check_config(load_config(config))
    text = config.read_text(encoding="utf-8") if config else preset_text("lake")
    has_page = page or target.path(plan.SHORE_UNIT_FILE).exists()  # one that is installed stays
    if page_map is not None and not page:
        raise UsageError("--page-map needs --page")
    map_text = page_map.read_text(encoding="utf-8") if page_map else "" if has_page else None
    if page and target.is_this_machine:
        plan.check_page_program(target, programs)
    steps = plan.install_steps(
        target, programs, text, _usb_text(target, usb or []), map_text if has_page else None
    )
    program = programs / "boat-companion"
    if dry_run:
        describe_steps(steps, echo)
        return
    if target.is_this_machine and not is_readable_by_others(program):
        raise InstallError(
            f"{program}: not readable by the boat's user; make the environment in /opt/mavboat"
        )
    need_programs("systemctl", "groupadd", "useradd")
    apply_steps(steps, echo)
    if not target.path(program).exists():
        echo(f"{program} is missing in {target.root}: install mavboat there before the first start")
    if target.is_this_machine:
        units = UNIT if not has_page else f"{UNIT} {plan.SHORE_UNIT}"
        echo(f"Edit {plan.CONFIG}, run `boat-companion doctor`, then: sudo systemctl restart {units}")
    if has_page and not target.path(plan.PIN_FILE).exists():
        echo(f"Set the page's PIN: sudo -u {USER} {programs}/boat-shore pin --pin-file {plan.PIN_FILE}")


def uninstall(
    root: Root = Path("/"),
    purge: Annotated[bool, Option("--purge", help="Also configuration, missions and logs.")] = False,
    dry_run: DryRun = False,
) -> None:
    """Stop the service and remove what `install` made. Shared groups stay.

    Without --purge, the configuration, missions, logs and the user that owns them stay as well.
    """
    target = _target(root, needs_root=not dry_run)
    steps = plan.uninstall_steps(target, purge=purge)
    if dry_run:
        describe_steps(steps, echo)
        return
    need_programs("systemctl")
    apply_steps(steps, echo)


def _usb_text(target: Target, usb: list[str]) -> str:
    path = target.path(plan.USB_FILE)
    before = path.read_text(encoding="utf-8") if path.exists() else ""
    return usb_rules(usb, before) if usb else before


def _target(root: Path, *, needs_root: bool) -> Target:
    target = Target(root.resolve())
    if not target.root.is_dir():
        raise InstallError(f"{root}: no such folder")
    if target.is_this_machine and needs_root and os.geteuid() != 0:
        raise InstallError("only root can install: start it with sudo")
    return target
