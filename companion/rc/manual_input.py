"""The operator's hand: what the sticks ask for in MANUAL, ACRO, STEERING and SIMPLE.

There may be two pairs, a station's and a transmitter's. As with ArduPilot Rover's overrides the station's go
first for as long as they are fresh.
"""

import math

from companion.config.boat_config import BoatConfig, Speed
from companion.core.requests import ManualControl
from companion.rc.rc_input import RcInput

_MIN_THROTTLE = 0.05  # a cruise throttle below this is not a measured one


def top_speed_m_s(setting: Speed) -> float:
    """What full throttle gives in still water, by the feed-forward's straight line."""
    return setting.max_throttle * setting.cruise_m_s / max(setting.cruise_throttle, _MIN_THROTTLE)


class ManualInput:
    """Remembers where they are, since when, and which way SIMPLE's stick points.

    latest: the station's; rc: the transmitter's.
    """

    __slots__ = ("_at_s", "_is_held", "latest", "rc")

    def __init__(self) -> None:
        self.latest = ManualControl(0.0, 0.0)
        self.rc = RcInput()
        self._at_s = -math.inf
        self._is_held = False

    def ingest(self, sticks: ManualControl, now_s: float) -> None:
        """A station's have been moved, or are still held."""
        self.latest, self._at_s = sticks, now_s
        self._is_held = True

    def release(self) -> None:
        """No station holds any."""
        self._at_s = -math.inf
        self._is_held = False

    def stop_watching(self) -> None:
        """They do not steer now: nobody is missed should they fall silent."""
        self._is_held = False

    def is_lost(self, config: BoatConfig, now_s: float) -> bool:
        """Whether a station has held them to steer, and nobody does any longer."""
        return self._is_held and not self.is_fresh(config, now_s)

    def has_station(self, config: BoatConfig, now_s: float) -> bool:
        """Whether a station holds any."""
        return now_s - self._at_s <= config.failsafe.manual_timeout_s

    def is_fresh(self, config: BoatConfig, now_s: float) -> bool:
        """Whether somebody holds any."""
        return self.has_station(config, now_s) or self.rc.is_fresh(config.rc, now_s)

    def throttle_and_steering(self, config: BoatConfig, now_s: float) -> tuple[float, float]:
        """Throttle and steering as they are obeyed; at rest where nobody holds them."""
        radio = self.rc
        throttle, steering = 0.0, 0.0
        if radio.is_fresh(config.rc, now_s):
            throttle, steering = radio.throttle, radio.steering
        if self.has_station(config, now_s):
            throttle = throttle if self.latest.throttle is None else self.latest.throttle
            steering = steering if self.latest.steering is None else self.latest.steering
        return throttle, steering
