"""ACRO: the sticks set speed and turn rate."""

from companion.core.intent import HoldTurn, Intent
from companion.rc.manual_input import top_speed_m_s
from companion.vehicle.modes.controller import ModeInputs, StickMode


class AcroMode(StickMode):
    """Full steering is ACRO_TURN_RATE at every speed."""

    def steer(self, throttle: float, steering: float, inputs: ModeInputs) -> Intent:
        """The sticks' speed and turn rate."""
        config = inputs.config
        return HoldTurn(steering * config.modes.turn_rate_rad_s, throttle * top_speed_m_s(config.speed))
