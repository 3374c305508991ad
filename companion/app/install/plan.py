"""What an installation consists of: the boat's service and, if wanted, the shore page's."""

from pathlib import Path
from string import Template
from typing import Final

from companion.app.install.steps import (
    UNIT,
    USER,
    InstallStep,
    compiled_step,
    enabled_step,
    file_step,
    folder_step,
    group_step,
    member_step,
    no_folder_step,
    no_user_step,
    reloaded_step,
    user_step,
)
from companion.app.install.target import InstallError, Target, UnmetError

GROUPS: Final = ("gpio", "i2c", "dialout", "video")
STATE: Final = Path("/var/lib/mavboat")
PROGRAMS: Final = Path("/opt/mavboat/.venv/bin")
CONFIG: Final = Path("/etc/mavboat/boat.toml")
USB_FILE: Final = Path("/etc/udev/rules.d/61-mavboat-usb.rules")
SHORE_UNIT: Final = "mavboat-shore.service"
SHORE_UNIT_FILE: Final = Path("/etc/systemd/system") / SHORE_UNIT
PAGE_PORT: Final = 5760  # of the boat, for the page
PIN_FILE: Final = STATE / "shore-pin"
MAP_FILE: Final = CONFIG.with_name("map.geojson")

_TEXTS: Final = Path(__file__).parent / "files"
_UNIT_FILE: Final = Path("/etc/systemd/system") / UNIT
_FILES: Final = (  # text, path and what it is
    ("60-mavboat.rules", "/etc/udev/rules.d/60-mavboat.rules", "names of USB parts, access to pins and PWM"),
    ("journald.conf", "/etc/systemd/journald.conf.d/mavboat.conf", "a journal on disk of at most 200 MB"),
    ("modules.conf", "/etc/modules-load.d/mavboat.conf", "drivers of I²C and USB ports loaded early"),
    (
        "watchdog.conf",
        "/etc/systemd/system.conf.d/mavboat.conf",
        "a hardware watchdog that resets a hung computer",
    ),
    ("panic.conf", "/etc/sysctl.d/90-mavboat.conf", "a restart after a panic of the kernel"),
)
_OF_USB: Final = "names of the boat's USB parts"
_OF_PAGE: Final = "the shore page's unit"


def install_steps(
    target: Target, programs: Path, config_text: str, usb_text: str = "", page_map: str | None = None
) -> list[InstallStep]:
    """The steps of an installation, in their order.

    programs: the folder of boat-companion on the target. usb_text: rules that name USB parts, if any.
    page_map: the map of the shore page, empty for that which is there; None without a page.
    """
    steps: list[InstallStep] = [group_step(target, name) for name in GROUPS]
    steps += [
        user_step(target, USER, GROUPS, STATE),
        member_step(target, USER, GROUPS),
        folder_step(target, CONFIG.parent),
        folder_step(target, STATE, USER),
        file_step(target, CONFIG, config_text, "the boat's configuration", keeps=True),
    ]
    steps += [file_step(target, Path(path), _read(name), what) for name, path, what in _FILES]
    if usb_text:
        steps.append(file_step(target, USB_FILE, usb_text, _OF_USB))
    steps.append(file_step(target, _UNIT_FILE, unit_text(programs), "the unit"))
    if page_map:
        steps.append(file_step(target, MAP_FILE, page_map, "the map of the page"))
    if page_map is not None:
        has_map = bool(page_map) or target.path(MAP_FILE).exists()
        text = shore_unit_text(programs, has_map=has_map)
        steps.append(file_step(target, SHORE_UNIT_FILE, text, _OF_PAGE))
    if target.is_this_machine:
        steps += [compiled_step(target, programs), reloaded_step(target)]
    units = [UNIT] if page_map is None else [UNIT, SHORE_UNIT]
    return [*steps, *(enabled_step(target, unit) for unit in units)]


def uninstall_steps(target: Target, *, purge: bool) -> list[InstallStep]:
    """The steps that remove it again. purge: also configuration, missions, logs and their user."""
    files = ((str(USB_FILE), _OF_USB), *((path, what) for _, path, what in reversed(_FILES)))
    steps = [
        enabled_step(target, SHORE_UNIT, is_wanted=False),
        file_step(target, SHORE_UNIT_FILE, None, _OF_PAGE),
        enabled_step(target, UNIT, is_wanted=False),
        file_step(target, _UNIT_FILE, None, "the unit"),
        *(file_step(target, Path(path), None, what) for path, what in files),
    ]
    if target.is_this_machine:
        steps.append(reloaded_step(target))
    if purge:
        steps.append(no_user_step(target, USER, user_step(target, USER, GROUPS, STATE)))
        steps += [no_folder_step(target, path) for path in (CONFIG.parent, STATE)]
    return steps


def check_page_program(target: Target, programs: Path) -> None:
    """Start the page's program, which does its imports. Raises UnmetError, with what it says."""
    try:
        target.run(str(programs / "boat-shore"), "--version")
    except InstallError as error:
        raise UnmetError(f"--page: {error}") from None


def unit_text(programs: Path = PROGRAMS) -> str:
    """The boat's unit, for the programs of this folder."""
    return Template(_read(UNIT)).substitute(bin=programs, config=CONFIG)


def shore_unit_text(programs: Path, *, has_map: bool) -> str:
    """The unit of the page's program."""
    options = f" --map {MAP_FILE}" if has_map else ""
    template = Template(_read(SHORE_UNIT))
    return template.substitute(bin=programs, config=CONFIG, port=PAGE_PORT, options=options)


def _read(name: str) -> str:
    return (_TEXTS / name).read_text(encoding="utf-8")
