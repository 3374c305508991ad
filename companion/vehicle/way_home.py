"""RTL: the way home, or to the nearest rally point, by the water inside the fence.

Without a fence, or with a straight way that keeps clear of it, that is a straight line. Else the boat follows
the field of distances home, from one corner to the farthest that can be seen from there. The field is kept up
to date in the background, armed or not, so the way is there when it is needed.
"""

import math
from typing import NamedTuple

from companion.config import BoatConfig
from companion.geo import LatLon, LocalFrame, Point, distance_m
from companion.state import NavState
from companion.vehicle.fence import Fence
from companion.vehicle.home_field import HomeField
from companion.vehicle.intent import FollowLeg, KeepStation
from companion.vehicle.leg import Leg
from companion.vehicle.notice import Notice, Severity
from companion.vehicle.water_grid import WaterGrid

_MARGINS = (
    1.5,
    0.75,
    0.25,
)  # of fence.margin_m: how far to keep from the lines, less where there is no way else
_CORNER_SHARE = 0.5  # of the clearance: how near a corner must be passed
_HURRY_STEPS = 3
_LOOK_S = 1.0  # between looks whether the way is still clear
_CLEAR_SHARE = 0.95  # of the clearance of its ends: what a straight way must keep


class _Basis(NamedTuple):
    """What the field is made from; another one needs another field."""

    fence_version: int
    frame: LocalFrame
    places: tuple[LatLon, ...]
    margin_m: float
    attempt: int


class WayHome:
    """rally: the rally points. arrived: it keeps station at the end. Talks to the operator in `notices`."""

    def __init__(self, fence: Fence, notices: list[Notice]) -> None:
        self.rally: tuple[LatLon, ...] = ()
        self.arrived = False
        self._fence = fence
        self._notices = notices
        self._goals: tuple[Point, ...] = ()
        self._basis: _Basis | None = None
        self._field: HomeField | None = None
        self._attempt = 0
        self._way: list[Point] = []
        self._at = 0  # of the way: the corner that the present leg leads to
        self._leg: Leg | None = None
        self._station: KeepStation | None = None  # while the way is not known
        self._look_s = 0.0
        self._is_told = False

    @property
    def target(self) -> LatLon | None:
        """The place that it leads to, None while there is none."""
        if self._basis is None or not self._basis.places:
            return None
        index = self._goals.index(self._way[-1]) if self._way else -1
        return self._basis.places[index]

    def prepare(self, frame: LocalFrame, home: LatLon | None, config: BoatConfig, nav: NavState) -> None:
        """Keep the field up to date: one small step of the work, and nothing once it is done."""
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
    def is_ready(self) -> bool:
        """Whether the field is complete, or none is needed."""
        return self._basis is not None and (self._field is None or self._field.is_complete)

    def home_distance_m(self, point: Point) -> float:
        """How far it is home by the water, as well as is known: at least the straight line."""
        straight_m = min((distance_m(point, goal) for goal in self._goals), default=0.0)
        if self._field is None or not self._field.is_complete:
            return straight_m
        return max(straight_m, self._field.distance_m(point))

    def begin(self) -> None:
        """Start from wherever the boat is."""
        self.arrived = self._is_told = False
        self._way, self._leg, self._station, self._look_s = [], None, None, -math.inf

    def update(
        self, nav: NavState, config: BoatConfig, speed_m_s: float, now_s: float
    ) -> FollowLeg | KeepStation:
        """What to sail now."""
        if self.arrived and self._station is not None:
            return self._station
        if now_s >= self._look_s:
            self._look_s = now_s + _LOOK_S
            if self._leg is not None and self._is_barred(nav.point, self._leg.end):
                self._leg = None
            if self._leg is None and self._find(nav.point):
                self._station, self._leg = None, self._leg_from(nav.point, 0, config)
        if self._leg is None:
            self._hurry()
            if self._station is None:
                self._station = KeepStation(self._fence.inside(nav.point, config.fence.margin_m))
            return self._station
        while self._leg.has_ended(nav, config.guidance.waypoint_radius_m):
            if self._at == len(self._way) - 1:
                self.arrived = True
                self._station = KeepStation(self._leg.end)
                return self._station
            self._leg = self._leg_from(self._leg.end, self._at + 1, config)
        return self._leg.intent(speed_m_s)

    # The way

    def _find(self, point: Point) -> bool:
        """Whether a way from here is known now."""
        goal = self._straight(point)
        if goal is not None:
            self._way = [goal]
            return True
        field = self._field
        if field is None or not field.is_complete:
            return False
        start = self._fence.inside(point, field.grid.clearance_m)
        self._way = field.way(start)
        if self._way:
            if self._fence.is_outside(point):
                self._way.insert(0, start)
            return True
        if self._attempt < len(_MARGINS) - 1:
            self._attempt += 1  # the next field keeps less clear of the lines
        elif not self._is_told:
            self._is_told = True
            self._notices.append(
                Notice(Severity.WARNING, "RTL: no way home inside the fence, keeping station")
            )
        return False

    def _straight(self, point: Point) -> Point | None:
        """The nearest goal, where the way to it is straight and clear."""
        if not self._goals:
            return None
        goal = min(self._goals, key=lambda goal: distance_m(point, goal))
        return goal if not self._fence.is_active or self._is_clear(point, goal) else None

    def _is_clear(self, start: Point, end: Point) -> bool:
        """Whether a straight way keeps as clear of the lines as its ends do, or as the whole way is to."""
        fence = self._fence
        least_m = min(fence.margin_m(start), fence.margin_m(end))
        if self._field is not None:
            least_m = min(least_m, self._field.grid.clearance_m)
        return least_m > 0.0 and fence.is_clear(start, end, _CLEAR_SHARE * least_m)

    def _is_barred(self, point: Point, end: Point) -> bool:
        """Whether a line has come between the boat and the end of its leg."""
        return self._fence.is_active and not self._fence.is_outside(point) and self._fence.crosses(point, end)

    def _leg_from(self, start: Point, first: int, config: BoatConfig) -> Leg:
        """The next leg: to the farthest point of the way, from `first` on, that can be reached straight."""
        self._at = at = self._farthest(start, first)
        if at == len(self._way) - 1:
            return Leg(start, self._way[at])
        onward = self._way[self._farthest(self._way[at], at + 1)]
        clearance_m = self._field.grid.clearance_m if self._field is not None else 0.0
        radius_m = min(config.guidance.waypoint_radius_m, _CORNER_SHARE * clearance_m)
        return Leg(start, self._way[at], onward, radius_m)

    def _farthest(self, start: Point, first: int) -> int:
        """Galloping, then halving: what lies between is taken to be reached where its end is."""
        way, last = self._way, len(self._way) - 1
        seen, step = first, 1
        while seen < last and self._is_clear(start, way[min(seen + step, last)]):
            seen = min(seen + step, last)
            step *= 2
        unseen = min(seen + step, last + 1)
        while unseen - seen > 1:
            middle = (seen + unseen) // 2
            if middle <= last and self._is_clear(start, way[middle]):
                seen = middle
            else:
                unseen = middle
        return seen

    # The field

    def _hurry(self) -> None:
        """The boat waits for the field: more of the work than in passing."""
        field = self._field
        for _ in range(_HURRY_STEPS):
            if field is not None and not field.is_complete:
                field.advance()

    def _renew(self, basis: _Basis, here: Point) -> None:
        """Begin a new field. The grid of the last one serves again where only the goals have changed."""
        old, fence = self._basis, self._fence
        if old is not None and old.attempt == basis.attempt:  # another water: all may be well again
            self._attempt = 0
            basis = basis._replace(attempt=0)
        self._basis = basis
        places = [basis.frame.to_local(place) for place in basis.places]
        self._goals = tuple([fence.inside(place, basis.margin_m) for place in places])
        self._leg, self._way = None, []
        if not fence.is_active or not self._goals:
            self._field = None
            return
        if self._field is not None and old is not None and old._replace(places=basis.places) == basis:
            grid = self._field.grid
        else:
            grid = WaterGrid(fence, [*self._goals, here], _MARGINS[basis.attempt] * basis.margin_m)
        self._field = HomeField(fence, self._goals, grid)
