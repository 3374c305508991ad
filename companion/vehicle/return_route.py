"""RTL's route: home, or to the nearest rally point, by the water inside the fence.

Where the straight line keeps clear of the fence and of what was seen, that is a straight line. Otherwise it
is the shortest route that does, or back along the track (`surroundings.py`).
"""

import math
from typing import NamedTuple

from companion.config.boat_config import BoatConfig
from companion.core.geo import LatLon, LocalFrame, Point, distance_m
from companion.core.intent import FollowLeg, KeepStation
from companion.core.state import NavState
from companion.core.status_text import Severity, StatusText
from companion.geofence.water_route import MARGIN_SHARES, way_to_nearest
from companion.vehicle.passage import Passage
from companion.vehicle.surroundings import Surroundings


class _Basis(NamedTuple):
    """The route's inputs; a change needs a new route."""

    fence_version: int
    frame: LocalFrame
    places: tuple[LatLon, ...]
    margin_m: float


class ReturnRoute:
    """rally: the rally points. has_arrived: the boat keeps station at the end."""

    def __init__(self, surroundings: Surroundings, status_texts: list[StatusText]) -> None:
        self.rally: tuple[LatLon, ...] = ()
        self.has_arrived = False
        self._surroundings = surroundings
        self._fence = surroundings.fence
        self._status_texts = status_texts
        self._goals: tuple[Point, ...] = ()
        self._basis: _Basis | None = None
        self._passage = Passage(surroundings)
        self._station: KeepStation | None = None  # while the way is not known
        self._is_reported = False

    @property
    def target(self) -> LatLon | None:
        """The end of the route, None while there is none."""
        if self._basis is None or not self._basis.places:
            return None
        way = self._passage.way
        index = self._goals.index(way.end) if way is not None else -1
        return self._basis.places[index]

    def prepare(self, frame: LocalFrame, home: LatLon | None, config: BoatConfig) -> None:
        """Take the goals; in the cycles after they have changed, prepare the water."""
        places = self.rally
        if home is not None and (config.fence.rally_includes_home or not places):
            places = (*places, home)
        fence, margin_m = self._fence, config.fence.margin_m
        basis = _Basis(fence.version, frame, places, margin_m)
        if basis != self._basis:
            self._basis = basis
            self._goals = tuple([fence.inside(frame.to_local(place), margin_m) for place in places])
            self._passage.restart()
        else:
            self._surroundings.prepare(margin_m)

    def home_distance_m(self, point: Point) -> float:
        """The distance home by the water; the straight line until that is indexed."""
        straight_m = min((distance_m(point, goal) for goal in self._goals), default=0.0)
        water, basis = self._surroundings.water, self._basis
        if water is None or basis is None or not self._goals:
            return straight_m
        goal = min(self._goals, key=lambda goal: distance_m(point, goal))
        if self._surroundings.is_clear(point, goal, MARGIN_SHARES[0] * basis.margin_m, 0.0):
            return straight_m
        way = way_to_nearest(self._fence, water, point, self._goals, basis.margin_m)
        return math.inf if way is None else way.length_m

    def way_left_m(self, point: Point) -> float | None:
        """Length of the rest of the route; None while it is not known."""
        return self._passage.left_m(point)

    def restart(self) -> None:
        """Start from wherever the boat is."""
        self.has_arrived = self._is_reported = False
        self._station = None
        self._passage.restart()

    def update(
        self, nav: NavState, config: BoatConfig, speed_m_s: float, now_s: float
    ) -> FollowLeg | KeepStation:
        """What to sail now."""
        if self.has_arrived and self._station is not None:
            return self._station
        self._passage.update(nav, self._goals, config, now_s)
        way = self._passage.way
        if way is None:
            if self._passage.has_failed and not self._is_reported:
                self._is_reported = True
                text = "RTL: no way home inside the fence, keeping station"
                self._status_texts.append(StatusText(Severity.WARNING, text))
            if self._station is None:
                self._station = KeepStation(self._fence.inside(nav.point, config.fence.margin_m))
            return self._station
        self._station = None
        if way.advance(nav, config):
            self.has_arrived = True
            self._station = KeepStation(way.end)
            return self._station
        return way.leg.intent(speed_m_s)
