"""Manual input: the sticks of a ground station and of the RC transmitter.

As with ArduPilot Rover's overrides, the station's have priority while they are fresh.
"""

import math

from companion.config.boat_config import BoatConfig, Speed
from companion.core.requests import ManualControl
from companion.rc.rc_input import RcInput

_MIN_THROTTLE = 0.05  # a smaller cruise throttle was not measured


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

    def ingest(self, sticks: ManualControl, now_s: float) -> None:
        """Take the sticks of a station."""
        self.latest, self._at_s = sticks, now_s
        self._is_held = True

    def release(self) -> None:
        """The station has released its sticks."""
        self._at_s = -math.inf
        self._is_held = False

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

    def throttle_and_steering(self, config: BoatConfig, now_s: float) -> tuple[float, float]:
        """The effective throttle and steering; 0 without fresh sticks."""
        radio = self.rc
        throttle, steering = 0.0, 0.0
        if radio.is_fresh(config.rc, now_s):
            throttle, steering = radio.throttle, radio.steering
        if self.has_station(config, now_s):
            throttle = throttle if self.latest.throttle is None else self.latest.throttle
            steering = steering if self.latest.steering is None else self.latest.steering
        return throttle, steering
