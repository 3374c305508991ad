"""Watchdog of the motors: stops them when commands cease.

The gate stops the motors of a running control loop; this stops those of a hung one (in a driver, or the
interpreter). The deadline is cleared only after the motors have stopped: a driver that raises is called
again.
"""

import logging
import threading
from collections.abc import Callable

from companion.hal.background import Background
from companion.hal.interfaces import Motors

_log = logging.getLogger(__name__)

_LOOKS_PER_TIMEOUT = 4.0


class WatchedMotors:
    """Passes commands to the motors, and stops them timeout_s after the last `write`.

    now: the boat's clock. `start` runs the watch in a thread; `watch` is one check.
    """

    def __init__(self, motors: Motors, now: Callable[[], float], timeout_s: float) -> None:
        self.trips = 0  # number of cut-offs
        self.motors = motors
        self._now = now
        self._timeout_s = timeout_s
        self._written_s: float | None = None  # None: stopped
        self._lock = threading.Lock()
        look_s = timeout_s / _LOOKS_PER_TIMEOUT
        self._background = Background(self.watch, "motor watch", retry_s=look_s, longest_retry_s=look_s)

    def start(self) -> None:
        """Begin to watch in a thread."""
        self._background.start()

    def write(self, left: float, right: float) -> None:
        """Drive both motors and restart the deadline."""
        with self._lock:
            drives = bool(left or right)
            if drives:
                self._written_s = self._now()
            self.motors.write(left, right)
            if not drives:
                self._written_s = None

    def stop(self) -> None:
        with self._lock:
            self.motors.stop()
            self._written_s = None

    def close(self) -> None:
        try:
            with self._lock:
                self.motors.close()
                self._written_s = None
        finally:
            self._background.close()

    def watch(self) -> float:
        """Stop motors whose last command is too old; returns the seconds to the next check."""
        with self._lock:
            if self._written_s is not None and self._now() - self._written_s > self._timeout_s:
                self.motors.stop()
                self._written_s = None
                self.trips += 1
                _log.error("motors stopped by the watch: no command for %g s", self._timeout_s)
        return self._timeout_s / _LOOKS_PER_TIMEOUT
