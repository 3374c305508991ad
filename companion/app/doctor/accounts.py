"""Checks of the boat's user and its service."""

import getpass
import os
from collections.abc import Mapping
from pathlib import Path

from companion.app.doctor.findings import Examined, Finding, failed, fine, warning
from companion.app.install.plan import GROUPS, PAGE_PORT, PIN_FILE, SHORE_UNIT, SHORE_UNIT_FILE, STATE
from companion.app.install.steps import UNIT, USER, enabled_step, member_step
from companion.app.install.target import InstallError, Target
from companion.app.status_file import RUNTIME_DIRECTORY
from companion.links.port_url import parse_port_url

_STATE_NAMES = ("ActiveState", "NRestarts", "Result", "StatusText")
NEEDED = ("gpio", "i2c", "dialout")  # to run the boat, or its doctor, by hand


def check_user(examined: Examined) -> Finding:
    target = examined.target
    member = member_step(target, USER, GROUPS)
    if USER not in target.users():
        return warning("boat's user", f"there is no user {USER}", "sudo boat-companion install")
    if member.is_done():
        return fine("boat's user", f"{USER}, in {', '.join(GROUPS)}")
    text = f"{USER} is not in all of {', '.join(GROUPS)}"
    return failed("boat's user", text, "sudo boat-companion doctor --fix", member)


def check_own_groups(examined: Examined, user: str) -> Finding:
    """The groups of whoever runs the doctor."""
    groups = examined.target.groups()
    lacks = [name for name in NEEDED if user not in groups.get(name, ())]
    if user == "root" or not lacks:
        return fine("your groups", f"{user} may use pins, I²C and serial ports")
    known = [name for name in lacks if name in groups]
    steps = (member_step(examined.target, user, known),) if known else ()
    text = f"{user} is not in {', '.join(lacks)}"
    return warning("your groups", text, f"sudo usermod -aG {','.join(lacks)} {user}", *steps)


def check_service(examined: Examined, state: Mapping[str, str]) -> Finding:
    """Whether the boat starts with the computer, and does not fail again and again. state: of the unit."""
    is_active, restarts = state.get("ActiveState"), state.get("NRestarts", "0")
    why = "journalctl -u mavboat -n 30"
    if is_active == "activating" and restarts != "0":  # between two starts, or in one
        return failed("service", f"fails, and was started again {restarts} times", why)
    if is_active == "failed":
        return warning("service", f"has failed: {state.get('Result', '')}", why)
    if not enabled_step(examined.target).is_done():
        text = "does not start with the computer"
        return warning("service", text, "sudo boat-companion install")
    now = f", runs now: {state.get('StatusText')}" if is_active == "active" else ""
    return fine("service", f"starts with the computer{now}")


def check_page(examined: Examined) -> list[Finding]:
    """Whether the shore page, if it is installed, starts, has a PIN and reaches the boat."""
    target = examined.target
    if not target.path(SHORE_UNIT_FILE).exists():
        return []
    if not enabled_step(target, SHORE_UNIT).is_done():
        text, cure = "does not start with the computer", "sudo boat-companion install --page"
        return [warning("page", text, cure)]
    if not any(
        url.kind == "tcpin" and url.number == PAGE_PORT and link.signing != "required"
        for link in examined.config.link_settings
        for url in (parse_port_url(link.url),)
    ):
        text = f"the boat has no link for it at TCP port {PAGE_PORT}"
        return [failed("page", text, f'add "tcpin:127.0.0.1:{PAGE_PORT}" to links')]
    if not target.path(PIN_FILE).exists():
        cure = f"sudo -u {USER} boat-shore pin --pin-file {PIN_FILE}"
        return [warning("page", "no PIN is set: it only shows", cure)]
    return [fine("page", "starts with the computer, and has a PIN")]


def unit_state(target: Target) -> dict[str, str]:
    """The unit's state in the running systemd; empty where there is none."""
    if not target.is_this_machine:
        return {}
    names = ",".join(_STATE_NAMES)
    try:
        lines = target.run("systemctl", "show", UNIT, f"--property={names}").splitlines()
    except InstallError:
        return {}
    return dict(line.split("=", 1) for line in lines if "=" in line)


def check_folders(examined: Examined) -> Finding:
    """Whether the unit, to which the rest of the system is read-only, may write where it should."""
    config = examined.config
    named = {"storage.folder": config.storage.folder, "camera.folder": config.camera.folder}
    own = (STATE, RUNTIME_DIRECTORY)
    outside = [
        f"{key} = {folder}"
        for key, folder in named.items()
        if folder and not any(Path(folder).is_relative_to(one) for one in own)
    ]
    if outside:
        text = f"the unit may not write to {', '.join(outside)}"
        cure = f"name a folder below {STATE}, or add ReadWritePaths= with `sudo systemctl edit mavboat`"
        return warning("folders", text, cure)
    return fine("folders", "all where the unit may write")


def account_findings(examined: Examined, user: str = "") -> list[Finding]:
    return [
        check_user(examined),
        check_own_groups(examined, user or os.environ.get("SUDO_USER") or getpass.getuser()),
        check_service(examined, unit_state(examined.target)),
        check_folders(examined),
        *check_page(examined),
    ]
