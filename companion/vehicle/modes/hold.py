"""HOLD: no thrust. The boat drifts."""

from companion.core.intent import Intent, Stop
from companion.vehicle.modes.controller import ModeController, ModeInputs

_STOP = Stop()


class HoldMode(ModeController):
    """Motors off."""

    def intent(self, inputs: ModeInputs) -> Intent:  # noqa: ARG002
        """No thrust."""
        return _STOP
