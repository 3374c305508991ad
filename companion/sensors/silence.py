"""Silent parts: what they measured last is no reading, and the operator is told."""

from typing import Protocol, TypeVar, runtime_checkable

from companion.core.readings import Reading
from companion.core.status_text import Severity, StatusText

R = TypeVar("R", bound=Reading)


def fresh(reading: R | None, timeout_s: float, now_s: float) -> R | None:
    """The reading, None once it is older than the part's timeout_s: drivers repeat their latest one."""
    return None if reading is None or now_s - reading.time_s > timeout_s else reading


@runtime_checkable
class LatePart(Protocol):
    """A part that may open later, and tells by itself that it is missing."""

    @property
    def is_open(self) -> bool: ...  # whether it has been opened


class SilenceMonitor:
    """Tells once that a part is silent, and once that it measures again. A missing part is not silent."""

    def __init__(self, name: str, part: object = None, again: str = "measures again") -> None:
        """part: asked whether it is open yet, if it is a `LatePart`."""
        self._name, self._again = name, again
        self._part = part if isinstance(part, LatePart) else None
        self._began_s: float | None = None
        self._is_silent = False

    def update(
        self, timeout_s: float, now_s: float, *, is_heard: bool, what: str = "is silent"
    ) -> StatusText | None:
        """is_heard: there is a fresh reading. timeout_s: that long after the start a part may give none."""
        if self._part is not None and not self._part.is_open:
            return None
        if self._began_s is None:
            self._began_s = now_s
        was_silent, self._is_silent = self._is_silent, not is_heard and now_s - self._began_s > timeout_s
        if self._is_silent is was_silent:
            return None
        if self._is_silent:
            return StatusText(Severity.WARNING, f"{self._name} {what}")
        return StatusText(Severity.NOTICE, f"{self._name} {self._again}")
