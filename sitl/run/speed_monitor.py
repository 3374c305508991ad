"""Whether the host keeps up with the speed that was asked for.

The emulator skips no tick, so on a busy host simulated time runs slower. That is reported once; the boat
itself cannot notice.
"""

from collections.abc import Callable

WINDOW_S = 5.0  # of wall-clock time; shorter pauses of a busy host even out
SLOW_SHARE = 0.8  # of the speed asked for; above it the voyage takes at most a quarter longer


class SpeedMonitor:
    """Compares simulated time with the clock, window by window, and calls `report` at most once."""

    def __init__(self, speedup: float, report: Callable[[str], None]) -> None:
        """report: called with one line for the user."""
        self._speedup = speedup
        self._report = report
        self._is_reported = False
        self._began_s: float | None = None
        self._simulated_s = 0.0

    def tick(self, now_s: float, tick_s: float) -> None:
        """Another tick of simulated time has passed; now_s: the host's clock."""
        if self._is_reported:
            return
        if self._began_s is None:
            self._began_s = now_s
        self._simulated_s += tick_s
        elapsed_s = now_s - self._began_s
        if elapsed_s < WINDOW_S:
            return
        reached = self._simulated_s / elapsed_s
        if reached < SLOW_SHARE * self._speedup:
            self._is_reported = True
            self._report(
                f"this computer is too slow or too busy for {self._speedup:g} × real time: simulated time "
                f"runs at {reached:.2g} × and everything takes longer; the boat itself is not affected"
            )
        self._began_s, self._simulated_s = now_s, 0.0
