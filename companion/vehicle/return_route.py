"""RTL's route: home, or to the nearest rally point, by the water inside the fence.

Without a fence, or where the straight line keeps clear of it, that is a straight line. Otherwise the route
follows the distance field, from one corner to the farthest one in sight. The field is computed in the
background, armed or not, so that it is complete when the route is needed.
"""

import math
from typing import NamedTuple

from companion.config.boat_config import BoatConfig
from companion.core.geo import LatLon, LocalFrame, Point, distance_m
from companion.core.intent import FollowLeg, KeepStation
from companion.core.state import NavState
from companion.core.status_text import Severity, StatusText
from companion.geofence.costmap import Costmap
from companion.geofence.distance_field import DistanceField
from companion.geofence.fence import Fence
from companion.geofence.water_route import WaterRoute, is_clear, way_by_water

# Shares of fence.margin_m to keep from the lines, tried one after the other
_MARGINS = (1.5, 0.75, 0.25)
_STEPS_WHILE_WAITING = 3
_CHECK_S = 1.0  # how often the way ahead is checked


class _Basis(NamedTuple):
    """The field's inputs; a change needs a new field."""

    fence_version: int
    frame: LocalFrame
    places: tuple[LatLon, ...]
    margin_m: float
    attempt: int


class ReturnRoute:
    """rally: the rally points. has_arrived: the boat keeps station at the end."""

    def __init__(self, fence: Fence, status_texts: list[StatusText]) -> None:
        self.rally: tuple[LatLon, ...] = ()
        self.has_arrived = False
        self._fence = fence
        self._status_texts = status_texts
        self._goals: tuple[Point, ...] = ()
        self._basis: _Basis | None = None
        self._field: DistanceField | None = None
        self._attempt = 0
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

    def prepare(self, frame: LocalFrame, home: LatLon | None, config: BoatConfig, nav: NavState) -> None:
        """One step of computing the field; nothing once it is complete."""
        places = self.rally
        if home is not None and (config.fence.rally_includes_home or not places):
            places = (*places, home)
        basis = self._basis
        if (
            basis is None
            or basis.fence_version != self._fence.version
            or basis.frame is not frame
            or basis.places != places
            or basis.margin_m != config.fence.margin_m
            or basis.attempt != self._attempt
        ):
            self._renew(
                _Basis(self._fence.version, frame, places, config.fence.margin_m, self._attempt), nav.point
            )
        elif self._field is not None and not self._field.is_complete:
            self._field.advance()

    @property
    def grid(self) -> Costmap | None:
        """The cells inside the fence; None while they are not complete, or none are needed."""
        field = self._field
        return field.grid if field is not None and field.grid.is_complete else None

    @property
    def is_ready(self) -> bool:
        """Whether the field is complete, or none is needed."""
        return self._basis is not None and (self._field is None or self._field.is_complete)

    def clearance_m(self, config: BoatConfig) -> float:
        """How far routes keep from the fence's lines."""
        return _MARGINS[0] * config.fence.margin_m if self._field is None else self._field.grid.clearance_m

    def home_distance_m(self, point: Point) -> float:
        """The distance home by the water; the straight line until the field is complete."""
        straight_m = min((distance_m(point, goal) for goal in self._goals), default=0.0)
        if self._field is None or not self._field.is_complete:
            return straight_m
        return max(straight_m, self._field.distance_m(point))

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
            self.advance_field()
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
        field = self._field
        if field is None or not field.is_complete:
            return False
        self._way = way_by_water(self._fence, field, point, config)
        if self._way is not None:
            return True
        if self._attempt < len(_MARGINS) - 1:
            self._attempt += 1  # the next field keeps less clear of the lines
        elif not self._is_reported:
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
        """How far the straight line must keep from the fence; infinite without a field: as its ends."""
        return math.inf if self._field is None else self._field.grid.clearance_m

    def _is_barred(self, point: Point, end: Point) -> bool:
        """Whether the fence now crosses the rest of the leg."""
        return self._fence.is_active and not self._fence.is_outside(point) and self._fence.crosses(point, end)

    # The field

    def advance_field(self) -> None:
        """Several steps at once, while the boat waits for the field."""
        field = self._field
        for _ in range(_STEPS_WHILE_WAITING):
            if field is not None and not field.is_complete:
                field.advance()

    def _renew(self, basis: _Basis, here: Point) -> None:
        """Begin a new field. Where only the goals have changed, the grid is kept."""
        old, fence = self._basis, self._fence
        if old is not None and old.attempt == basis.attempt:  # another fence or home: full margin
            self._attempt = 0
            basis = basis._replace(attempt=0)
        self._basis = basis
        places = [basis.frame.to_local(place) for place in basis.places]
        self._goals = tuple([fence.inside(place, basis.margin_m) for place in places])
        self._way = None
        if not fence.is_active or not self._goals:
            self._field = None
            return
        if self._field is not None and old is not None and old._replace(places=basis.places) == basis:
            grid = self._field.grid
        else:
            grid = Costmap(fence, [*self._goals, here], _MARGINS[basis.attempt] * basis.margin_m)
        self._field = DistanceField(fence, self._goals, grid)
