"""The modes by hand, HOLD included.

MANUAL: the sticks set throttle and steering directly; it needs no estimate. ACRO: they set speed and turn
rate. STEERING: speed and lateral acceleration, so turns widen with the square of the speed. SIMPLE: the boat
goes where the combined stick points, as fast as it is pushed.
"""

import math
from abc import abstractmethod
from typing import Final

from companion.config.boat_config import BoatConfig
from companion.core.intent import Drive, HoldHeading, HoldTurn, Intent, Stop
from companion.core.units import clamp, wrap_pi
from companion.rc.manual_input import ManualInput, top_speed_m_s
from companion.vehicle.modes.controller import ModeController, ModeInputs

_STOP: Final = Stop()
_CENTRE: Final = 0.05  # deflection below which the stick has no direction
_INITIAL_HEADING: Final = 0  # of SIMPLE_TYPE; 1 is north


class HoldMode(ModeController):
    """Motors off."""

    def intent(self, inputs: ModeInputs) -> Intent:  # noqa: ARG002
        return _STOP


class ManualMode(ModeController):
    """No control loop is closed."""

    def __init__(self, sticks: ManualInput) -> None:
        self._sticks = sticks

    def intent(self, inputs: ModeInputs) -> Intent:
        """The sticks' thrust; none while they are stale."""
        return self.drive(inputs.config, inputs.now_s)

    def drive(self, config: BoatConfig, now_s: float) -> Intent:
        """The same, without a position."""
        if not self._sticks.is_fresh(config, now_s):
            return _STOP
        return Drive(*self._sticks.throttle_and_steering(config, now_s))


class StickMode(ModeController):
    """A mode that the operator steers by hand, with an estimate. No thrust while the sticks are stale."""

    def __init__(self, sticks: ManualInput) -> None:
        self._sticks = sticks

    def intent(self, inputs: ModeInputs) -> Intent:
        """What the sticks ask for."""
        config, now_s = inputs.config, inputs.now_s
        if not self._sticks.is_fresh(config, now_s):
            return _STOP
        throttle, steering = self._sticks.throttle_and_steering(config, now_s)
        return self.steer(throttle, steering, inputs)

    @abstractmethod
    def steer(self, throttle: float, steering: float, inputs: ModeInputs) -> Intent:
        """The intent for fresh sticks, each in [-1, 1]; steering positive to starboard."""


class AcroMode(StickMode):
    """Full steering is ACRO_TURN_RATE at every speed."""

    def steer(self, throttle: float, steering: float, inputs: ModeInputs) -> Intent:
        config = inputs.config
        return HoldTurn(steering * config.modes.turn_rate_rad_s, throttle * top_speed_m_s(config.speed))


class SteeringMode(StickMode):
    """Full steering is the corner acceleration, up to ACRO_TURN_RATE."""

    def steer(self, throttle: float, steering: float, inputs: ModeInputs) -> Intent:
        config = inputs.config
        speed_m_s, most_rad_s = throttle * top_speed_m_s(config.speed), config.modes.turn_rate_rad_s
        at_least_m_s = max(abs(speed_m_s), config.guidance.min_speed_m_s)
        rate_rad_s = steering * config.guidance.corner_accel_m_s2 / at_least_m_s
        return HoldTurn(clamp(rate_rad_s, -most_rad_s, most_rad_s), speed_m_s)


class SimpleMode(StickMode):
    """The stick's "ahead" is the heading at entry or north, by SIMPLE_TYPE."""

    def __init__(self, sticks: ManualInput) -> None:
        super().__init__(sticks)
        self._ahead_rad = 0.0
        self._heading_rad = 0.0  # held while the stick is centred

    def enter(self, inputs: ModeInputs | None) -> None:
        """Take the present heading as the stick's "ahead"."""
        self._ahead_rad = self._heading_rad = 0.0 if inputs is None else inputs.nav.heading_rad

    def steer(self, throttle: float, steering: float, inputs: ModeInputs) -> Intent:
        """The stick's heading and speed."""
        config = inputs.config
        push = min(math.hypot(throttle, steering), 1.0)
        if push < _CENTRE:
            return HoldHeading(self._heading_rad, 0.0)
        ahead_rad = self._ahead_rad if config.modes.simple_type == _INITIAL_HEADING else 0.0
        self._heading_rad = wrap_pi(ahead_rad + math.atan2(steering, throttle))
        return HoldHeading(self._heading_rad, push * top_speed_m_s(config.speed))
