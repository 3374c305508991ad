"""RTL's route: home, or to the nearest rally point, by the water inside the fence.

Without a fence, or where the straight line keeps clear of it, that is a straight line. Otherwise it is the
shortest route that keeps clear of the fence. The fence's shores are indexed once when they change, armed or
not, in ticks of their own.
"""

import math
from typing import NamedTuple

from companion.config.boat_config import BoatConfig
from companion.core.geo import LatLon, LocalFrame, Point, distance_m
from companion.core.intent import FollowLeg, KeepStation
from companion.core.state import NavState
from companion.core.status_text import Severity, StatusText
from companion.geofence.fence import Fence
from companion.geofence.water_route import (
    MARGIN_SHARES,
    FenceWater,
    WaterRoute,
    is_clear,
    way_by_water,
    way_to_nearest,
)

_CHECK_S = 1.0  # how often the way ahead is checked


class _Basis(NamedTuple):
    """The route's inputs; a change needs a new route."""

    fence_version: int
    frame: LocalFrame
    places: tuple[LatLon, ...]
    margin_m: float


class ReturnRoute:
    """rally: the rally points. has_arrived: the boat keeps station at the end."""

    def __init__(self, fence: Fence, status_texts: list[StatusText]) -> None:
        self.rally: tuple[LatLon, ...] = ()
        self.has_arrived = False
        self._fence = fence
        self._status_texts = status_texts
        self._goals: tuple[Point, ...] = ()
        self._basis: _Basis | None = None
        self._water: FenceWater | None = None
        self._water_version = -1
        self._way: WaterRoute | None = None
        self._station: KeepStation | None = None  # while the way is not known
        self._check_s = 0.0
        self._is_reported = False

    @property
    def target(self) -> LatLon | None:
        """The end of the route, None while there is none."""
        if self._basis is None or not self._basis.places:
            return None
        index = self._goals.index(self._way.end) if self._way is not None else -1
        return self._basis.places[index]

    def prepare(self, frame: LocalFrame, home: LatLon | None, config: BoatConfig) -> None:
        """Take the goals; index the fence's shores in the ticks after they have changed."""
        places = self.rally
        if home is not None and (config.fence.rally_includes_home or not places):
            places = (*places, home)
        fence, margin_m = self._fence, config.fence.margin_m
        basis = _Basis(fence.version, frame, places, margin_m)
        if basis != self._basis:
            self._basis = basis
            self._goals = tuple([fence.inside(frame.to_local(place), margin_m) for place in places])
            self._way = None
        elif self._water_version != fence.version:
            self._water = FenceWater(fence) if fence.is_active else None
            self._water_version = fence.version
        elif self._water is not None:
            self._water.prepare(margin_m)

    @property
    def water(self) -> FenceWater | None:
        """The water inside the fence; None without one, or while it is not indexed."""
        return self._water if self._water_version == self._fence.version else None

    def home_distance_m(self, point: Point) -> float:
        """The distance home by the water; the straight line until that is indexed."""
        straight_m = min((distance_m(point, goal) for goal in self._goals), default=0.0)
        water, basis = self.water, self._basis
        if water is None or basis is None or not self._goals or self._straight(point) is not None:
            return straight_m
        way = way_to_nearest(self._fence, water, point, self._goals, basis.margin_m)
        return math.inf if way is None else way.length_m

    def restart(self) -> None:
        """Start from wherever the boat is."""
        self.has_arrived = self._is_reported = False
        self._way, self._station, self._check_s = None, None, -math.inf

    def update(
        self, nav: NavState, config: BoatConfig, speed_m_s: float, now_s: float
    ) -> FollowLeg | KeepStation:
        """What to sail now."""
        if self.has_arrived and self._station is not None:
            return self._station
        if now_s >= self._check_s:
            self._check_s = now_s + _CHECK_S
            if self._way is not None and self._is_barred(nav.point, self._way.leg.end):
                self._way = None
            if self._way is None and self._find(nav.point, config):
                self._station = None
        way = self._way
        if way is None:
            if self._station is None:
                self._station = KeepStation(self._fence.inside(nav.point, config.fence.margin_m))
            return self._station
        if way.advance(nav, config):
            self.has_arrived = True
            self._station = KeepStation(way.end)
            return self._station
        return way.leg.intent(speed_m_s)

    # The way

    def _find(self, point: Point, config: BoatConfig) -> bool:
        """Whether a route from here is known now."""
        goal = self._straight(point)
        if goal is not None:
            self._way = WaterRoute(self._fence, point, [goal], 0.0, config)
            return True
        water = self.water
        if water is None:
            return False
        self._way = way_by_water(self._fence, water, point, self._goals, config)
        if self._way is not None:
            return True
        if not self._is_reported:
            self._is_reported = True
            self._status_texts.append(
                StatusText(Severity.WARNING, "RTL: no way home inside the fence, keeping station")
            )
        return False

    def _straight(self, point: Point) -> Point | None:
        """The nearest goal, if the straight line to it is clear."""
        if not self._goals:
            return None
        goal = min(self._goals, key=lambda goal: distance_m(point, goal))
        if not self._fence.is_active or is_clear(self._fence, point, goal, self._clearance_m):
            return goal
        return None

    @property
    def _clearance_m(self) -> float:
        """How far the straight line must keep from the fence."""
        return math.inf if self._basis is None else MARGIN_SHARES[0] * self._basis.margin_m

    def _is_barred(self, point: Point, end: Point) -> bool:
        """Whether the fence now crosses the rest of the leg."""
        return self._fence.is_active and not self._fence.is_outside(point) and self._fence.crosses(point, end)
