"""Notices that a part has fallen silent."""

from companion.core.status_text import Severity, StatusText


class SilenceMonitor:
    """Tells once that a part is silent, and once that it measures again.

    timeout_s: the longest time between two readings, several of the part's periods.
    """

    def __init__(self, name: str, timeout_s: float) -> None:
        self._name = name
        self._timeout_s = timeout_s
        self._began_s: float | None = None
        self._is_silent = False

    def update(self, reading_s: float | None, now_s: float) -> StatusText | None:
        """reading_s: the time of the latest reading, None before the first."""
        if self._began_s is None:
            self._began_s = now_s
        latest_s = self._began_s if reading_s is None else reading_s
        was_silent, self._is_silent = self._is_silent, now_s - latest_s > self._timeout_s
        if self._is_silent is was_silent:
            return None
        if self._is_silent:
            return StatusText(Severity.WARNING, f"{self._name} is silent")
        return StatusText(Severity.NOTICE, f"{self._name} measures again")
