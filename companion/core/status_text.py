"""Lines for the operator."""

from typing import Final, NamedTuple


class Severity:
    """MAVLink's MAV_SEVERITY, as far as the boat uses it."""

    CRITICAL: Final = 2
    ERROR: Final = 3
    WARNING: Final = 4
    NOTICE: Final = 5
    INFO: Final = 6


class StatusText(NamedTuple):
    """One line, and how loud it is."""

    severity: int
    text: str
