"""Motors that stop by themselves when nobody commands them any more.

The gate stops the motors of a boat that thinks; this stops those of one that does not: a control loop that
hangs in a driver, or in the interpreter's own troubles, must not leave the propellers turning. A deadline is
dropped only after the motors have stopped: a driver that raises while it stops them is asked again.
"""

import logging
import threading
from collections.abc import Callable

from companion.hal.background import Background
from companion.hal.interfaces import Motors

_log = logging.getLogger(__name__)

_LOOKS_PER_TIMEOUT = 4.0


class WatchedMotors:
    """Hands everything on to the real motors, and stops them timeout_s after the last `write`.

    now: the boat's clock. The watch runs in a thread of its own once `start` is called; `watch` is one look.
    """

    def __init__(self, motors: Motors, now: Callable[[], float], timeout_s: float) -> None:
        self.trips = 0  # how often the watch had to stop the motors
        self._motors = motors
        self._now = now
        self._timeout_s = timeout_s
        self._written_s: float | None = None  # None: stopped, nothing to watch
        self._lock = threading.Lock()
        look_s = timeout_s / _LOOKS_PER_TIMEOUT
        self._background = Background(self.watch, "motor watch", retry_s=look_s, longest_retry_s=look_s)

    def start(self) -> None:
        """Begin to watch."""
        self._background.start()

    def write(self, left: float, right: float) -> None:
        """Drive both motors, and wind the watch up."""
        with self._lock:
            drives = bool(left or right)
            if drives:
                self._written_s = self._now()
            self._motors.write(left, right)
            if not drives:
                self._written_s = None

    def stop(self) -> None:
        """Cut both motors now."""
        with self._lock:
            self._motors.stop()
            self._written_s = None

    def close(self) -> None:
        """Stop first, then let the part go. May be called twice."""
        try:
            with self._lock:
                self._motors.close()
                self._written_s = None
        finally:
            self._background.close()

    def watch(self) -> float:
        """Stop motors whose last command is too old; seconds until the next look."""
        with self._lock:
            if self._written_s is not None and self._now() - self._written_s > self._timeout_s:
                self._motors.stop()
                self._written_s = None
                self.trips += 1
                _log.error("motors stopped by the watch: no command for %g s", self._timeout_s)
        return self._timeout_s / _LOOKS_PER_TIMEOUT
