"""What no filter sees: a sensor that repeats its value bit by bit, and one that reports values at random.

Noise changes most readings; a sensor with coarse resolution repeats its value while nothing moves. A run of
equal values is a fault if the boat has moved meanwhile, or if it is longer than any that ended by itself.
"""

import math
from typing import Final

from companion.core.units import wrap_pi

STUCK_S: Final = 1.0  # shorter runs are no fault: slow parts repeat a value until the next one
_PATIENCE: Final = 4.0  # times the longest run so far
_ENOUGH: Final = 20  # changes before the longest run is known
ERRATIC_S: Final = 0.3  # two jumps within this: a sensor that is wrong once jumps there and back, at once


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


class JumpMonitor:
    """is_erratic: the latest values jump faster than the hull can turn."""

    __slots__ = ("_jump", "_jump_per_s", "_jumped_s", "_time_s", "_until_s", "_value", "is_erratic")

    def __init__(self, jump: float, jump_per_s: float) -> None:
        """A change beyond jump + jump_per_s × dt is a jump."""
        self.is_erratic = False
        self._jump, self._jump_per_s, self._value = jump, jump_per_s, 0.0
        self._time_s = self._jumped_s = self._until_s = -math.inf

    def update(self, value: float, time_s: float) -> bool:
        """Process an angle in rad, or a rate in rad/s; whether it jumped. None jumps by more than π."""
        change, dt = value - self._value, time_s - self._time_s
        has_jumped = abs(change) > self._jump and abs(wrap_pi(change)) > self._jump + self._jump_per_s * dt
        if has_jumped:
            if time_s - self._jumped_s < ERRATIC_S:
                self._until_s = time_s + ERRATIC_S
            self._jumped_s = time_s
        self._time_s, self._value = time_s, value
        self.is_erratic = time_s < self._until_s
        return has_jumped
