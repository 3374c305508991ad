"""Items at which the boat stops: it waits, turns on the spot, or lets another program steer."""

import math

from companion.core.geo import Point, distance_m
from companion.core.intent import HoldHeading, Intent, KeepStation
from companion.core.state import NavState
from companion.core.units import wrap_pi
from companion.vehicle.mission.steps import HandOver, LimitHandOver, Turn, Wait

StationaryStep = Wait | Turn | HandOver

_TURNED_RAD = math.radians(5.0)
_TURN_LIMIT_S = 30.0  # then the mission continues, turned or not


class StationaryItem:
    """The current one. limit: how long and how far another program may steer."""

    def __init__(self) -> None:
        self.limit = LimitHandOver(0.0, 0.0)
        self._since_s = 0.0
        self._station = Point(0.0, 0.0)
        self._turn_to_rad = 0.0

    def begin(self, step: StationaryStep, nav: NavState, station: Point | None, now_s: float) -> Point | None:
        """The item begins. station: the present one, None without; returns the new one."""
        self._since_s = now_s
        match step:
            case Turn(heading_rad, is_relative):
                self._turn_to_rad = wrap_pi(heading_rad + (nav.heading_rad if is_relative else 0.0))
                return station
            case HandOver():
                self._station = nav.point
            case Wait():
                self._station = station or nav.point
        return self._station

    def intent(self, step: StationaryStep, nav: NavState, now_s: float) -> Intent | None:
        """The item's intent; None once it is over."""
        match step:
            case Wait(hold_s):
                return KeepStation(self._station) if now_s < self._since_s + hold_s else None
            case Turn():
                off_rad = abs(wrap_pi(self._turn_to_rad - nav.heading_rad))
                is_turning = off_rad > _TURNED_RAD and now_s < self._since_s + _TURN_LIMIT_S
                return HoldHeading(self._turn_to_rad, 0.0, _TURNED_RAD) if is_turning else None
            case HandOver(is_on):
                limit = self.limit
                in_time = limit.timeout_s == 0.0 or now_s < self._since_s + limit.timeout_s
                is_near = limit.distance_m == 0.0 or distance_m(nav.point, self._station) <= limit.distance_m
                return KeepStation(self._station) if is_on and in_time and is_near else None
