"""Detects a dead sensor (constant value) and an erratic one (jumps faster than a hull can turn)."""

from typing import Final

from companion.core.units import wrap_pi
from companion.estimation.stuck_value import StuckValueDetector

_LATELY_S: Final = 0.3
_WILD: Final = 0.5  # share of recent jumps that makes it erratic,
_CALM: Final = 0.1  # and good again
_NONE: Final = 1e9  # no reading has this value


class SensorTimeoutMonitor:
    """is_good: no fault is detected."""

    def __init__(self, jump: float, jump_per_s: float, least_s: float) -> None:
        """A change beyond jump + jump_per_s × dt is a jump. least_s: shortest constant run that is a
        fault.
        """
        self.is_good = True
        self._is_erratic = False
        self._repetition = StuckValueDetector()
        self._jump = jump
        self._jump_per_s = jump_per_s
        self._least_s = least_s
        self._jump_share = 0.0
        self._time_s = 0.0
        self._value = _NONE

    @property
    def run_s(self) -> float:
        """Duration of the present constant run."""
        return self._repetition.run_s

    def update(self, value: float, time_s: float) -> bool:
        """Process an angle in rad or a rate in rad/s; returns whether it equals the last value."""
        dt = time_s - self._time_s
        self._time_s = time_s
        change = value - self._value
        self._value = value
        if change == 0.0:
            self._repetition.repeat(time_s)
            if self._repetition.is_unusual(self._least_s):
                self.mark_faulty()
            return True
        self._repetition.change(time_s)
        jump = self._jump + self._jump_per_s * dt
        if self._jump_share > 0.0 or not -jump < change < jump:
            self._update_jumps(abs(wrap_pi(change)) > jump and change > -0.5 * _NONE, dt)
        elif not self.is_good:
            self.is_good = not self._is_erratic
        return False

    def mark_faulty(self) -> None:
        """Mark the sensor as dead until its value changes."""
        self._repetition.is_faulty = True
        self.is_good = False

    def _update_jumps(self, has_jumped: bool, dt: float) -> None:
        self._jump_share += min(dt / _LATELY_S, 1.0) * ((1.0 if has_jumped else 0.0) - self._jump_share)
        if self._jump_share > _WILD:
            self._is_erratic = True
        elif self._jump_share < _CALM:
            self._is_erratic = False
            if self._jump_share < 0.01 * _CALM:
                self._jump_share = 0.0
        self.is_good = not self._is_erratic
