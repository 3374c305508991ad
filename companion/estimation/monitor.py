"""What no filter sees: a sensor that repeats its value bit by bit, or is silent time and again.

Noise changes most readings; a sensor with coarse resolution repeats its value while nothing moves. A run of
equal values is a fault if the boat has moved meanwhile, or if it is longer than any that ended by itself.

The gaps of a loose contact are a Poisson process of a higher rate than those of a sound one: a CUSUM (E. S.
Page, Biometrika 41, 1954) gains ln(λ₁/λ₀) by each gap and loses λ₁ a second.
"""

import math
from typing import Final

from companion.core.evidence import FADE_S
from companion.estimation.delay import PAUSE_S, THRESHOLD

STUCK_S: Final = 1.0  # shorter runs are no fault: slow parts repeat a value until the next one
_PATIENCE: Final = 4.0  # times the longest run so far
_ENOUGH: Final = 20  # changes before the longest run is known
# Seconds without a gap that outweigh one: λ₁ is FADE_S, λ₀ one gap an hour
_GAP_S: Final = math.log(FADE_S * 3600.0) / FADE_S
_PROVED_S: Final = THRESHOLD / FADE_S


class SensorMonitor:
    """run_s: duration of the present run of equal values. is_stuck: it is a fault.

    intermittent_until_s: when a loose contact is over, unless another gap follows.
    """

    __slots__ = (
        "_changes", "_gone_s", "_heard_s", "_longest_s", "_moved", "_pause_s", "_since_s", "_value",
        "intermittent_until_s", "is_stuck", "run_s",
    )  # fmt: skip

    def __init__(self) -> None:
        self._since_s = self._heard_s = self._gone_s = self.intermittent_until_s = -math.inf
        self._pause_s = math.inf
        self.run_s = self._longest_s = self._moved = 0.0
        self.is_stuck = False
        self._changes = 0
        self._value: object = None

    def update(self, value: object, time_s: float, moved: float) -> bool:
        """Process a reading; returns whether the sensor is good.

        moved: by how much the value should have changed since the last reading, in shares of what is
        certain to show.
        """
        before_s, self._pause_s = self._pause_s, time_s - self._heard_s
        self._heard_s = time_s
        if PAUSE_S < self._pause_s - before_s < math.inf:
            self._gone_s = max(self._gone_s, time_s) + _GAP_S
            if self._gone_s - time_s >= _PROVED_S:
                self.intermittent_until_s = self._gone_s = time_s + _PROVED_S
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
