"""CIRCLE: round a point ahead of where the mode began."""

from companion.core.intent import Intent
from companion.vehicle.modes.controller import ModeController, ModeInputs
from companion.vehicle.orbit import Orbit

_CLOCKWISE = 0  # of CIRC_DIR


class CircleMode(ModeController):
    """Sails round the point CIRC_RADIUS ahead of the bow, without end."""

    def __init__(self) -> None:
        self._orbit: Orbit | None = None

    def enter(self, inputs: ModeInputs | None) -> None:  # noqa: ARG002
        """Choose the centre at the next tick."""
        self._orbit = None

    def intent(self, inputs: ModeInputs) -> Intent:
        setting = inputs.config.modes
        if self._orbit is None:
            centre = inputs.nav.point.moved(inputs.nav.heading_rad, setting.circle_radius_m)
            self._orbit = Orbit(centre, setting.circle_radius_m, setting.circle_direction == _CLOCKWISE)
        return self._orbit.intent(setting.circle_speed_m_s or inputs.speed_m_s)
