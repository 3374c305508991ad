"""A mode's inputs, sticks and fence, for tests of one mode alone."""

from boat_rig import FRAME, nav_at
from laid_fence import circle, laid
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig
from companion.core.geo import LatLon
from companion.core.requests import ManualControl
from companion.core.state import NavState
from companion.geofence.fence import Fence
from companion.obstacles.perception.voyage_map import VoyageMap
from companion.rc.manual_input import ManualInput
from companion.vehicle.modes.controller import ModeInputs
from companion.vehicle.surroundings import Surroundings
from companion.vehicle.track import SailedTrack


def mode_inputs(
    nav: NavState | None = None,
    now_s: float = 0.0,
    config: BoatConfig = BoatConfig(),  # noqa: B008
    home: LatLon | None = FRAME.origin,
    speed_m_s: float = 2.0,
) -> ModeInputs:
    """A boat at rest at FRAME's origin, bow north, unless a state is given."""
    return ModeInputs(nav_at() if nav is None else nav, FRAME, config, home, speed_m_s, now_s)


def held(throttle: float, steering: float) -> ManualInput:
    """Sticks held by a station since 0 s."""
    sticks = ManualInput()
    sticks.ingest(ManualControl(throttle, steering), 0.0)
    return sticks


def fenced(radius_m: float = 50.0) -> Fence:
    """A circle of water around FRAME's origin."""
    return laid(circle(0.0, 0.0, radius_m, is_inclusion=True))


def turned(heading_rad: float) -> NavState:
    """A boat at rest at FRAME's origin."""
    return replace(nav_at(), heading_rad=heading_rad)


def around(fence: Fence) -> Surroundings:
    """A fence, in water where nothing was seen or sailed yet."""
    return Surroundings(fence, VoyageMap(), SailedTrack())
