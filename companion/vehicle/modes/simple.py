"""SIMPLE: the boat goes where the combined stick points, as fast as it is pushed."""

import math
from typing import Final

from companion.core.intent import HoldHeading, Intent, Stop
from companion.core.units import wrap_pi
from companion.rc.manual_input import ManualInput, top_speed_m_s
from companion.vehicle.modes.controller import ModeController, ModeInputs

_CENTRE: Final = 0.05  # deflection below which the stick has no direction
_INITIAL_HEADING: Final = 0  # of SIMPLE_TYPE; 1 is north
_STOP = Stop()


class SimpleMode(ModeController):
    """The stick's "ahead" is the heading at entry or north, by SIMPLE_TYPE."""

    __slots__ = ("_ahead_rad", "_heading_rad", "_sticks")

    def __init__(self, sticks: ManualInput) -> None:
        self._sticks = sticks
        self._ahead_rad = 0.0
        self._heading_rad = 0.0  # held while the stick is centred

    def enter(self, inputs: ModeInputs | None) -> None:
        """Take the present heading as the stick's "ahead"."""
        self._ahead_rad = self._heading_rad = 0.0 if inputs is None else inputs.nav.heading_rad

    def intent(self, inputs: ModeInputs) -> Intent:
        """The stick's heading and speed; no thrust while it is stale."""
        config, now_s = inputs.config, inputs.now_s
        if not self._sticks.is_fresh(config, now_s):
            return _STOP
        throttle, steering = self._sticks.throttle_and_steering(config, now_s)
        push = min(math.hypot(throttle, steering), 1.0)
        if push < _CENTRE:
            return HoldHeading(self._heading_rad, 0.0)
        ahead_rad = self._ahead_rad if config.modes.simple_type == _INITIAL_HEADING else 0.0
        self._heading_rad = wrap_pi(ahead_rad + math.atan2(steering, throttle))
        return HoldHeading(self._heading_rad, push * top_speed_m_s(config.speed))
