"""The one place, with runner.py, where a clock is read."""

import time
from typing import Protocol


class Clock(Protocol):
    """Time as the boat counts it, and a way to wait."""

    def now_s(self) -> float:
        """Seconds since boot; never goes back."""

    def sleep(self, seconds: float) -> None:
        """Wait these seconds."""


class SystemClock:
    """Monotonic seconds since the clock was made."""

    def __init__(self) -> None:
        self._start_s = time.monotonic()

    def now_s(self) -> float:
        """Seconds since the clock was made."""
        return time.monotonic() - self._start_s

    def sleep(self, seconds: float) -> None:
        """Wait; a time in the past is no wait."""
        if seconds > 0.0:
            time.sleep(seconds)

    def unix_offset_s(self) -> float:
        """What to add to `now_s` for the date; 0 while the computer's own date is plainly unset."""
        unix_s = time.time()
        return unix_s - self.now_s() if unix_s > 1.6e9 else 0.0
