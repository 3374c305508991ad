"""QGroundControl's way to read a file about parameters, in our own words: what it drops, and what it shows.

After the behaviour of its classes CompInfoParam, FactMetaData and JsonHelper (4.4 to 5.0). What makes it log
a warning is refused here. Where versions differ, the stricter or the poorer one counts: some take a missing
`decimalPlaces` for 0 and show 0.4 as 0.
"""

import json
import lzma
import struct
from typing import Any, NamedTuple

_INTEGERS = {
    "Uint8": (0, 0xFF),
    "Int8": (-0x80, 0x7F),
    "Uint16": (0, 0xFFFF),
    "Int16": (-0x8000, 0x7FFF),
    "Uint32": (0, 0xFFFFFFFF),
    "Int32": (-0x80000000, 0x7FFFFFFF),
}
_FLOAT = 3.4028234663852886e38
_KEYS = {
    "name": str, "type": str, "shortDesc": str, "longDesc": str, "units": str, "decimalPlaces": float,
    "min": float, "max": float, "control": bool, "qgcRebootRequired": bool, "rebootRequired": bool,
    "category": str, "group": str, "volatile": bool, "bitmask": list, "values": list,
    "enumValues": str, "enumStrings": str,
}  # fmt: skip
_REQUIRED = ("name", "type")
_LZMA2_ALONE = 0x21  # the filter's number; with another filter it would not come first


class UnreadableError(ValueError):
    """QGroundControl would log a warning and show nothing, or show something else."""


class Fact(NamedTuple):
    """A parameter as its pages show it. choices: of the menu. bits: by mask."""

    name: str
    kind: str
    text: str
    units: str
    default: float
    low: float
    high: float
    decimals: int
    choices: dict[float, str]
    bits: dict[int, str]
    needs_reboot: bool

    def shown(self, value: float) -> str:
        """What stands in the field."""
        if self.choices:
            return self.choices.get(value, f"Unknown: {value:g}")
        return f"{value:.{self.decimals}f}"

    def is_default(self, value: float) -> bool:
        """Whether the value is not listed as changed."""
        return value == self.default


def unpacked(name: str, content: bytes) -> bytes:
    """A file as it is after the download: unpacked if its name says so, by a decoder that knows no filter but
    LZMA2 and no checksum but CRC32 (XZ Embedded).

    Raises:
        UnreadableError: it cannot be unpacked.
    """
    if not name.endswith((".xz", ".lzma")):
        return content
    if content[:8] != b"\xfd7zXZ\x00\x00\x01":
        raise UnreadableError(f"{name}: no xz file with CRC32")
    if content[14] != _LZMA2_ALONE:
        raise UnreadableError(f"{name}: a filter besides LZMA2")
    return lzma.decompress(content, format=lzma.FORMAT_XZ)


def read(content: bytes) -> dict[str, Fact]:
    """The facts of a file.

    Raises:
        UnreadableError: anything is amiss; says what.
    """
    try:
        tree = json.loads(content)
    except ValueError as error:
        raise UnreadableError(str(error)) from None
    _check_types("the file", tree, {"version": float, "parameters": list}, ("version", "parameters"))
    if int(tree["version"]) != 1:
        raise UnreadableError(f"Metadata json unsupported version {tree['version']}")
    facts: dict[str, Fact] = {}
    for entry in tree["parameters"]:
        fact = _fact(entry)
        if fact.name in facts:
            raise UnreadableError(f"{fact.name} comes twice")
        facts[fact.name] = fact
    return facts


def _fact(entry: object) -> Fact:
    if not isinstance(entry, dict):
        raise UnreadableError("an entry is no object")
    name = str(entry.get("name"))
    _check_types(name, entry, _KEYS, _REQUIRED)
    if not 0 < len(name.encode()) <= 16:
        raise UnreadableError(f"{name}: no name of a parameter")
    kind = entry["type"]
    if kind not in (*_INTEGERS, "Float"):
        raise UnreadableError(f"{name}: Unknown type {kind}")
    least, most = _INTEGERS.get(kind, (-_FLOAT, _FLOAT))
    low = _number(entry, "min", kind, least)
    high = _number(entry, "max", kind, most)
    default = _number(entry, "default", kind, 0.0)
    if "default" not in entry or not least <= low <= default <= high <= most:
        raise UnreadableError(f"{name}: default {default} is outside {low}..{high} of {kind}")
    choices = {_number(one, "value", kind, 0.0): text for one, text in _named(entry, "values", "value")}
    if choices and not all(low <= value <= high for value in choices):
        raise UnreadableError(f"{name}: a value is outside {low}..{high}")
    if choices and default not in choices:
        raise UnreadableError(f"{name}: the default is not in the menu")
    bits = {1 << _index(one, name): text for one, text in _named(entry, "bitmask", "index")}
    if choices and bits:
        raise UnreadableError(f"{name}: both values and bits: the bits are dropped")
    return Fact(
        name, kind, entry.get("shortDesc", ""), entry.get("units", ""), default, low, high,
        int(entry.get("decimalPlaces", 0)), choices, bits, entry.get("rebootRequired", False),
    )  # fmt: skip


def _named(entry: dict[str, Any], key: str, number: str) -> list[tuple[dict[str, Any], str]]:
    pairs = []
    for one in entry.get(key, ()):
        if not isinstance(one, dict):
            raise UnreadableError(f"{entry['name']}: an element of {key} is no object")
        _check_types(
            f"{entry['name']}.{key}", one, {number: float, "description": str}, (number, "description")
        )
        pairs.append((one, one["description"]))
    if len({text for _, text in pairs}) != len(pairs) or not all(text for _, text in pairs):
        raise UnreadableError(f"{entry['name']}: two of {key} have the same name, or none")
    return pairs


def _index(one: dict[str, Any], name: str) -> int:
    index = one["index"]
    if index != int(index) or not 0 <= index < 31:
        raise UnreadableError(f"{name}: {index} is no number of a bit")
    return int(index)


def _number(entry: dict[str, Any], key: str, kind: str, otherwise: float) -> float:
    """A number as the type holds it; one that the type cannot hold is refused."""
    value = entry.get(key, otherwise)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise UnreadableError(f"{entry.get('name')}: Invalid {key} value")
    if kind == "Float":
        return float(struct.unpack("<f", struct.pack("<f", value))[0])
    least, most = _INTEGERS[kind]
    if value != int(value) or not least <= value <= most:
        raise UnreadableError(f"{entry.get('name')}: {key} {value} is no {kind}")
    return float(value)


def _check_types(where: str, tree: object, types: dict[str, type], required: tuple[str, ...]) -> None:
    if not isinstance(tree, dict):
        raise UnreadableError(f"{where}: no object")
    for key in required:
        if key not in tree:
            raise UnreadableError(f"{where}: The following required keys are missing: {key}")
    for key, expected in types.items():
        if key not in tree:
            continue
        value = tree[key]
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        if not (is_number if expected is float else isinstance(value, expected)):
            raise UnreadableError(f"{where}: Incorrect value type - key {key}")
