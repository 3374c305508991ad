"""Arguments that argparse does not know: positions, and a --start that means two things."""

import json
import logging
import re
import sys
from argparse import Namespace
from collections.abc import Callable, Mapping, Sequence

from companion.cli.parser import Parser
from companion.cli.program_end import end_with
from companion.core.errors import BoatError
from companion.core.geo import LatLon
from mission_tools.errors import MissionToolsError, UsageError

_NUMBER = r"(?:\d+\.?\d*|\.\d+)"
_SIGNED = re.compile(rf"[+-]?{_NUMBER}", re.ASCII)
_MARKS = str.maketrans(dict.fromkeys("°º'’′\"”″:", " "))  # of degrees, minutes and seconds
_ANGLE = rf"[+-]?{_NUMBER}(?:\s+{_NUMBER}){{0,2}}"
_LETTERED = re.compile(rf"([NS])\s*({_ANGLE})\s*[,;]?\s*([EW])\s*({_ANGLE})", re.ASCII)
_LETTERS_BEHIND = re.compile(rf"({_ANGLE})\s*([NS])\s*[,;]?\s*({_ANGLE})\s*([EW])", re.ASCII)
_PLAIN = re.compile(rf"({_ANGLE})\s*[,;]\s*({_ANGLE})|([+-]?{_NUMBER})\s+([+-]?{_NUMBER})", re.ASCII)
_FORMS = "LAT,LON in degrees, such as 50.0012,-1.2034 or \"50°00.072'N 1°12.204'W\""
_PLACES = frozenset(
    ("--start", "--start-at", "--goal", "--via", "--follow-shore", "--first", "--last", "--seed", "--land")
)


def with_places(arguments: Sequence[str]) -> list[str]:
    """The arguments with each place in one: `--goal 50.0 -1.2` becomes `--goal 50.0,-1.2`. `--start LAT,LON`
    names a place and becomes `--start-at LAT,LON`; a bare `--start` stays.
    """
    told: list[str] = []
    rest = list(arguments)
    while rest:
        argument = rest.pop(0)
        is_pair = len(rest) > 1 and all(_SIGNED.fullmatch(text) for text in rest[:2])
        if argument in _PLACES and is_pair:
            rest[:2] = [",".join(rest[:2])]
        if argument == "--start" and rest and _is_meant_as_place(rest[0]):
            argument = "--start-at"
        elif argument.startswith("--start="):
            argument = argument.replace("--start=", "--start-at=", 1)
        told.append(argument)
    return told


def _is_meant_as_place(text: str) -> bool:
    try:
        return _degrees(text) is not None
    except ValueError:
        return True


def position(option: str, text: str | None) -> LatLon | None:
    """Read LAT,LON in degrees, with minutes and seconds or without; None stays None. Raises UsageError: names
    the option and what is wrong.
    """
    if text is None:
        return None
    try:
        found = _degrees(text)
        if found is not None:
            return LatLon(*found)
    except ValueError as error:
        raise UsageError(f"{option} '{text}': {error}; expected LAT,LON") from None
    raise UsageError(f"{option} '{text}': expected {_FORMS}")


def _degrees(text: str) -> tuple[float, float] | None:
    """Latitude and longitude of a text; None if it is no place. Raises ValueError: minutes or seconds of 60
    or more, or a fraction before the last part.
    """
    plain = " ".join(text.translate(_MARKS).upper().split())
    if match := _LETTERED.fullmatch(plain):
        north, lat, east, lon = match.groups()
    elif match := _LETTERS_BEHIND.fullmatch(plain):
        lat, north, lon, east = match.groups()
    elif match := _PLAIN.fullmatch(plain):
        lat, lon = (found for found in match.groups() if found is not None)
        return _angle_deg(lat), _angle_deg(lon)
    else:
        return None
    return _angle_deg(lat) * (-1 if north == "S" else 1), _angle_deg(lon) * (-1 if east == "W" else 1)


def _angle_deg(text: str) -> float:
    """Degrees, minutes and seconds, parted by spaces."""
    parts = text.split()
    values = [abs(float(part)) for part in parts]
    if any(value >= 60.0 for value in values[1:]):
        raise ValueError(f"'{text}' has minutes or seconds of 60 or more")
    if any(not value.is_integer() for value in values[:-1]):
        raise ValueError(f"'{text}' has a fraction before its last part")
    total = sum(value / 60.0**power for power, value in enumerate(values))
    return -total if text.startswith("-") else total


def run_parsed(parser: Parser, arguments: Sequence[str], work: Callable[[Namespace], int | None]) -> int:
    """Parse, do the work, and return the exit code. Without arguments the help is printed.

    work: takes what was given; None stands for exit code 0.
    """
    if not arguments:
        parser.print_help(sys.stderr)
        return 2
    try:
        given = parser.read(arguments)
        if given.debug:
            logging.basicConfig(level=logging.DEBUG, stream=sys.stderr)
        return work(given) or 0
    except SystemExit as done:  # --help and --version
        return done.code if isinstance(done.code, int) else 0
    except (KeyboardInterrupt, Exception) as error:
        return end_with(error, parser.prog, arguments, (MissionToolsError, BoatError))


def print_json(tree: Mapping[str, object], indent: int | None = 2) -> None:
    sys.stdout.write(json.dumps(tree, indent=indent) + "\n")
