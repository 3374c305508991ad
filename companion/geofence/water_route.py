"""A route through the water inside the fence, leg by leg."""

from collections.abc import Sequence

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.state import NavState
from companion.geofence.distance_field import DistanceField
from companion.geofence.fence import Fence
from companion.guidance.leg import Leg

_CORNER_SHARE = 0.5  # of the clearance: acceptance radius of a corner
_CLEAR_SHARE = 0.95  # of the clearance at its ends: required along a straight leg


class WaterRoute:
    """leg: the present one, to the farthest corner in a straight line from its start."""

    def __init__(
        self,
        fence: Fence,
        start: Point,
        corners: Sequence[Point],
        clearance_m: float,
        config: BoatConfig,
    ) -> None:
        """corners: one or more, such as the cells of a field; the last is the end."""
        self._fence = fence
        self._corners = corners
        self._clearance_m = clearance_m
        self._at = 0
        self.leg = self._leg_from(start, 0, config)

    @property
    def end(self) -> Point:
        """The destination."""
        return self._corners[-1]

    @property
    def is_last(self) -> bool:
        """Whether the present leg is the last."""
        return self._at == len(self._corners) - 1

    def advance(self, nav: NavState, config: BoatConfig) -> bool:
        """Change to the next leg at each corner; returns whether the end is reached."""
        while self.leg.has_ended(nav, config.guidance.waypoint_radius_m):
            if self.is_last:
                return True
            self.leg = self._leg_from(self.leg.end, self._at + 1, config)
        return False

    def _leg_from(self, start: Point, first: int, config: BoatConfig) -> Leg:
        """The next leg: to the farthest corner, from `first` on, in a straight line."""
        self._at = at = self._farthest(start, first)
        corners = self._corners
        if self.is_last:
            return Leg(start, corners[at])
        onward = corners[self._farthest(corners[at], at + 1)]
        radius_m = min(config.guidance.waypoint_radius_m, _CORNER_SHARE * self._clearance_m)
        return Leg(start, corners[at], onward, radius_m)

    def _farthest(self, start: Point, first: int) -> int:
        """Exponential, then binary search; visibility is assumed to be monotonic."""
        corners, last = self._corners, len(self._corners) - 1
        seen, step = first, 1
        while seen < last and self._is_clear(start, corners[min(seen + step, last)]):
            seen = min(seen + step, last)
            step *= 2
        unseen = min(seen + step, last + 1)
        while unseen - seen > 1:
            middle = (seen + unseen) // 2
            if middle <= last and self._is_clear(start, corners[middle]):
                seen = middle
            else:
                unseen = middle
        return seen

    def _is_clear(self, start: Point, end: Point) -> bool:
        return is_clear(self._fence, start, end, self._clearance_m)


def way_by_water(fence: Fence, field: DistanceField, here: Point, config: BoatConfig) -> WaterRoute | None:
    """The route to the goal of a complete field, first back inside if necessary; None if there is none."""
    clearance_m = field.grid.clearance_m
    start = fence.inside(here, clearance_m)
    corners = field.way(start)
    if not corners:
        return None
    if fence.is_outside(here):
        corners.insert(0, start)
    return WaterRoute(fence, here, corners, clearance_m, config)


def is_clear(fence: Fence, start: Point, end: Point, clearance_m: float) -> bool:
    """Whether a straight leg keeps the clearance of its ends, at most clearance_m."""
    least_m = min(fence.margin_m(start), fence.margin_m(end), clearance_m)
    return least_m > 0.0 and fence.is_clear(start, end, _CLEAR_SHARE * least_m)
