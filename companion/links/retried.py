"""A part or port that may not be there yet: opened in a thread, and tried again until it opens."""

import threading
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import Future, wait
from typing import Any, Final, Generic, NamedTuple, Self, TypeVar

from companion.core.drain import drain
from companion.core.errors import ConfigError
from companion.core.status_text import Severity, StatusText
from companion.links.interfaces import Closable, Link, Port


class Backoff:
    """Delays that double from first_s to longest_s. Time is an argument."""

    def __init__(self, first_s: float = 0.5, longest_s: float = 8.0) -> None:
        self._first_s = first_s
        self._longest_s = longest_s
        self._delay_s = first_s
        self._due_s = float("-inf")

    def is_due(self, now_s: float) -> bool:
        """Whether the next attempt is due."""
        return now_s >= self._due_s

    def failed(self, now_s: float = 0.0) -> float:
        """Schedule the next attempt; returns the delay in seconds."""
        delay_s = self._delay_s
        self._due_s = now_s + delay_s
        self._delay_s = min(2.0 * delay_s, self._longest_s)
        return delay_s

    def succeeded(self) -> None:
        """Reset to the shortest delay."""
        self._delay_s = self._first_s
        self._due_s = float("-inf")


Opened = TypeVar("Opened", bound=Closable)


class Pace(NamedTuple):
    """Delays between attempts, from the first to the longest, and how long a start waits for the first."""

    first_s: float = 0.5
    longest_s: float = 8.0
    # Ports and buses open in milliseconds; what hangs joins the running boat. Motors, parts and links are
    # awaited one after the other: with 0.9 s for the imports a station is answered within 2 s.
    start_s: float = 0.3


PACE: Final = Pace()


class Retried(Generic[Opened]):
    """Opens something in a thread of its own. Its texts tell the first failure, and the success after it.

    opened: None until then. fault: why it is not open, empty once it is; error: of the last attempt. first:
    done after the first attempt; a ConfigError is its exception, and ends the attempts.
    """

    def __init__(self, name: str, open_it: Callable[[], Opened], pace: Pace = PACE) -> None:
        self.name = name
        self.opened: Opened | None = None
        self.fault = "not open yet"
        self.error: Exception | None = None
        self.first: Future[None] = Future()
        self._open = open_it
        self._backoff = Backoff(pace.first_s, pace.longest_s)
        self._has_failed = False
        self._texts: deque[StatusText] = deque()
        self._stop = threading.Event()
        self._lock = threading.Lock()
        self._thread = threading.Thread(target=self._run, name=f"open {name}", daemon=True)

    def start(self) -> Self:
        """Begin to try."""
        self._thread.start()
        return self

    def attempt(self) -> float:
        """Try once; returns the seconds to the next attempt, 0 once open.
        Raises ConfigError: it can never open.
        """
        try:
            opened = self._open()
        except Exception as error:  # a part's library may raise anything
            self.error = error
            self.fault = str(error).removeprefix(f"{self.name}: ") or type(error).__name__
            if not self._has_failed:
                self._has_failed = True
                self._texts.append(StatusText(Severity.WARNING, f"{self.name}: {self.fault}"))
            if isinstance(error, ConfigError):
                raise
            return self._backoff.failed()
        with self._lock:
            if self._stop.is_set():
                opened.close()
                return 0.0
            self.opened = opened
        self.fault = ""
        if self._has_failed:
            self._texts.append(StatusText(Severity.NOTICE, f"{self.name}: opened"))
        return 0.0

    @property
    def is_open(self) -> bool:
        return self.opened is not None

    def take_texts(self) -> list[StatusText]:
        return drain(self._texts)

    def close(self) -> None:
        """End the attempts, and close what is open. May be called twice."""
        self._stop.set()
        with self._lock:
            opened = self.opened
        if opened is not None:
            opened.close()

    def _run(self) -> None:
        wait_s = 0.0
        while not self._stop.wait(wait_s):
            try:
                wait_s = self.attempt()
            except ConfigError as error:
                if not self.first.done():
                    self.first.set_exception(error)
                return
            if not self.first.done():
                self.first.set_result(None)
            if not wait_s:
                return


class RetriedPort(Retried[Port]):
    """Satisfies `companion.links.interfaces.Port`. name: the url, with the port that the system chose."""

    def accept(self) -> list[Link]:
        """New links since the last call."""
        return [] if self.opened is None else self.opened.accept()

    def fileno(self) -> int:
        """A descriptor to wait on for new links, −1 without one."""
        return -1 if self.opened is None else self.opened.fileno()


def await_first(parts: Sequence[Retried[Any]], pace: Pace) -> None:
    """Wait for the first attempt of each, no longer than a start may take.
    Raises ConfigError: one of them can never open.
    """
    for first in wait([part.first for part in parts], pace.start_s).done:
        first.result()
