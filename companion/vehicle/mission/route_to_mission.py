"""The way that a mission is sailed: its legs, round the fence's lines and what was seen.

A plan contains only the end of its first leg. The boat may have drifted from where the plan starts, and the
straight line from there may cross a shore that the plan avoids. Such a leg is checked against the fence. If
it comes too near, the boat follows a route by the water to its end, as RTL does. Where something seen bars a
leg, it is rounded: on the first leg to its end, on later ones until the line is free (`leg_passage.py`). An
item that what was seen shuts in is waited for, then skipped.
"""

import math

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point, distance_m
from companion.core.intent import FollowLeg, Intent, KeepStation
from companion.core.state import NavState
from companion.core.status_text import Severity, StatusText
from companion.core.steps import finished
from companion.geofence.water_route import MARGIN_SHARES, is_clear
from companion.guidance.leg import Leg
from companion.vehicle.leg_passage import LegPassage
from companion.vehicle.mission.progress import MissionProgress
from companion.vehicle.surroundings import Surroundings

_CAST_OFF = 2.0  # clearances: a boat that starts nearer to a line may leave it within this distance


class RouteToMission:
    """Replaces legs that are not clear, and tells the operator."""

    def __init__(self, surroundings: Surroundings, status_texts: list[StatusText]) -> None:
        self._surroundings = surroundings
        self._fence = surroundings.fence
        self._status_texts = status_texts
        self._checked: Leg | None = None
        self._end: Point | None = None  # of the first leg, while the boat sails to it
        self._station: KeepStation | None = None  # while the route is not known
        self._legs = LegPassage(surroundings)
        self._waits_until_s, self._waited_for = -math.inf, -1  # for a way to an item

    def left_m(self, here: Point) -> float | None:
        """The rest of the way that the boat sails instead of the leg; None where it sails the leg."""
        return self._legs.left_m(here)

    def update(
        self, intent: Intent, progress: MissionProgress, nav: NavState, config: BoatConfig, now_s: float
    ) -> Intent:
        """The intent in place of the mission's; usually the same."""
        leg, line = progress.loose_leg, progress.leg_line()
        if line is None or not isinstance(intent, FollowLeg):
            self._checked = self._end = None
            self._legs.restart()
            return intent
        if leg is not None and leg is not self._checked:
            self._checked, self._end = leg, leg.end
            if progress.left is not None:
                said = f"Going on where the charge ended, on the leg to item {progress.current_seq}"
                self._notify(said, Severity.INFO)
            needs_way = self._fence.is_active and not self._is_open(nav.point, leg.end, config)
            self._station = KeepStation(nav.point) if needs_way else None
            self._waits_until_s, self._waited_for = -math.inf, -1
            self._legs.restart()
        if line.end != self._end:
            self._end = self._station = None
        elif self._station is not None and not self._find(nav.point, line.end, config):
            return self._station
        if now_s < self._waits_until_s:
            return self._waits
        sailed = self._legs.update(intent, nav, config, now_s, self._end)
        if self._legs.is_shut:
            return self._wait(sailed, progress, nav.point, config, now_s)
        way = self._legs.way
        if self._end is not None and way is not None and way.is_last:
            if line.start == way.leg.start:
                return intent
            progress.begin_leg_at(way.leg.start)
        return sailed

    def _wait(
        self, sailed: FollowLeg, progress: MissionProgress, here: Point, config: BoatConfig, now_s: float
    ) -> Intent:
        """What was seen shuts the item in: wait, as it may go, and then skip it, unless it is the last."""
        seq = progress.current_seq
        if seq != self._waited_for:
            self._waited_for, self._waits_until_s = seq, now_s + config.avoidance.retry_s
            self._waits = KeepStation(here)
            self._notify(f"No way to item {seq} round what was seen: waiting")
            self._legs.sail_on()
            return self._waits
        if seq < progress.last_seq:
            self._notify(f"No way to item {seq}: skipped")
            progress.skip()
        return sailed

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
            self._legs.lead(end, way)
            severity, where = (Severity.INFO, "round the shore")
        self._notify(f"The way to the mission leads {where}", severity)
        return True

    def _notify(self, text: str, severity: int = Severity.WARNING) -> None:
        self._status_texts.append(StatusText(severity, text))
