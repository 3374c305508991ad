"""Manual input: the sticks of a ground station and of the RC transmitter, and the channels that it overrides.

As with ArduPilot Rover's overrides, the station's have priority while they are fresh.
"""

import math
from collections.abc import Mapping
from typing import Final, NamedTuple

from companion.config.boat_config import BoatConfig
from companion.config.tuning import Speed
from companion.core.requests import ManualControl
from companion.rc.pulses import pulse_of
from companion.rc.rc_input import RcInput

_MIN_THROTTLE = 0.05  # a smaller cruise throttle was not measured
_HALF_RANGE_US: Final = 500.0  # of a stick, by which a dead zone becomes a share of a station's deflection
_NO_OVERRIDES: Final[Mapping[int, int]] = {}
_RELEASED: Final = ManualControl(None, None)


class _Stick(NamedTuple):
    """channel: counted from 1. share: its deflection, −1..1. is_station: a station holds it."""

    name: str
    channel: int
    share: float
    is_station: bool


def top_speed_m_s(setting: Speed) -> float:
    """The speed of full throttle in still water, by the linear feed-forward."""
    return setting.max_throttle * setting.cruise_m_s / max(setting.cruise_throttle, _MIN_THROTTLE)


class ManualInput:
    """latest: the station's sticks; rc: the transmitter's."""

    def __init__(self) -> None:
        self.latest = ManualControl(0.0, 0.0)
        self.rc = RcInput()
        self._at_s = -math.inf
        self._is_held = False
        self._overrides: dict[int, tuple[int, float]] = {}  # by channel: pulse in µs, and when it came

    def ingest(self, sticks: ManualControl, now_s: float) -> None:
        """Take the sticks of a station."""
        self.latest, self._at_s = sticks, now_s
        self._is_held = True

    def override(self, pulses_us: Mapping[int, int], now_s: float) -> None:
        """Take a station's pulses in µs by channel, counted from 1; 0 gives a channel back."""
        for channel, pulse_us in pulses_us.items():
            self._overrides[channel] = (pulse_us, now_s)

    def release(self) -> None:
        """The station has released its sticks."""
        self._at_s = -math.inf
        self._is_held = False

    def invalidate(self) -> None:
        """The station sends values that are no command: its input is lost."""
        self._at_s = -math.inf
        self._overrides.clear()

    def stop_watching(self) -> None:
        """The sticks do not steer: their silence is no fault."""
        self._is_held = False

    def is_lost(self, config: BoatConfig, now_s: float) -> bool:
        """Whether a station steered by its sticks, and all sticks are stale."""
        return self._is_held and not self.is_fresh(config, now_s)

    def has_station(self, config: BoatConfig, now_s: float) -> bool:
        """Whether a station's sticks are fresh."""
        return now_s - self._at_s <= config.failsafe.manual_timeout_s

    def is_fresh(self, config: BoatConfig, now_s: float) -> bool:
        """Whether any sticks are fresh."""
        return self.has_station(config, now_s) or self.rc.is_fresh(config.rc, now_s)

    def overridden(self, config: BoatConfig, now_s: float) -> Mapping[int, int]:
        """The pulses of a station that are fresh, by channel."""
        if not self._overrides:
            return _NO_OVERRIDES
        since_s = now_s - config.failsafe.manual_timeout_s
        return {channel: us for channel, (us, at_s) in self._overrides.items() if us and at_s >= since_s}

    def channels_us(self, config: BoatConfig, now_s: float) -> tuple[int, ...]:
        """The channels as the boat uses them: the receiver's while it is fresh, and over them a station's.

        0: no pulse.
        """
        channels = list(self.rc.channels_us) if self.rc.is_fresh(config.rc, now_s) else []
        over = dict(self.overridden(config, now_s))
        for stick in self._sticks(config, now_s):
            if stick.is_station:
                over[stick.channel] = pulse_of(stick.share, config.rc.stick(stick.channel))
        channels += [0] * (max(over, default=0) - len(channels))
        for number, pulse_us in over.items():
            channels[number - 1] = pulse_us
        return tuple(channels)

    def throttle_and_steering(self, config: BoatConfig, now_s: float) -> tuple[float, float]:
        """The effective throttle and steering; 0 without fresh sticks."""
        throttle, steering = self._sticks(config, now_s)
        return throttle.share, steering.share

    def raised_stick(self, config: BoatConfig, now_s: float) -> str:
        """The stick that is obeyed and not neutral, such as "throttle (RC3)"; empty when both are.

        Neutral is within RCn_DZ of the trim, as in Rover. The transmitter's deflections begin beyond it.
        """
        for stick in self._sticks(config, now_s):
            dead_us = config.rc.stick(stick.channel).dead_us if stick.is_station else 0
            if abs(stick.share) > dead_us / _HALF_RANGE_US:
                return f"{stick.name} (RC{stick.channel})"
        return ""

    def _sticks(self, config: BoatConfig, now_s: float) -> tuple[_Stick, _Stick]:
        """Throttle and steering as they are obeyed: the station's, else the transmitter's, else centred."""
        rc, radio = config.rc, self.rc
        own = self.latest if self.has_station(config, now_s) else _RELEASED
        throttle, steering = (radio.throttle, radio.steering) if radio.is_fresh(rc, now_s) else (0.0, 0.0)
        return (
            _Stick("throttle", rc.throttle_channel, *_obeyed(own.throttle, throttle)),
            _Stick("steering", rc.steering_channel, *_obeyed(own.steering, steering)),
        )


def _obeyed(station: float | None, transmitter: float) -> tuple[float, bool]:
    return (transmitter, False) if station is None else (station, True)
