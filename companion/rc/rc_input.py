"""The RC receiver's state: the transmitter's sticks, and whether it is received.

A receiver is noisy if most channels jump from one frame to the next, which no hand does.
"""

import math
from typing import Final

from companion.config.tuning import Rc
from companion.core.readings import RcReading
from companion.rc.pulses import deflection, is_pulse
from companion.sensors.recurrence import Recurrence

_LEAP_US: Final = 250
_SHARE: Final = 1.0 / 16.0  # of a frame in the running mean: a third of a second at 50 frames a second
_TOO_OFTEN: Final = 0.4
_SELDOM: Final = 0.1


class RcNoise:
    """leaps: the latest frame alone is implausible. often: such frames are so frequent that none is used."""

    def __init__(self) -> None:
        self.leaps = False
        self._channels_us: tuple[int, ...] = ()
        self.often = Recurrence(_SHARE, _TOO_OFTEN, _SELDOM)

    def update(self, channels_us: tuple[int, ...]) -> None:
        """Check the next frame."""
        before_us, self._channels_us = self._channels_us, channels_us
        moved = 0
        for now_us, then_us in zip(channels_us, before_us, strict=False):
            moved += abs(now_us - then_us) > _LEAP_US
        self.leaps = 2 * moved > len(channels_us)
        self.often.update(self.leaps)


class RcInput:
    """steering and throttle, −1..1, and channels_us: of the latest good frame.

    latest: the latest frame, good or bad. is_heard: there has been a good one since boot; without one, its
    absence is no fault. is_fitted: there is a receiver on board. calibrated_until_s: a station calibrates
    sticks and switches until then, and the boat does not arm.
    """

    def __init__(self) -> None:
        self.is_fitted = False
        self.is_heard = False
        self.latest: RcReading | None = None
        self.steering = 0.0
        self.throttle = 0.0
        self.channels_us: tuple[int, ...] = ()
        self.calibrated_until_s = -math.inf
        self._noise = RcNoise()
        self._good_s = -math.inf
        self._fault = ""  # of the last frame

    def ingest(self, reading: RcReading, setting: Rc) -> bool:
        """Take the next frame. Whether it is good."""
        self.latest = reading
        self._noise.update(reading.channels_us)
        self._fault = self._fault_of(reading, setting)
        if self._fault or self._noise.leaps:
            return False
        self.channels_us = channels_us = reading.channels_us
        steering, throttle = setting.steering, setting.throttle
        self.steering = deflection(channels_us[setting.steering_channel - 1], steering, steering.dead_us)
        self.throttle = deflection(channels_us[setting.throttle_channel - 1], throttle, throttle.dead_us)
        self._good_s = reading.time_s
        self.is_heard = True
        return True

    def _fault_of(self, reading: RcReading, setting: Rc) -> str:
        if reading.is_failsafe:
            return "the receiver has lost the transmitter"
        if self._noise.often.is_often:
            return "the receiver talks nonsense"
        channels_us, steering, throttle = (
            reading.channels_us,
            setting.steering_channel,
            setting.throttle_channel,
        )
        if len(channels_us) < max(steering, throttle):
            return "the receiver has too few channels"
        if channels_us[throttle - 1] < setting.failsafe_us:
            return "throttle below FS_THR_VALUE"
        if not (is_pulse(channels_us[steering - 1]) and is_pulse(channels_us[throttle - 1])):
            return "no pulse on a stick's channel"
        return ""

    def is_fresh(self, setting: Rc, now_s: float) -> bool:
        """Whether the latest good frame is recent."""
        return now_s - self._good_s <= setting.timeout_s

    def fault(self, setting: Rc, now_s: float) -> str:
        """Why a transmitter that was received no longer is; empty if it is, or never was."""
        if not self.is_heard or self.is_fresh(setting, now_s):
            return ""
        return self._fault or "the receiver is silent"
