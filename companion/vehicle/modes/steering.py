"""STEERING: the sticks set speed and lateral acceleration, so turns widen with the square of the speed."""

from companion.core.intent import HoldTurn, Intent
from companion.core.units import clamp
from companion.rc.manual_input import top_speed_m_s
from companion.vehicle.modes.controller import ModeInputs, StickMode


class SteeringMode(StickMode):
    """Full steering is the corner acceleration, up to ACRO_TURN_RATE."""

    def steer(self, throttle: float, steering: float, inputs: ModeInputs) -> Intent:
        """The sticks' speed and turn."""
        config = inputs.config
        speed_m_s, most_rad_s = throttle * top_speed_m_s(config.speed), config.modes.turn_rate_rad_s
        at_least_m_s = max(abs(speed_m_s), config.guidance.min_speed_m_s)
        rate_rad_s = steering * config.guidance.corner_accel_m_s2 / at_least_m_s
        return HoldTurn(clamp(rate_rad_s, -most_rad_s, most_rad_s), speed_m_s)
