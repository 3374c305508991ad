"""The route from the boat's position onto the mission, round the fence's lines and what was seen.

A plan contains only the end of its first leg. The boat may have drifted from where the plan starts, and the
straight line from there may cross a shore that the plan avoids. Such a leg is checked against the fence. If
it comes too near, the boat follows a route by the water to its end, as RTL does. As long as it sails to that
end, what it sees on the way leads to another route.
"""

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point, distance_m
from companion.core.intent import FollowLeg, Intent, KeepStation
from companion.core.state import NavState
from companion.core.status_text import Severity, StatusText
from companion.core.steps import finished
from companion.geofence.water_route import MARGIN_SHARES, is_clear
from companion.guidance.leg import Leg
from companion.vehicle.mission.progress import MissionProgress
from companion.vehicle.surroundings import Passage, Surroundings

_CAST_OFF = 2.0  # clearances: a boat that starts nearer to a line may leave it within this distance


class RouteToMission:
    """Replaces the first leg where it is not clear, and tells the operator."""

    def __init__(self, surroundings: Surroundings, status_texts: list[StatusText]) -> None:
        self._surroundings = surroundings
        self._fence = surroundings.fence
        self._status_texts = status_texts
        self._checked: Leg | None = None
        self._end: Point | None = None  # of the first leg, while the boat sails to it
        self._station: KeepStation | None = None  # while the route is not known
        self._passage = Passage(surroundings)
        self._is_led = self._is_by_fence = False  # round what was seen; round the fence's lines

    def update(
        self, intent: Intent, progress: MissionProgress, nav: NavState, config: BoatConfig, now_s: float
    ) -> Intent:
        """The intent in place of the mission's; usually the same."""
        leg, line = progress.loose_leg, progress.leg_line()
        if line is None or not isinstance(intent, FollowLeg):
            self._checked = self._end = None
            return intent
        if leg is not None and leg is not self._checked:
            self._checked, self._end = leg, leg.end
            needs_way = self._fence.is_active and not self._is_open(nav.point, leg.end, config)
            self._station = KeepStation(nav.point) if needs_way else None
            self._passage.sail_straight(nav.point, leg.end, config)
            self._is_led = self._is_by_fence = False
        if line.end != self._end:
            self._end = None
            return intent
        if self._station is not None and not self._find(nav.point, line.end, config):
            return self._station
        self._passage.update(nav, [line.end], config, now_s)
        way = self._passage.way
        if way is None or way.is_straight:
            return intent
        way.advance(nav, config)  # also the corners that the local planner has taken the boat past
        # What is rounded within sight, or lies at the end, is left to the local planner
        away_m, sight_m = distance_m(nav.point, line.end), config.avoidance.lookahead_m
        is_long = self._is_led or way.left_m(nav.point) > away_m + sight_m
        self._is_led = is_long and away_m > sight_m
        if not self._is_led and not self._is_by_fence:
            return intent
        if way.is_last and line.start == way.leg.start:
            return intent
        if way.is_last:
            progress.begin_leg_at(way.leg.start)
        return way.leg.intent(intent.speed_m_s)

    def _is_open(self, here: Point, end: Point, config: BoatConfig) -> bool:
        """Whether the straight line keeps the same clearance as a route by the water."""
        fence, clearance_m = self._fence, MARGIN_SHARES[0] * config.fence.margin_m
        margin_m, length_m = fence.margin_m(here), distance_m(here, end)
        if margin_m >= clearance_m or length_m <= _CAST_OFF * clearance_m:
            return is_clear(fence, here, end, clearance_m)
        off = here.towards(end, _CAST_OFF * clearance_m / length_m)
        return is_clear(fence, here, off, clearance_m) and is_clear(fence, off, end, clearance_m)

    def _find(self, here: Point, end: Point, config: BoatConfig) -> bool:
        """Whether the route is known, or that there is none but the straight line."""
        if self._surroundings.water is None:
            return False
        self._station = None
        # With less clearance only where the straight line leaves the water
        shares = MARGIN_SHARES if self._fence.crosses(here, end) else MARGIN_SHARES[:1]
        way = finished(self._surroundings.searching(here, [end], config, shares))
        severity, where = (Severity.WARNING, "near the fence")
        if way is not None:
            self._passage.way, self._is_by_fence = way, True
            severity, where = (Severity.INFO, "round the shore")
        self._status_texts.append(StatusText(severity, f"The way to the mission leads {where}"))
        return True
