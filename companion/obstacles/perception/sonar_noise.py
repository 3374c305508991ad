"""Detects a noisy ranger: a good one changes little from ping to ping.

Even among rocks most pings of a sweep are near the last one or have no echo; random ranges jump by more than
an eighth of the reach three times out of four.
"""

from typing import Final

from companion.sensors.recurrence import Recurrence

_SHARE: Final = 1.0 / 40.0  # of a ping in the running mean: two and a half seconds at 16 pings a second
_LEAP: Final = 0.125  # of the reach
_TOO_OFTEN: Final = 0.5
_SELDOM: Final = 0.2


class SonarNoiseMonitor:
    """Compares each ping with the last."""

    def __init__(self) -> None:
        self._last_m = 0.0  # 0: no echo
        self._leaps = Recurrence(_SHARE, _TOO_OFTEN, _SELDOM)  # from one echo to another

    @property
    def is_noisy(self) -> bool:
        """Whether the pings are unreliable."""
        return self._leaps.is_often

    def update(self, range_m: float | None, max_range_m: float) -> None:
        """Process the next ping; None: no echo."""
        last_m, self._last_m = self._last_m, range_m or 0.0
        is_leap = last_m > 0.0 < self._last_m and abs(self._last_m - last_m) > _LEAP * max_range_m
        self._leaps.update(is_leap)
