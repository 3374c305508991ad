"""What no filter sees: a sensor that repeats its value bit by bit.

Noise changes most readings; a sensor with coarse resolution repeats its value while nothing moves. A run of
equal values is a fault if the boat has moved meanwhile, or if it is longer than any that ended by itself.
"""

import math
from typing import Final

STUCK_S: Final = 1.0  # shorter runs are no fault: slow parts repeat a value until the next one
_PATIENCE: Final = 4.0  # times the longest run so far
_ENOUGH: Final = 20  # changes before the longest run is known


class SensorMonitor:
    """run_s: duration of the present run of equal values. is_stuck: it is a fault."""

    __slots__ = ("_changes", "_longest_s", "_moved", "_since_s", "_value", "is_stuck", "run_s")

    def __init__(self) -> None:
        self._since_s = -math.inf
        self.run_s = self._longest_s = self._moved = 0.0
        self.is_stuck = False
        self._changes = 0
        self._value: object = None

    def update(self, value: object, time_s: float, moved: float) -> bool:
        """Process a reading; returns whether the sensor is good.

        moved: by how much the value should have changed since the last reading, in shares of what is
        certain to show.
        """
        if value != self._value:
            if self.run_s > self._longest_s and not self.is_stuck:
                self._longest_s = self.run_s
            self._changes += 1
            self._value, self._since_s = value, time_s
            self.run_s = self._moved = 0.0
            self.is_stuck = False
            return True
        self.run_s = time_s - self._since_s
        self._moved += moved
        if self.run_s >= STUCK_S and not self.is_stuck:
            is_unusual = self._changes >= _ENOUGH and self.run_s > _PATIENCE * self._longest_s
            self.is_stuck = is_unusual or self._moved > 1.0
        return not self.is_stuck
