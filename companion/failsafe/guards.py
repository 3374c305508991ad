"""When a failsafe does not act: what the guards of the table ask of the inputs."""

import math
from typing import Final

from companion.core.health import lacks_heading
from companion.core.modes import Mode
from companion.core.state import NavState
from companion.failsafe.inputs import FailsafeInputs
from companion.failsafe.recovery.transition_table import UNGROUNDING
from companion.geofence.fence import Fence

_ASTRAY_RAD: Final = (0.0, -0.3, 0.3)  # the direction of the current is known to about this

HELD_S: Final = 2.0  # in place at the shore: from then on the motion says nothing of the motors

ALL_MODES: Final[frozenset[Mode]] = frozenset(Mode)
POSITION_MODES: Final[frozenset[Mode]] = frozenset(mode for mode in Mode if mode.needs_position)
"""Not MANUAL, which the operator may always choose."""
AUTONOMOUS_MODES: Final[frozenset[Mode]] = frozenset(mode for mode in Mode if not mode.is_by_hand)


def on_way_home(inputs: FailsafeInputs) -> bool:
    """The boat sails home already."""
    return inputs.mode.rules.returns_home


def on_way_home_or_inside(inputs: FailsafeInputs) -> bool:
    """The boat sails home, or to a station inside the fence."""
    if inputs.mode is not Mode.LOITER:
        return inputs.mode.rules.returns_home
    return inputs.station is not None and inputs.fence.allows(inputs.station)


def never(_: FailsafeInputs) -> bool:
    """No exception is made."""
    return False


def held_at_shore(inputs: FailsafeInputs) -> bool:
    """The shore holds the boat, or the boat is getting off. Its position lies about the line of the fence."""
    is_ashore = inputs.board.held_s > HELD_S or inputs.recovery in UNGROUNDING
    return is_ashore and inputs.beyond_fence_m <= inputs.config.fence.margin_m


def heading_in_doubt(inputs: FailsafeInputs) -> bool:
    """The heading sensor is silent: soon the heading is lost, or the sensor is back. Meanwhile nothing can be
    steered by dead reckoning.
    """
    nav, config = inputs.nav, inputs.config
    if nav is None or lacks_heading(nav, config.motors.estimate_timeout_s):
        return False
    return nav.heading_age_s >= config.estimation.compass_timeout_s


def may_drift(nav: NavState | None, fence: Fence, seconds: float) -> bool:
    """Whether the current carries the boat over no line of the fence in this time."""
    if nav is None:
        return True
    drift_m = seconds * math.hypot(nav.current_north_m_s, nav.current_east_m_s)
    course = math.atan2(nav.current_east_m_s, nav.current_north_m_s)
    return all(fence.room_m(nav.point, course + off, drift_m) >= drift_m for off in _ASTRAY_RAD)
