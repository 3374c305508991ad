"""Sailing round a point, and counting the turns: CIRCLE, and loiter turns of a mission."""

from companion.core.geo import Point, bearing_rad, distance_m
from companion.core.intent import FollowCircle
from companion.core.state import NavState
from companion.core.units import TAU, wrap_pi

_ON_CIRCLE_SHARE = 0.5  # of the radius: further off, the boat is still on its way to the circle


class Orbit:
    """A circle being sailed. `turns` counts from where it is reached, and back the wrong way round."""

    def __init__(self, centre: Point, radius_m: float, clockwise: bool) -> None:
        self.centre = centre
        self.radius_m = radius_m
        self._clockwise = clockwise
        self._turned_rad = 0.0
        self._bearing_rad: float | None = None

    @property
    def turns(self) -> float:
        return self._turned_rad / TAU

    def update(self, nav: NavState) -> None:
        """Count from where the boat is now."""
        here = nav.point
        bearing = bearing_rad(self.centre, here)
        if self._bearing_rad is None:
            if abs(distance_m(self.centre, here) - self.radius_m) > _ON_CIRCLE_SHARE * self.radius_m:
                return
        else:
            swept = wrap_pi(bearing - self._bearing_rad)
            self._turned_rad += swept if self._clockwise else -swept
        self._bearing_rad = bearing

    def intent(self, speed_m_s: float) -> FollowCircle:
        """Sail it at this speed over ground."""
        return FollowCircle(self.centre, self.radius_m, self._clockwise, speed_m_s)
