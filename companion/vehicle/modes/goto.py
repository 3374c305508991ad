"""Sailing to a place and staying there: GUIDED's target, the way home, and LOITER's place alone."""

from companion.core.geo import LatLon, LocalFrame
from companion.core.intent import FollowLeg, KeepStation
from companion.core.state import NavState
from companion.guidance.leg import Leg


class Passage:
    """target: where to, None once it is reached. station: where to stay without a target."""

    __slots__ = ("_intent", "_leg", "station", "target")

    def __init__(self) -> None:
        self.target: LatLon | None = None
        self.station: LatLon | None = None
        self._leg: Leg | None = None
        self._intent: KeepStation | None = None  # of the station

    def stay(self, at: LatLon | None) -> None:
        """Keep station at a place, None: wherever the boat is at the next tick."""
        self.target, self.station, self._leg, self._intent = None, at, None, None

    def go(self, to: LatLon | None) -> None:
        """Sail there from wherever the boat is."""
        self.target, self._leg = to, None

    def update(
        self, nav: NavState, frame: LocalFrame, radius_m: float, speed_m_s: float
    ) -> FollowLeg | KeepStation:
        """What to sail now. As the target is reached it becomes the station."""
        if self.target is not None:
            leg = self._leg = self._leg or Leg(nav.point, frame.to_local(self.target))
            if not leg.has_ended(nav, radius_m):
                return leg.intent(speed_m_s)
            self.stay(self.target)
        if self.station is None:
            self.station = frame.to_global(nav.point)
        if self._intent is None:
            self._intent = KeepStation(frame.to_local(self.station))
        return self._intent
