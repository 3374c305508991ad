"""Decides when a boat under way needs another mission, and which. It has no link and no clock."""

import math
from collections.abc import Mapping
from typing import Any, Final

from companion.core.geo import LatLon, Point
from companion.core.units import e7_to_deg
from mission_tools.errors import NoRoute
from mission_tools.maps.chart import Chart
from mission_tools.mission.mission import Mission
from mission_tools.planning.exact_planner import water_of
from mission_tools.watch.detour import Remainder, around, is_blocked, remainder_of
from mission_tools.watch.sightings import Sightings, echoes_of

WATCHED_HZ: Final = {
    "GLOBAL_POSITION_INT": 10.0,
    "ATTITUDE": 10.0,
    "OBSTACLE_DISTANCE": 5.0,
    "DISTANCE_SENSOR": 10.0,
}
"""Messages that it takes in, and the rates to ask for."""
EVERY_S: Final = 1.0  # between two missions at least
STALE_S: Final = 1.0  # a range is of no use with an older position or heading
_SAME_PING_S: Final = 2.0
_UNKNOWN_HEADING: Final = 65535


class Watcher:
    """Keeps what a vehicle sees, and its mission clear of it.

    mission: what the vehicle is to be doing; replaced by what `look` returns.
    """

    def __init__(self, chart: Chart, mission: Mission, clearance_m: float) -> None:
        self.mission = mission
        self.failure = ""  # why the last look found no way, for people
        self._chart = chart
        self._clearance_m = clearance_m
        self._water = water_of(chart)
        self._sightings = Sightings(chart)
        self._here: Point | None = None
        self._here_s = -math.inf
        self._heading_rad = math.nan
        self._heading_s = -math.inf
        self._detours: frozenset[int] = frozenset()  # indices of the items that are not of the first mission
        self._last: dict[str, Mapping[str, Any]] = {}
        self._changed_s = self._swept_s = -math.inf

    def take(self, name: str, fields: Mapping[str, Any], now_s: float) -> None:
        """Take in a vehicle's message. Raises KeyError, TypeError, ValueError: fields that make no sense."""
        if name == "GLOBAL_POSITION_INT":
            if (fields["lat"], fields["lon"]) != (0, 0):
                place = LatLon(e7_to_deg(fields["lat"]), e7_to_deg(fields["lon"]))
                self._here, self._here_s = self._chart.frame.to_local(place), now_s
            if fields["hdg"] != _UNKNOWN_HEADING and now_s - self._heading_s > STALE_S:
                self._heading_rad, self._heading_s = math.radians(fields["hdg"] / 100.0), now_s
        elif name == "ATTITUDE":
            self._heading_rad, self._heading_s = float(fields["yaw"]), now_s
        elif name == "DISTANCE_SENSOR" and now_s - self._swept_s < _SAME_PING_S:
            return  # the vehicle reports its pings in sweeps, too
        elif name in WATCHED_HZ and (here := self._position(now_s)) is not None:
            echoes = echoes_of(name, fields, self._heading_rad, self._last.get(name))
            self._last[name] = fields
            if name == "OBSTACLE_DISTANCE":
                self._swept_s = now_s
            self._sightings.take(echoes, here, now_s)

    def look(self, current: int, now_s: float) -> Mission | None:
        """The mission that is left, led round what blocks it; None while nothing does.

        current: the index in `mission.items` of the item that is sailed to. Raises NoRoute: nothing leads
        round it, said once; the boat's own look-out is what keeps it off.
        """
        seen, here = self._sightings.area(now_s), self._position(now_s)
        if seen.is_empty or here is None or not 0 <= current < len(self.mission.items):
            return None
        if now_s < self._changed_s + EVERY_S:
            return None
        if not is_blocked(here, remainder_of(self.mission.items, self._chart, current), seen):
            self.failure = ""
            return None
        try:
            self.mission, self._detours = around(
                self._chart, self._water, here, self._without_detours(current), seen, self._clearance_m
            )
        except NoRoute as error:
            if str(error) == self.failure:
                return None
            self.failure = str(error)
            raise
        self.failure, self._changed_s = "", now_s
        return self.mission

    def _without_detours(self, current: int) -> Remainder:
        """What is left of the first mission: an earlier detour is not led round, but planned anew."""
        kept = [index for index in range(len(self.mission.items)) if index not in self._detours]
        items = [self.mission.items[index] for index in kept]
        return remainder_of(items, self._chart, sum(index < current for index in kept))

    def _position(self, now_s: float) -> Point | None:
        """Where the boat is, if its position and heading are of now."""
        is_fresh = now_s - min(self._here_s, self._heading_s) <= STALE_S
        return self._here if is_fresh else None
