"""A probe's value from what its source says."""

import re

from companion.config.parts.probes import ProbePart
from companion.config.section import FLOAT32_MAX

_SEPARATORS = re.compile(r"[,;\s]+")


def raw_number(text: str, part: ProbePart) -> float | None:
    """The number in a text, None if there is none."""
    if part.pattern:
        found = re.search(part.pattern, text)
        word = "" if found is None else found[1] or ""
    elif part.column >= 0:
        words = _SEPARATORS.split(text.strip())
        word = words[part.column] if part.column < len(words) else ""
    else:
        word = text
    try:
        return float(word)
    except ValueError:
        return None


def value_of(raw: float | None, part: ProbePart) -> float | None:
    """The value in the probe's unit, None if it is no measurement."""
    if raw is None or raw in part.invalid:
        return None
    value = part.scale * raw + part.offset
    is_low = part.min_value is not None and value < part.min_value
    is_high = part.max_value is not None and value > part.max_value
    return None if is_low or is_high or not abs(value) <= FLOAT32_MAX else value
