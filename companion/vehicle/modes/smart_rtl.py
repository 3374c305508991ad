"""SMART_RTL: back along the trail, leg by leg, to where the boat was armed."""

from companion.core.geo import Point
from companion.core.intent import FollowLeg, KeepStation
from companion.core.state import NavState
from companion.guidance.leg import Leg
from companion.vehicle.modes.track import SailedTrack


class WayBack:
    """Takes the trail's points off its end as they are passed, so that it stays the way home."""

    __slots__ = ("_leg", "_trail", "arrived")

    def __init__(self, trail: SailedTrack) -> None:
        self.arrived = False
        self._trail = trail
        self._leg: Leg | None = None

    def begin(self) -> None:
        """Start from wherever the boat is."""
        self.arrived = False
        self._leg = None

    def update(self, nav: NavState, radius_m: float, speed_m_s: float) -> FollowLeg | KeepStation:
        """What to sail now."""
        points = self._trail.points or [nav.point]
        start = nav.point
        while not self.arrived:
            leg = self._leg = self._leg or Leg(start, points[-1], points[-2] if len(points) > 1 else None)
            if not leg.has_ended(nav, radius_m):
                return leg.intent(speed_m_s)
            if len(points) == 1:
                self.arrived = True
            else:
                start, self._leg = points.pop(), None
        return KeepStation(points[0])

    @property
    def end(self) -> Point | None:
        """Where it leads, None without a trail."""
        return self._trail.points[0] if self._trail.points else None
