"""Changes of values in a commented TOML file, with its comments kept."""

import json
import re
from collections.abc import Mapping

Value = str | bool | int | float


def with_values(text: str, values: Mapping[str, Value]) -> str:
    """The text with other values. values: by dotted key, such as `parts.gnss.port`.

    A key that has no line gets one, at the head of its table; a missing table is added at the end. Only
    values on one line that contain no `#` can be replaced.
    """
    lines = text.splitlines()
    for path, value in values.items():
        table, _, key = path.rpartition(".")
        _set(lines, table, key, json.dumps(value, ensure_ascii=False))
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
