"""The presets of `boat-companion init`: whole boats whose files lie in `texts/`.

A boat's file is the preset's own text (motors, hull) between the parts that all boats share (links and
identity; sensors, arming, failsafe, storage), with some other values.
"""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from companion.config.board import uart_on

Value = str | bool | int | float
_TEXTS = Path(__file__).parent / "texts"
_STATIONS: Final = "udpout:192.168.4.255:"
_RADIO: Final = '# "serial:/dev/ttyUSB0:57600", # a SiK radio'
STATIONS: Final = _STATIONS.split(":")[1]
"""Address of the preset's link: broadcast on the boat's own Wi-Fi."""
_USAGE: Final = """#
#   boat-companion check --config boat.toml
#   boat-companion run   --config boat.toml
#
# The file needs only values that differ from the defaults. An unknown key or a value out of range is an error
# that names the key. Pins are BCM numbers, angles are in radians, other values in SI units.
"""


@dataclass(frozen=True)
class Preset:
    """A boat. model: the emulator's boat with the same figures; values: other than the shared ones."""

    title: str
    model: str
    values: Mapping[str, Value] = field(default_factory=dict)


_STRONG: Final[dict[str, Value]] = {
    "parts.battery.driver": "ina226",
    "parts.battery.shunt_ohm": 0.002,
}  # 41 A

PRESETS: Final[dict[str, Preset]] = {
    "lake": Preset("1 m of hull, two DC motors behind an L298N: the boat of docs/hardware.md", "kit"),
    "pool": Preset(
        "the paper's 20 cm boat in a pool, with a camera above it", "pool", {"parts.gnss.driver": "none"}
    ),
    "catamaran": Preset("1.2 m, two brushless motors behind speed controllers (ESCs)", "catamaran", _STRONG),
    "rudder": Preset("1 m, one brushless motor behind a speed controller, and a rudder", "rudder", _STRONG),
}


def board_values(model: str) -> dict[str, Value]:
    """Ports of this model of the Pi, other than those of a Pi 4, by key."""
    usual, own = _ports(""), _ports(model)
    return {key: port for key, port in own.items() if port != usual[key]}


def _ports(model: str) -> dict[str, Value]:
    """Where there is no UART for the receiver of a transmitter, it needs an adapter."""
    return {"parts.gnss.port": uart_on((14, 15), model), "rc.port": uart_on((8, 9), model) or "/dev/ttyUSB0"}


def preset_text(name: str, values: Mapping[str, Value] | None = None) -> str:
    """The file of a preset, with values by dotted key in place of its own."""
    preset = PRESETS[name]
    introduction, _, own = _read(name).partition("\n\n")
    text = "\n".join([f"{introduction}\n{_USAGE}", _read("links"), own, _read("sensors")])
    return with_values(text, {**preset.values, **(values or {})})


def with_links(text: str, stations: str, radio: str) -> str:
    """The text with other links. stations: address to send to; radio: port of a telemetry radio, or none."""
    text = text.replace(_STATIONS, f"udpout:{stations}:")
    return text.replace(_RADIO, f'"serial:{radio}:57600",  # a SiK radio') if radio != "none" else text


def _read(name: str) -> str:
    return (_TEXTS / f"{name}.toml").read_text(encoding="utf-8")


def with_values(text: str, values: Mapping[str, Value]) -> str:
    """The text with other values. values: by dotted key, such as `parts.gnss.port`.

    Addresses on a bus are written in hexadecimal digits.
    A key that has no line gets one, at the head of its table; a missing table is added at the end. Only
    values on one line that contain no `#` can be replaced.
    """
    lines = text.splitlines()
    for path, value in values.items():
        table, _, key = path.rpartition(".")
        is_hex = key.endswith("address") and isinstance(value, int)
        _set(lines, table, key, f"{value:#x}" if is_hex else json.dumps(value, ensure_ascii=False))
    return "\n".join(lines) + "\n"


def _set(lines: list[str], table: str, key: str, value: str) -> None:
    if f"[{table}]" not in (line.partition("#")[0].strip() for line in lines):
        lines += ["", f"[{table}]"]
    start = next(n for n, line in enumerate(lines) if line.partition("#")[0].strip() == f"[{table}]") + 1
    end = next((n for n in range(start, len(lines)) if lines[n].startswith("[")), len(lines))
    pattern = re.compile(rf"({re.escape(key)} *= *)([^#]*[^# ])( *#.*)?$")
    for number in range(start, end):
        if found := pattern.match(lines[number]):
            before, old, comment = found.groups()
            padding = " " * max(2, len(old) + len(comment or "") - len((comment or "").lstrip()) - len(value))
            lines[number] = before + value + (padding + comment.lstrip() if comment else "")
            return
    lines.insert(start, f"{key} = {value}")
