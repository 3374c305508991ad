"""Arguments that typer does not know: positions, and a --start that means two things."""

import re
from collections.abc import Sequence

from companion.core.geo import LatLon
from mission_tools.errors import UsageError

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)"
_POSITION = re.compile(rf"\s*({_NUMBER})\s*,\s*({_NUMBER})\s*", re.ASCII)


def with_start_position_option(arguments: Sequence[str]) -> list[str]:
    """`--start LAT,LON` names a place and becomes `--start-at LAT,LON`; a bare `--start` stays."""
    told: list[str] = []
    for index, argument in enumerate(arguments):
        following = arguments[index + 1] if index + 1 < len(arguments) else ""
        if argument == "--start" and _POSITION.fullmatch(following):
            told.append("--start-at")
        elif argument.startswith("--start="):
            told.append(argument.replace("--start=", "--start-at=", 1))
        else:
            told.append(argument)
    return told


def position(option: str, text: str | None) -> LatLon | None:
    """Read LAT,LON in decimal degrees; None stays None.

    Raises:
        UsageError: names the option and what is wrong.
    """
    if text is None:
        return None
    match = _POSITION.fullmatch(text)
    if match is None:
        raise UsageError(f"{option} '{text}': expected LAT,LON in decimal degrees, such as 50.0012,-1.2034")
    try:
        return LatLon(float(match[1]), float(match[2]))
    except ValueError as error:
        raise UsageError(f"{option} '{text}': {error}; expected LAT,LON") from None
