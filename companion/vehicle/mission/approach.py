"""The way onto a mission: round what lies between the boat, wherever it has got to, and the next waypoint.

A plan says nothing of the first leg but its end. While the boat was told what to do, the water has carried it
off the place that was planned from, and the straight way from there may lead onto a shore that the planned
one kept clear of. So such a leg is held against the fence, and where it comes too near, the boat gets to its
end by the water, as RTL does.
"""

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point, distance_m
from companion.core.intent import FollowLeg, Intent, KeepStation
from companion.core.state import NavState
from companion.core.status_text import Severity, StatusText
from companion.geofence.distance_field import DistanceField
from companion.geofence.fence import Fence
from companion.geofence.water_route import WaterRoute, is_clear, way_by_water
from companion.guidance.leg import Leg
from companion.vehicle.mission.progress import MissionProgress
from companion.vehicle.return_route import ReturnRoute

_HURRIES = 3  # at a look, while the boat waits
_FIELD_STEPS = 4
_CAST_OFF = 2.0  # clearances: within that the boat may leave a berth that has less


class Approach:
    """Says in `notices` that it goes round, or that it cannot."""

    __slots__ = ("_fence", "_field", "_judged", "_route", "_station", "_status_texts", "_way")

    def __init__(self, fence: Fence, route: ReturnRoute, status_texts: list[StatusText]) -> None:
        """route: whose grid is used for this field, too."""
        self._fence = fence
        self._route = route
        self._status_texts = status_texts
        self._judged: Leg | None = None
        self._station: KeepStation | None = None  # until it is known how to get there
        self._field: DistanceField | None = None
        self._way: WaterRoute | None = None

    def update(self, intent: Intent, progress: MissionProgress, nav: NavState, config: BoatConfig) -> Intent:
        """What to sail instead of the mission's own intent, mostly that itself."""
        leg = progress.loose_leg
        if leg is None or not isinstance(intent, FollowLeg):
            self._judged = None
            return intent
        if leg is not self._judged:
            self._judged, self._field, self._way = leg, None, None
            needs_way = self._fence.is_active and not self._is_open(nav.point, leg.end, config)
            self._station = KeepStation(nav.point) if needs_way else None
        if self._station is not None and not self._find(nav.point, leg.end, config):
            return self._station
        way = self._way
        if way is None:
            return intent
        way.advance(nav, config)
        if way.is_last:
            progress.begin_leg_at(way.leg.start)
        return way.leg.intent(intent.speed_m_s)

    def _is_open(self, here: Point, end: Point, config: BoatConfig) -> bool:
        """Whether the straight way is as clear as ways by the water are."""
        fence, clearance_m = self._fence, self._route.clearance_m(config)
        margin_m, length_m = fence.margin_m(here), distance_m(here, end)
        if margin_m >= clearance_m or length_m <= _CAST_OFF * clearance_m:
            return is_clear(fence, here, end, clearance_m)
        share = _CAST_OFF * clearance_m / length_m
        off = Point(
            here.north_m + share * (end.north_m - here.north_m),
            here.east_m + share * (end.east_m - here.east_m),
        )
        return is_clear(fence, here, off, clearance_m) and is_clear(fence, off, end, clearance_m)

    def _find(self, here: Point, end: Point, config: BoatConfig) -> bool:
        """Whether it is known by now how to get there, or that there is no way but the straight one."""
        field = self._field
        if field is None:
            for _ in range(_HURRIES):
                self._route.advance_field()
            grid = self._route.grid
            if grid is None:
                if self._route.is_ready:  # without a home there is no grid
                    self._station = None
                    return True
                return False
            field = self._field = DistanceField(self._fence, [end], grid)
        for _ in range(_FIELD_STEPS):
            if not field.is_complete:
                field.advance()
        if not field.is_complete:
            return False
        self._station = self._field = None
        self._way = way_by_water(self._fence, field, here, config)
        if self._way is not None:
            self._status_texts.append(
                StatusText(Severity.INFO, "The way to the mission leads round the shore")
            )
        else:
            self._status_texts.append(
                StatusText(Severity.WARNING, "The way to the mission leads near the fence")
            )
        return True
