"""SIMPLE: the boat goes where the combined stick points, as fast as it is pushed."""

import math
from typing import Final

from companion.core.intent import HoldHeading, Intent
from companion.core.units import wrap_pi
from companion.rc.manual_input import ManualInput, top_speed_m_s
from companion.vehicle.modes.controller import ModeInputs, StickMode

_CENTRE: Final = 0.05  # deflection below which the stick has no direction
_INITIAL_HEADING: Final = 0  # of SIMPLE_TYPE; 1 is north


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
