"""Lines for the operator."""

from typing import NamedTuple


class Severity:
    """MAVLink's MAV_SEVERITY, as far as the boat uses it."""

    CRITICAL = 2
    ERROR = 3
    WARNING = 4
    NOTICE = 5
    INFO = 6


class Notice(NamedTuple):
    """One line, and how loud it is."""

    severity: int
    text: str
