"""A mode's inputs, for tests of one mode alone."""

from boat_rig import FRAME, nav_at

from companion.config.boat_config import BoatConfig
from companion.core.geo import LatLon
from companion.core.state import NavState
from companion.vehicle.modes.controller import ModeInputs


def mode_inputs(
    nav: NavState | None = None,
    now_s: float = 0.0,
    config: BoatConfig = BoatConfig(),  # noqa: B008
    home: LatLon | None = FRAME.origin,
    speed_m_s: float = 2.0,
) -> ModeInputs:
    """A boat at rest at FRAME's origin, bow north, unless a state is given."""
    return ModeInputs(nav_at() if nav is None else nav, FRAME, config, home, speed_m_s, now_s)
