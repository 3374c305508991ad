"""Motors that stop by themselves when nobody commands them any more.

The gate stops the motors of a boat that thinks; this stops those of one that does not: a control loop that
hangs in a driver, or in the interpreter's own troubles, must not leave the propellers turning.
"""

import threading
from collections.abc import Callable

from companion.hal.background import Background
from companion.hal.interfaces import Motors

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
        self._background = Background(self.watch, "motor watch")

    def start(self) -> None:
        """Begin to watch."""
        self._background.start()

    def write(self, left: float, right: float) -> None:
        """Drive both motors, and wind the watch up."""
        with self._lock:
            self._written_s = self._now() if left or right else None
            self._motors.write(left, right)

    def stop(self) -> None:
        """Cut both motors now."""
        with self._lock:
            self._written_s = None
            self._motors.stop()

    def close(self) -> None:
        """Stop first, then let the part go. May be called twice."""
        with self._lock:
            self._written_s = None
            self._motors.close()
        self._background.close()

    def watch(self) -> float:
        """Stop motors whose last command is too old; seconds until the next look."""
        with self._lock:
            if self._written_s is not None and self._now() - self._written_s > self._timeout_s:
                self.trips += 1
                self._written_s = None
                self._motors.stop()
        return self._timeout_s / _LOOKS_PER_TIMEOUT
