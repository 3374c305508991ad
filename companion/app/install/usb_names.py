"""udev rules that give a USB serial adapter a name of its own, by what tells it from others.

    boat-companion install --usb compass=/dev/ttyUSB0      makes /dev/mavboat-compass

An adapter is known by maker, product and serial number. Where it has no serial number, as those with a CH340,
or shares it with another that is plugged in, as VESCs (304), it is known by the socket that it is in.
"""

import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from companion.app.install.target import InstallError

_NAME = re.compile(r"[a-z][a-z0-9-]{0,30}")
_TOKEN = re.compile(r"[\w.:+-]+")  # what may stand between a rule's quotation marks
HEAD = "# mavboat: names of the boat's USB parts, written by `boat-companion install --usb`\n"


def usb_rules(options: Sequence[str], before: str = "", sys_root: Path = Path("/sys")) -> str:
    """The file's text: the rules for NAME=DEVICE options, and of `before` those of other names. Raises
    InstallError for an option that is wrong, or a device that is not on USB.
    """
    rules = {name: rule for rule in before.splitlines() if (name := _named(rule))}
    for option in options:
        name, _, device = option.partition("=")
        if not _NAME.fullmatch(name) or not device.startswith("/dev/"):
            raise InstallError(f"--usb {option}: expected NAME=/dev/…, such as compass=/dev/ttyUSB0")
        rules[name] = _rule(name, Path(device), sys_root)
    return HEAD + "".join(f"{rules[name]}\n" for name in sorted(rules))


def _named(rule: str) -> str:
    found = re.search(r'SYMLINK\+="mavboat-([^"]+)"', rule)
    return found[1] if found else ""


def _rule(name: str, device: Path, sys_root: Path) -> str:
    tty = device.resolve().name
    node = (sys_root / "class/tty" / tty / "device").resolve()
    interface, adapter = _adapter([node, *node.parents])
    if adapter is None:
        raise InstallError(f"{device}: not a serial device on USB, or not plugged in")
    maker, product, serial = identity = _identity(adapter)
    matches = [f'ATTRS{{idVendor}}=="{maker}"', f'ATTRS{{idProduct}}=="{product}"']
    nodes = (one.resolve() for one in (sys_root / "class/tty").glob("*/device"))
    others = (_adapter([one, *one.parents])[1] for one in nodes)
    is_known = serial and not any(one and one != adapter and _identity(one) == identity for one in others)
    matches.append(f'ATTRS{{serial}}=="{serial}"' if is_known else f'KERNELS=="{adapter.name}"')
    number = _attribute(interface, "bInterfaceNumber") if interface is not None else ""
    if number not in ("", "00"):  # another port of the same adapter
        matches.append(f'ENV{{ID_USB_INTERFACE_NUM}}=="{number}"')
    return ", ".join(['SUBSYSTEM=="tty"', *matches, f'SYMLINK+="mavboat-{name}"'])


def _identity(adapter: Path) -> tuple[str, str, str]:
    """Maker, product and serial number, empty without one."""
    return _attribute(adapter, "idVendor"), _attribute(adapter, "idProduct"), _attribute(adapter, "serial")


def _adapter(folders: Iterable[Path]) -> tuple[Path | None, Path | None]:
    """The USB interface and the USB device above a serial device."""
    interface = None
    for folder in folders:
        if (folder / "bInterfaceNumber").is_file():
            interface = folder
        if (folder / "idVendor").is_file():
            return interface, folder
    return None, None


def _attribute(folder: Path, name: str) -> str:
    try:
        value = (folder / name).read_text(encoding="utf-8", errors="replace").strip()
    except OSError:
        return ""
    return value if _TOKEN.fullmatch(value) else ""
