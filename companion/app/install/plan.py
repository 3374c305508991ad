"""What an installation consists of."""

from pathlib import Path

from companion.app.install.accounts import USER, group_step, no_user_step, user_step
from companion.app.install.files import file_step, folder_step, no_folder_step
from companion.app.install.page import PageOptions, no_page_steps, page_enabled, page_steps
from companion.app.install.service import UNIT, compiled_step, enabled_step, reloaded_step
from companion.app.install.steps import InstallStep
from companion.app.install.target import Target
from companion.app.install.unit import CONFIG, FILES, unit_text

GROUPS = ("gpio", "i2c", "dialout", "video")
STATE = Path("/var/lib/mavboat")

USB_FILE = Path("/etc/udev/rules.d/61-mavboat-usb.rules")
_UNIT_FILE = Path("/etc/systemd/system") / UNIT
_FILES = {
    "60-mavboat.rules": (
        Path("/etc/udev/rules.d/60-mavboat.rules"),
        "names of USB parts, access to pins and PWM",
    ),
    "journald.conf": (
        Path("/etc/systemd/journald.conf.d/mavboat.conf"),
        "a journal on disk of at most 200 MB",
    ),
    "modules.conf": (Path("/etc/modules-load.d/mavboat.conf"), "drivers of I²C and USB ports loaded early"),
    "watchdog.conf": (
        Path("/etc/systemd/system.conf.d/mavboat.conf"),
        "a hardware watchdog that resets a hung computer",
    ),
    "panic.conf": (Path("/etc/sysctl.d/90-mavboat.conf"), "a restart after a panic of the kernel"),
}


def install_steps(
    target: Target, programs: Path, config_text: str, usb_text: str = "", page: PageOptions | None = None
) -> list[InstallStep]:
    """The steps of an installation, in their order.

    programs: the folder of boat-companion on the target. usb_text: rules that name USB parts, if any. page:
    the shore page, if wanted.
    """
    steps: list[InstallStep] = [group_step(target, name) for name in GROUPS]
    steps += [
        user_step(target, USER, GROUPS, STATE),
        folder_step(target, CONFIG.parent, "root"),
        folder_step(target, STATE, USER),
        file_step(target, CONFIG, config_text, "the boat's configuration", keeps=True),
    ]
    for name, (path, what) in _FILES.items():
        text = (FILES / name).read_text(encoding="utf-8")
        steps += [folder_step(target, path.parent, mode=None), file_step(target, path, text, what)]
    if usb_text:
        steps.append(file_step(target, USB_FILE, usb_text, "names of the boat's USB parts"))
    steps += [file_step(target, _UNIT_FILE, unit_text(programs), "the unit")]
    if page is not None:
        steps += page_steps(target, programs, page)
    if target.is_this_machine:
        steps += [compiled_step(target, programs), reloaded_step(target)]
    steps.append(enabled_step(target, is_wanted=True))
    return steps if page is None else [*steps, page_enabled(target, is_wanted=True)]


def uninstall_steps(target: Target, *, purge: bool) -> list[InstallStep]:
    """The steps that remove it again. purge: also configuration, missions, logs and their user."""
    steps = no_page_steps(target)
    steps += [enabled_step(target, is_wanted=False), file_step(target, _UNIT_FILE, None, "the unit")]
    for path, what in ((USB_FILE, "names of the boat's USB parts"), *reversed(_FILES.values())):
        steps.append(file_step(target, path, None, what))
    if target.is_this_machine:
        steps.append(reloaded_step(target))
    if purge:
        steps.append(no_user_step(target, USER, user_step(target, USER, GROUPS, STATE)))
        steps += [no_folder_step(target, path) for path in (CONFIG.parent, STATE)]
    return steps
