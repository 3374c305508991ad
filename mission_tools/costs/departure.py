"""When a voyage begins, and how times are said.

There is one clock, that of the current: seconds since 1970 (POSIX, UTC) where its file has dates, and the
file's own seconds where it has not.
"""

import math
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import NamedTuple

from mission_tools.errors import UsageError
from mission_tools.wording import duration

FORMS = "2026-06-01T08:00Z, seconds of the current's file, or two of either joined by .. for a window"


def posix_s(text: str) -> float:
    """Seconds since 1970 of an ISO 8601 time, UTC without a zone. Raises ValueError: it is none."""
    at = datetime.fromisoformat(text.strip())
    return (at if at.tzinfo else at.replace(tzinfo=UTC)).timestamp()


class KnownTimes(NamedTuple):
    """For when a current that changes is known; before and after it stays as it is then.

    On its clock: seconds since 1970 (UTC) if is_dated, else of its file.
    """

    first_s: float = -math.inf
    last_s: float = math.inf
    is_dated: bool = False

    def note(self, depart_s: float, arrive_s: float) -> tuple[str, ...]:
        """What to say of a voyage that goes beyond them; nothing of one that does not."""
        if self.first_s <= depart_s and arrive_s <= self.last_s:
            return ()
        known = " to ".join(time_said(at_s, is_dated=self.is_dated) for at_s in self[:2])
        return (f"the current is known from {known} only: beyond, it counts as it is then",)


@dataclass(frozen=True, slots=True)
class Departure:
    """From begin_s to latest_s, on the current's clock."""

    begin_s: float = 0.0
    latest_s: float = 0.0
    is_dated: bool = False

    @property
    def is_window(self) -> bool:
        """Whether the best of several is asked for."""
        return self.latest_s > self.begin_s

    @classmethod
    def of(cls, text: str | None, times: KnownTimes | None) -> "Departure":
        """What --depart says in a current, else the zero of its clock. Raises UsageError: they do not go
        together, or a current with dates needs a departure.
        """
        if text is None:
            if times is None or not times.is_dated:
                return cls()
            known = f" ({iso(times.first_s)} to {iso(times.last_s)})" if math.isfinite(times.last_s) else ""
            raise UsageError(f"--current: it changes with time{known}: add --depart 2026-06-01T08:00Z")
        found = cls.parsed(text)
        if times is not None and times.is_dated != found.is_dated:
            expected = (
                "a date such as 2026-06-01T08:00Z" if times.is_dated else "seconds on the clock of its file"
            )
            raise UsageError(f"--depart {text}: expected {expected}, as --current has them")
        if found.is_window and times is None:
            raise UsageError(f"--depart {text}: no departure is better: the current does not change")
        return found

    @classmethod
    def parsed(cls, text: str) -> "Departure":
        """What --depart says. Raises UsageError: no time, or a window that ends before it begins."""
        first, _, last = text.partition("..")
        try:
            begin_s, is_dated = _time(first)
            latest_s, is_last_dated = _time(last or first)
        except ValueError:
            raise UsageError(f"--depart {text}: expected {FORMS}") from None
        if is_dated != is_last_dated or latest_s < begin_s:
            raise UsageError(
                f"--depart {text}: expected two dates, or two numbers, of which the later is last"
            )
        return cls(begin_s, latest_s, is_dated)


def _time(text: str) -> tuple[float, bool]:
    try:
        time_s = float(text)
    except ValueError:
        return posix_s(text), True
    if not math.isfinite(time_s):
        raise ValueError
    return time_s, False


def time_said(time_s: float, *, is_dated: bool) -> str:
    """A time for people: 2026-06-01 08:00Z, or after how long on a clock without dates."""
    if not is_dated:
        return duration(time_s)
    return f"{datetime.fromtimestamp(round(time_s / 60.0) * 60.0, UTC):%Y-%m-%d %H:%M}Z"


def iso(time_s: float) -> str:
    """A date for programs, in UTC."""
    return f"{datetime.fromtimestamp(round(time_s), UTC):%Y-%m-%dT%H:%M:%SZ}"
