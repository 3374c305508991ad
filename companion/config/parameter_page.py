"""The page about the parameters, made from the one table: `boat-companion params --markdown`."""

import math
from collections.abc import Iterable

from companion.config.boat_config import BoatConfig
from companion.config.parameter_table import ROWS
from companion.config.parameters import ParameterRow, Parameters, ParameterType
from companion.persistence.storage import MemoryStorage

_TYPES = {
    ParameterType.INT8: "INT8",
    ParameterType.INT16: "INT16",
    ParameterType.INT32: "INT32",
    ParameterType.REAL32: "REAL32",
}

_INTRODUCTION = """\
# Parameters

Made by `boat-companion params --markdown` from `companion/config/parameter_table.py`; do not edit.

Ground stations read and change these over MAVLink. A change holds at once, unless it says otherwise, and is
kept in `params.parm` of the storage folder, as text that ground stations can read. It is answered with
PARAM_VALUE once the disk has it. A value out of range is refused with a message, and the old one stays.
The key is the field of the configuration file that the parameter stands for; the value there is the default.
The same descriptions are served from the boat as component metadata (`mftp:///metadata/parameters.json`),
and all values as one file (`@PARAM/param.pck`).
"""

_VALUES = """\
## Values

What the numbers stand for. `+` marks a bit: the parameter is the sum of those that are set.
"""

_CONSTANTS = """\
## Constants

Ground stations insist on these. They say what is so on this boat and cannot be changed.
"""


def parameter_page(rows: tuple[ParameterRow, ...] = ROWS) -> str:
    """The page in Markdown."""
    parameters = Parameters(BoatConfig(), rows, MemoryStorage())
    live = [
        (
            f"`{row.name}`",
            _meaning(row),
            _number(parameters.value(row)),
            _range(row),
            row.unit,
            _key(row),
            _TYPES[row.kind],
        )
        for row in rows
        if not row.read_only
    ]
    constants = [
        (f"`{row.name}`", _meaning(row), _number(parameters.value(row)), row.unit, _TYPES[row.kind])
        for row in rows
        if row.read_only
    ]
    return "\n".join(
        [
            _INTRODUCTION,
            *_table(("name", "meaning", "default", "range", "unit", "key", "type"), live),
            "",
            _VALUES,
            *_table(("parameters", "values"), _values(rows)),
            "",
            _CONSTANTS,
            *_table(("name", "meaning", "value", "unit", "type"), constants),
            "",
        ]
    )


def _table(head: tuple[str, ...], lines: Iterable[tuple[str, ...]]) -> list[str]:
    rule = tuple("---" for _ in head)
    return [f"| {' | '.join(cell.replace('|', '/') for cell in line)} |" for line in (head, rule, *lines)]


def _meaning(row: ParameterRow) -> str:
    return f"{row.text} (from the next start on)" if row.needs_restart else row.text


def _values(rows: Iterable[ParameterRow]) -> Iterable[tuple[str, str]]:
    """Parameters that share their values or bits, and what these stand for."""
    shared: dict[str, list[str]] = {}
    for row in rows:
        named = [f"{number} {name}" for number, name in row.values]
        named += [f"+{1 << number} {name}" for number, name in row.bits]
        if named and not row.read_only:
            shared.setdefault("; ".join(named), []).append(f"`{row.name}`")
    return [(", ".join(names), values) for values, names in shared.items()]


def _number(value: float) -> str:
    return f"{value:.7g}"


def _range(row: ParameterRow) -> str:
    low = _number(row.low) if math.isfinite(row.low) else ""
    high = _number(row.high) if math.isfinite(row.high) else ""
    return f"{low}…{high}" if low or high else ""


def _key(row: ParameterRow) -> str:
    return f"`{row.path}`" if row.path else ""
