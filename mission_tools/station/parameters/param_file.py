"""Parameter files of Mission Planner (`NAME,VALUE`), MAVProxy (`NAME VALUE`) and QGroundControl.

QGroundControl's lines have five columns: system, component, name, value, type. Written is Mission Planner's
form, which MAVProxy reads too.
"""

import math
import re
from collections.abc import Iterable, Mapping
from typing import Any, Final

from companion.core.status_text import one_line
from mission_tools.station.parameters.metadata import Descriptions
from mission_tools.station.parameters.values import Value, float_or_int, is_same, write
from mission_tools.station.words import LocalizedText, say

MOST_BYTES: Final = 500_000  # 10,000 lines
_MOST_LINES: Final = 12_000
_MOST_TOLD: Final = 40  # characters of a line
_NAME: Final = re.compile(r"[!-\"$-+\--~]{1,16}")  # without comma and #, which mean something else in a file
_NEAR: Final = 1e-6  # as pymavlink's MAVParmDict: files have six decimals


class ParamFileError(ValueError):
    """A file that is no parameter file. text: names the line."""

    def __init__(self, text: LocalizedText) -> None:
        super().__init__(text)
        self.text = text


def write_file(values: Iterable[tuple[str, Value]], title: str) -> bytes:
    """By name; values that are no number are left out. title: a comment in its first line."""
    lines = [
        f"{name},{write(number)}"
        for name, value in sorted(values)
        if (number := value.number()) is not None and _NAME.fullmatch(name)
    ]
    return "\n".join([f"# {one_line(title)}", *lines, ""]).encode("utf-8")


def read_file(content: bytes) -> dict[str, float]:
    """The values by name, the last one of several; ParamFileError names the line that is none."""
    try:
        text = content.removeprefix(b"\xef\xbb\xbf").decode("utf-8")
    except UnicodeDecodeError:
        raise ParamFileError(say("error.param_file.no_text")) from None
    lines = text.splitlines()
    if len(lines) > _MOST_LINES:
        raise ParamFileError(say("error.param_file.long", n=len(lines), most=_MOST_LINES))
    values: dict[str, float] = {}
    for number, line in enumerate(lines, 1):
        words = line.split("#")[0].replace(",", " ").split()
        words = [word for word in words if not word.startswith("@")]  # ArduPilot's @READONLY
        if not words:
            continue
        if len(words) == 5 and words[0].isdigit() and words[1].isdigit():
            words = words[2:4]
        value = _number(words[1]) if len(words) == 2 and _NAME.fullmatch(words[0]) else None
        if value is None:
            raise ParamFileError(
                say("error.param_file.line", n=number, line=one_line(line).strip()[:_MOST_TOLD])
            )
        values[words[0]] = value
    if not values:
        raise ParamFileError(say("error.param_file.empty"))
    return values


def _number(word: str) -> float | None:
    try:
        value = float(int(word[2:], 16)) if word.lower().startswith("0x") else float(word)
    except (ValueError, OverflowError):
        return None
    return value if math.isfinite(value) else None


def compare(
    file: Mapping[str, float], values: Mapping[str, Value], descriptions: Descriptions
) -> dict[str, Any]:
    """{differences: [{name, now, file, text, unit, read_only}], same, unknown: [name]} by name."""
    differences: list[dict[str, Any]] = []
    unknown: list[str] = []
    for name, wanted in sorted(file.items()):
        known = values.get(name)
        if known is None:
            unknown.append(name)
        elif not _is_near(known, wanted):
            described = descriptions.of(name)
            differences.append(
                {
                    "name": name,
                    "now": known.number(),
                    "file": float_or_int(wanted, known.is_whole and wanted.is_integer()),
                    "text": described.text,
                    "unit": described.unit,
                    "read_only": described.read_only,
                }
            )
    return {
        "differences": differences,
        "same": len(file) - len(differences) - len(unknown),
        "unknown": unknown,
    }


def _is_near(known: Value, wanted: float) -> bool:
    if known.value is None:
        return False
    return is_same(known.value, wanted) or abs(known.value - wanted) <= _NEAR
