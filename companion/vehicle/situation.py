"""What a mode needs to know to act: where the boat is, how it is set up, what time it is."""

from typing import NamedTuple

from companion.config.boat_config import BoatConfig
from companion.core.geo import LatLon, LocalFrame
from companion.core.state import NavState


class Situation(NamedTuple):
    """One tick's. speed_m_s is the one asked for by the operator, else cruise speed."""

    nav: NavState
    frame: LocalFrame
    config: BoatConfig
    home: LatLon | None
    speed_m_s: float
    now_s: float

    @property
    def here(self) -> LatLon:
        """Where the boat is, on the globe."""
        return self.frame.to_global(self.nav.point)
