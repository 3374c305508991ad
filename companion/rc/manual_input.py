"""The operator's hand: what the sticks ask for in MANUAL, ACRO, STEERING and SIMPLE.

There may be two pairs, a station's and a transmitter's. As with ArduPilot Rover's overrides the station's go
first for as long as they are fresh.
"""

import math

from companion.config.boat_config import BoatConfig, Speed
from companion.core.intent import Drive, HoldHeading, HoldTurn, Intent, Stop
from companion.core.modes import Mode
from companion.core.requests import ManualControl
from companion.core.state import NavState
from companion.core.units import clamp, wrap_pi
from companion.rc.rc_input import RcInput

_CENTRE = 0.05  # a combined stick that is out by less points nowhere
_MIN_THROTTLE = 0.05  # a cruise throttle below this is not a measured one

_STOP = Stop()


def top_speed_m_s(setting: Speed) -> float:
    """What full throttle gives in still water, by the feed-forward's straight line."""
    return setting.max_throttle * setting.cruise_m_s / max(setting.cruise_throttle, _MIN_THROTTLE)


class ManualInput:
    """Remembers where they are, since when, and which way SIMPLE's stick points.

    latest: the station's; rc: the transmitter's.
    """

    __slots__ = ("_ahead_rad", "_at_s", "_heading_rad", "_is_held", "latest", "rc")

    def __init__(self) -> None:
        self.latest = ManualControl(0.0, 0.0)
        self.rc = RcInput()
        self._at_s = -math.inf
        self._is_held = False
        self._ahead_rad = 0.0
        self._heading_rad = 0.0

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

    def set_reference(self, nav: NavState | None) -> None:
        """A mode by hand begins: SIMPLE's stick takes the bow for ahead."""
        self._ahead_rad = self._heading_rad = 0.0 if nav is None else nav.heading_rad

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

    def intent(self, mode: Mode, config: BoatConfig, now_s: float) -> Intent:
        """What they ask for in one of the modes by hand; Stop once they are stale."""
        if not self.is_fresh(config, now_s):
            return _STOP
        throttle, steering = self.throttle_and_steering(config, now_s)
        if mode is Mode.MANUAL:
            return Drive(throttle, steering)
        top_m_s = top_speed_m_s(config.speed)
        if mode is Mode.SIMPLE:
            return self._simple(throttle, steering, top_m_s, config)
        speed_m_s, full_rad_s = throttle * top_m_s, config.modes.turn_rate_rad_s
        if mode is Mode.ACRO:
            return HoldTurn(steering * full_rad_s, speed_m_s)
        # STEERING asks for a sideways acceleration: the turn's radius grows with the square of the speed
        turned_at_m_s = max(abs(speed_m_s), config.guidance.min_speed_m_s)
        rate = steering * config.guidance.corner_accel_m_s2 / turned_at_m_s
        return HoldTurn(clamp(rate, -full_rad_s, full_rad_s), speed_m_s)

    def _simple(self, throttle: float, steering: float, top_m_s: float, config: BoatConfig) -> Intent:
        """The boat goes where the one stick points, as fast as it is pushed."""
        push = min(math.hypot(throttle, steering), 1.0)
        if push < _CENTRE:
            return HoldHeading(self._heading_rad, 0.0)
        ahead = self._ahead_rad if config.modes.simple_type == 0 else 0.0
        self._heading_rad = wrap_pi(ahead + math.atan2(steering, throttle))
        return HoldHeading(self._heading_rad, push * top_m_s)
