"""MANUAL: the sticks set throttle and steering directly. Needs no estimate."""

from companion.config.boat_config import BoatConfig
from companion.core.intent import Drive, Intent, Stop
from companion.rc.manual_input import ManualInput
from companion.vehicle.modes.controller import ModeController, ModeInputs

_STOP = Stop()


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
