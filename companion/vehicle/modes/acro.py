"""ACRO: the sticks set speed and turn rate."""

from companion.core.intent import HoldTurn, Intent, Stop
from companion.rc.manual_input import ManualInput, top_speed_m_s
from companion.vehicle.modes.controller import ModeController, ModeInputs

_STOP = Stop()


class AcroMode(ModeController):
    """Full steering is ACRO_TURN_RATE at every speed."""

    __slots__ = ("_sticks",)

    def __init__(self, sticks: ManualInput) -> None:
        self._sticks = sticks

    def intent(self, inputs: ModeInputs) -> Intent:
        """The sticks' speed and turn rate; no thrust while they are stale."""
        config, now_s = inputs.config, inputs.now_s
        if not self._sticks.is_fresh(config, now_s):
            return _STOP
        throttle, steering = self._sticks.throttle_and_steering(config, now_s)
        return HoldTurn(steering * config.modes.turn_rate_rad_s, throttle * top_speed_m_s(config.speed))
