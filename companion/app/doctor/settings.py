"""Checks of the Pi's start-up files and of the devices that follow from them.

`--fix` appends missing lines to config.txt and takes the login prompt off the serial line; the file as it was
stays beside it.
"""

import re
from pathlib import Path

from companion.app.doctor.findings import Examined, Finding, failed, fine, skipped
from companion.app.install.steps import InstallStep, file_step
from companion.app.motors_off import outputs_to_end
from companion.app.needs import Needs, needs_of
from companion.config.board import HEADER_I2C, is_main_uart, is_pi_5, uart_pins

_FOLDERS = ("/boot/firmware", "/boot")  # since Bookworm, and before
_CONSOLE = re.compile(r"\bconsole=(serial0|ttyAMA0|ttyS0)\S*\s*")
_SECTION = re.compile(r"\[(.+)\]")
_PROGRAMS = ("/usr/bin", "/usr/local/bin", "/usr/sbin", "/usr/local/sbin")
BACKUP = ".before-doctor"
_HEAD = "\n[all]\n# added by boat-companion doctor\n"


def active_lines(text: str, model: str) -> list[str]:
    """The settings of config.txt that apply to a model. Known conditions: [all], [none] and [piN]."""
    number = re.search(r"Raspberry Pi (Zero|\d+)", model)
    own = f"pi{number[1].lower().replace('zero', '0')}" if number else ""
    lines, applies = [], True
    for line in (one.partition("#")[0].strip() for one in text.splitlines()):
        if section := _SECTION.fullmatch(line):
            applies = section[1] == "all" or (bool(own) and section[1].startswith(own))
        elif line and applies:
            lines.append(line)
    return lines


def wanted_lines(needs: Needs, model: str) -> dict[str, tuple[str, ...]]:
    """What config.txt needs: the line that the doctor would add, and beginnings of lines that do as well."""
    is_5 = is_pi_5(model)
    wanted: dict[str, tuple[str, ...]] = {}
    if any(map(is_main_uart, needs.ports.values())):
        line = "dtparam=uart0=on" if is_5 else "enable_uart=1"
        wanted[line] = ("enable_uart=1", "dtparam=uart0", "dtoverlay=uart0")
    for port in needs.ports.values():
        if uart_pins(port, model) and not is_main_uart(port):
            overlay = f"dtoverlay=uart{port[-1]}"
            wanted[f"{overlay}-pi5" if is_5 else overlay] = (overlay,)
    if HEADER_I2C in needs.i2c.values():
        wanted["dtparam=i2c_arm=on"] = ("dtparam=i2c_arm=on", "dtparam=i2c=on")
    if needs.stretches_clock:
        wanted["dtparam=i2c_arm_baudrate=10000"] = ("dtparam=i2c_arm_baudrate=", "dtparam=i2c_baudrate=")
    if needs.pwm:
        pins = needs.pwm.values()  # alternate functions: BCM2835 data sheet, table 6-31
        first = "pin=18,func=2" if 18 in pins else "pin=12,func=4"
        second = "pin2=19,func2=2" if 19 in pins else "pin2=13,func2=4"
        wanted[f"dtoverlay=pwm-2chan,{first},{second}"] = ("dtoverlay=pwm",)
    return wanted


def check_boot_config(examined: Examined) -> list[Finding]:
    """UART, I²C and PWM in config.txt."""
    path = _boot_file(examined, "config.txt")
    if path is None:
        return [skipped("boot settings", "no config.txt in /boot/firmware or /boot")]
    text = examined.path(path).read_text(encoding="utf-8", errors="replace")
    lines = active_lines(text, examined.model)
    wanted = wanted_lines(needs_of(examined.config), examined.model)
    missing = [line for line, others in wanted.items() if not any(have.startswith(others) for have in lines)]
    if not missing:
        return [fine("boot settings", f"{path} has what the parts need")]
    new = text.rstrip("\n") + "\n" + _HEAD + "\n".join(missing) + "\n"
    return [
        failed(
            "boot settings",
            f"{path} lacks {', '.join(missing)}",
            "add the lines, or run the doctor with --fix; then restart the Pi",
            *_replace(examined, path, text, new, f"with {', '.join(missing)}"),
        )
    ]


def check_console(examined: Examined) -> list[Finding]:
    """No login prompt and no kernel messages on a serial line that a part uses."""
    path = _boot_file(examined, "cmdline.txt")
    if path is None or not any(map(is_main_uart, needs_of(examined.config).ports.values())):
        return []
    text = examined.path(path).read_text(encoding="utf-8", errors="replace")
    found = _CONSOLE.search(text)
    if found is None:
        return [fine("serial console", "the serial line is free for the part")]
    return [
        failed(
            "serial console",
            f"{path} has {found[0].strip()}: the kernel writes on a part's line",
            "remove it, or run the doctor with --fix; then restart the Pi",
            *_replace(examined, path, text, _CONSOLE.sub("", text), "without a serial console"),
        )
    ]


def check_devices(examined: Examined) -> list[Finding]:
    needs = needs_of(examined.config)
    devices = {port: key for key, port in needs.ports.items()}
    for key, bus in needs.i2c.items():
        devices.setdefault(bus, key)
    missing = [f"{port} ({key})" for port, key in devices.items() if not examined.path(port).exists()]
    if missing:
        cure = "plug it in, correct the configuration, or set up its line in config.txt and restart"
        return [failed("devices", f"missing: {', '.join(missing)}", cure)]
    return [fine("devices", f"{len(devices)} configured devices exist")]


def check_main_port(examined: Examined) -> list[Finding]:
    """On a Pi 5, serial0 is not on the header."""
    keys = [key for key, port in needs_of(examined.config).ports.items() if port == "/dev/serial0"]
    if not keys or not is_pi_5(examined.model):
        return []
    text = f"{', '.join(keys)} = /dev/serial0, which is the debug connector of a Pi 5"
    return [failed("serial port", text, "for GPIO 14 and 15 set it to /dev/ttyAMA0")]


def check_motors_off(examined: Examined) -> list[Finding]:
    """The program with which the unit switches pins off after a kill."""
    if not any(outputs.low or outputs.high for outputs in outputs_to_end(examined.config)):
        return []
    if any(examined.path(f"{folder}/pinctrl").exists() for folder in _PROGRAMS):
        return [fine("pinctrl", "switches motors and payload off if the program is killed")]
    text = "not installed: motors or payload would run on if the program were killed"
    return [failed("pinctrl", text, "sudo apt install raspi-utils")]


def settings_findings(examined: Examined) -> list[Finding]:
    checks = (check_boot_config, check_console, check_main_port, check_devices, check_motors_off)
    return [finding for check in checks for finding in check(examined)]


def _boot_file(examined: Examined, name: str) -> str | None:
    paths = (f"{folder}/{name}" for folder in _FOLDERS)
    return next((path for path in paths if examined.path(path).is_file()), None)


def _replace(examined: Examined, path: str, old: str, new: str, what: str) -> tuple[InstallStep, ...]:
    backup = file_step(examined.target, Path(path + BACKUP), old, "the file as it was", keeps=True)
    return backup, file_step(examined.target, Path(path), new, what)
