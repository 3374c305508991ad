"""A route through the water inside the fence, leg by leg."""

from collections.abc import Sequence

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.state import NavState
from companion.geofence.fence import Fence
from companion.geofence.fence_water import MARGIN_SHARES, FenceWater, way_to_nearest
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
        """corners: one or more; the last is the end."""
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
        """The farthest corner in a straight line; the first one in any case."""
        last = len(self._corners) - 1
        return next((at for at in range(last, first, -1) if self._is_clear(start, self._corners[at])), first)

    def _is_clear(self, start: Point, end: Point) -> bool:
        return is_clear(self._fence, start, end, self._clearance_m)


def way_by_water(
    fence: Fence,
    water: FenceWater,
    here: Point,
    goals: Sequence[Point],
    config: BoatConfig,
    shares: Sequence[float] = MARGIN_SHARES,
) -> WaterRoute | None:
    """The shortest route to one of the goals, first back inside if necessary; None if there is none."""
    way = way_to_nearest(fence, water, here, goals, config.fence.margin_m, shares)
    return None if way is None else WaterRoute(fence, here, way.corners, way.clearance_m, config)


def is_clear(fence: Fence, start: Point, end: Point, clearance_m: float) -> bool:
    """Whether a straight leg keeps the clearance of its ends, at most clearance_m."""
    least_m = min(fence.margin_m(start), fence.margin_m(end), clearance_m)
    return least_m > 0.0 and fence.is_clear(start, end, _CLEAR_SHARE * least_m)
