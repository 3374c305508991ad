"""Detects a noisy RC receiver: most channels jump from one frame to the next, which no hand does."""

from typing import Final

from companion.sensors.recurrence import Recurrence

_LEAP_US: Final = 250
_SHARE: Final = 1.0 / 16.0  # of a frame in the running mean: a third of a second at 50 frames a second
_TOO_OFTEN: Final = 0.4
_SELDOM: Final = 0.1


class RcNoise:
    """leaps: the latest frame alone is implausible."""

    def __init__(self) -> None:
        self.leaps = False
        self._channels_us: tuple[int, ...] = ()
        self._often = Recurrence(_SHARE, _TOO_OFTEN, _SELDOM)

    @property
    def is_noisy(self) -> bool:
        """Whether implausible frames are so frequent that none is used."""
        return self._often.is_often

    def update(self, channels_us: tuple[int, ...]) -> None:
        """Check the next frame."""
        before_us, self._channels_us = self._channels_us, channels_us
        moved = 0
        for now_us, then_us in zip(channels_us, before_us, strict=False):
            moved += abs(now_us - then_us) > _LEAP_US
        self.leaps = 2 * moved > len(channels_us)
        self._often.update(self.leaps)
