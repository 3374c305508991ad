"""Detects a sensor that repeats one value for longer than it ever has.

Noise changes most readings; a sensor with coarse resolution repeats its value while nothing moves. The
longest run that ended by itself is learned.
"""

import math
from typing import Final

_PATIENCE: Final = 4.0  # times the longest run so far
_ENOUGH: Final = 20  # changes before the longest run is known


class StuckValueDetector:
    """run_s: duration of the present run of equal values; is_faulty: the run counts as a fault."""

    def __init__(self) -> None:
        self.run_s = 0.0
        self.is_faulty = False
        self._since_s = math.inf
        self._longest_s = 0.0
        self._changes = 0

    def repeat(self, time_s: float) -> None:
        """The value equals the last one."""
        self.run_s = max(time_s - self._since_s, 0.0)

    def change(self, time_s: float) -> None:
        """The value has changed."""
        self._since_s = time_s
        if self.run_s == 0.0 and not self.is_faulty:
            self._changes += 1
            return
        if self.is_faulty:
            self.is_faulty = False
        else:
            self._longest_s = max(self._longest_s, self.run_s)
            self._changes += 1
        self.run_s = 0.0

    def is_unusual(self, least_s: float) -> bool:
        """Whether the run is longer than least_s and than usual for this sensor."""
        if self.run_s < least_s or self._changes < _ENOUGH:
            return False
        return self.run_s > _PATIENCE * self._longest_s
