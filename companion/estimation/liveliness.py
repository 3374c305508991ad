"""Whether a stream of numbers can be a turning hull's: neither dead nor wild.

A dead sensor says the same again and again; a broken one leaps about as no hull can turn.
"""

from typing import Final

from companion.estimation.repetition import Repetition
from companion.units import wrap_pi

_WILD: Final = 0.5  # share of the last second's leaps that is too much
_CALM: Final = 0.1  # and all is well again


class Liveliness:
    """is_dead and is_wild say what is wrong; is_good that nothing is."""

    __slots__ = ("_leap", "_leap_per_s", "_leaps", "_least_s", "_time_s", "_value", "is_wild", "repetition")

    def __init__(self, leap: float, leap_per_s: float, least_s: float) -> None:
        """A change by more than leap + leap_per_s × time is none. least_s: so long the same is dead."""
        self.is_wild = False
        self.repetition = Repetition()
        self._leap = leap
        self._leap_per_s = leap_per_s
        self._least_s = least_s
        self._leaps = 0.0
        self._time_s = 0.0
        self._value = 1e9  # no reading is this

    @property
    def is_dead(self) -> bool:
        """The same reading for too long."""
        return self.repetition.is_condemned

    @property
    def is_good(self) -> bool:
        """Alive and sane."""
        return not (self.is_wild or self.repetition.is_condemned)

    def update(self, value: float, time_s: float) -> bool:
        """Take an angle in rad, or a rate in rad/s; whether it is exactly the last one."""
        dt = time_s - self._time_s
        self._time_s = time_s
        is_same = value == self._value
        if not is_same and self._value < 1e9:
            has_leapt = abs(wrap_pi(value - self._value)) > self._leap + self._leap_per_s * dt
            if has_leapt or self._leaps > 0.0:
                self._leaps += min(dt, 1.0) * ((1.0 if has_leapt else 0.0) - self._leaps)
                if self._leaps > _WILD:
                    self.is_wild = True
                elif self._leaps < _CALM:
                    self.is_wild = False
        self._value = value
        repetition = self.repetition
        repetition.update(is_same, time_s)
        if is_same and repetition.is_unusual(self._least_s):
            repetition.is_condemned = True
        return is_same
