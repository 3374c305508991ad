"""The wiring table of docs/hardware.md, as rows and as wires."""

import re
from dataclasses import dataclass
from typing import Final

_ROW: Final = re.compile(r"^\| (\d+) \| (\d+) \| ([^|]+) \|([^|]*)\|$", re.MULTILINE)
_BUS: Final = re.compile(r"(\w+) of (.+)")
_OHMS: Final = re.compile(r"\d+ kΩ to ground")


@dataclass(frozen=True)
class Wire:
    """A row of the table. terminals: of the parts that it goes to, as (part, terminal)."""

    bcm: int
    header_pin: int
    terminals: tuple[tuple[str, str], ...]
    pull_down: str = ""  # the resistor to ground, such as "10 kΩ"
    has_divider: bool = False


def wiring_rows(page: str) -> list[tuple[str, str, str, str]]:
    """The cells of the table: BCM number, header pin, goes to, configuration key."""
    return _ROW.findall(page)


def read_wiring(page: str) -> list[Wire]:
    """The wires of the table."""
    return [_wire(int(bcm), int(pin), text.strip()) for bcm, pin, text, _ in wiring_rows(page)]


def _wire(bcm: int, header_pin: int, text: str) -> Wire:
    place = re.split(r"[,:(]", text)[0].strip()
    if bus := _BUS.fullmatch(place):
        terminals = tuple((part, bus[1]) for part in bus[2].split(" and "))
    else:
        part, _, terminal = place.replace("'s ", " ").rpartition(" ")
        terminals = ((part, terminal),)
    resistor = _OHMS.search(text)
    return Wire(
        bcm,
        header_pin,
        terminals,
        resistor[0].removesuffix(" to ground") if resistor else "",
        "divider" in text,
    )
