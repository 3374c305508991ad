"""Whether a ranger talks nonsense: one that is well hears much the same from ping to ping.

Even among rocks most pings of a sweep are near the one before, or hear nothing; random ranges leap by more
than an eighth of the reach three times out of four.
"""

from typing import Final

_SHARE: Final = 1.0 / 40.0  # of a ping in the running mean: two and a half seconds at 16 pings a second
_LEAP: Final = 0.125  # of the reach
_TOO_OFTEN: Final = 0.5
_SELDOM: Final = 0.2


class Babble:
    """is_babbling: the pings are not to be believed."""

    __slots__ = ("_last_m", "_leaps", "is_babbling")

    def __init__(self) -> None:
        self.is_babbling = False
        self._last_m = 0.0  # 0: silence
        self._leaps = 0.0  # running share of pings that leap from one echo to another

    def update(self, range_m: float | None, max_range_m: float) -> None:
        """Take the next ping; None heard nothing."""
        last_m, self._last_m = self._last_m, range_m or 0.0
        is_leap = last_m > 0.0 < self._last_m and abs(self._last_m - last_m) > _LEAP * max_range_m
        self._leaps += _SHARE * (is_leap - self._leaps)
        if self._leaps > _TOO_OFTEN:
            self.is_babbling = True
        elif self._leaps < _SELDOM:
            self.is_babbling = False
