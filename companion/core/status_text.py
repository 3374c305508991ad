"""Messages to the operator."""

from typing import Final, NamedTuple


class Severity:
    """The values of MAVLink's MAV_SEVERITY in use."""

    CRITICAL: Final = 2
    ERROR: Final = 3
    WARNING: Final = 4
    NOTICE: Final = 5
    INFO: Final = 6


class StatusText(NamedTuple):
    """A message with its severity."""

    severity: int
    text: str


def one_line(text: str) -> str:
    """The text with a space for each character that is not printable, line ends among them."""
    return "".join(one if one.isprintable() else " " for one in text)
