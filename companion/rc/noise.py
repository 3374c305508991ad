"""Whether a receiver talks nonsense: no hand throws most of the channels about from one frame to the next."""

from typing import Final

from companion.sensors.recurrence import Recurrence

_LEAP_US: Final = 250
_SHARE: Final = 1.0 / 16.0  # of a frame in the running mean: a third of a second at 50 frames a second
_TOO_OFTEN: Final = 0.4
_SELDOM: Final = 0.1


class RcNoise:
    """leaps: this frame is not to be believed, whatever the others were like."""

    __slots__ = ("_channels_us", "_often", "leaps")

    def __init__(self) -> None:
        self.leaps = False
        self._channels_us: tuple[int, ...] = ()
        self._often = Recurrence(_SHARE, _TOO_OFTEN, _SELDOM)

    @property
    def is_noisy(self) -> bool:
        """Whether no frame is to be believed."""
        return self._often.is_often

    def update(self, channels_us: tuple[int, ...]) -> None:
        """Take the next frame."""
        before_us, self._channels_us = self._channels_us, channels_us
        moved = 0
        for now_us, then_us in zip(channels_us, before_us, strict=False):
            moved += abs(now_us - then_us) > _LEAP_US
        self.leaps = 2 * moved > len(channels_us)
        self._often.update(self.leaps)
