"""A sensor that says the same again and again: its habit, or has it stopped?

Noise makes most sensors say something new each time; a coarse one repeats itself while nothing moves. What is
usual is learned: runs of equal readings that ended by themselves.
"""

import math
from typing import Final

_PATIENCE: Final = 4.0  # times the longest run so far
_ENOUGH: Final = 20  # changes, before the habit counts as known


class StuckValueDetector:
    """run_s is for how long the reading has been the same; is_condemned: that run is no habit but a fault."""

    __slots__ = ("_changes", "_longest_s", "_since_s", "is_faulty", "run_s")

    def __init__(self) -> None:
        self.run_s = 0.0
        self.is_faulty = False
        self._since_s = math.inf
        self._longest_s = 0.0
        self._changes = 0

    def repeat(self, time_s: float) -> None:
        """The reading is exactly what the last one was."""
        self.run_s = max(time_s - self._since_s, 0.0)

    def change(self, time_s: float) -> None:
        """It is another one."""
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
        """Whether it has gone on for longer than this part has ever done, and for least_s."""
        if self.run_s < least_s or self._changes < _ENOUGH:
            return False
        return self.run_s > _PATIENCE * self._longest_s
