"""LOITER: keep station, with position and heading as far as they are known.

Without a position the boat points into the last known current. Without a heading it drives ahead for some
seconds: its course then shows the heading.
"""

import math
from typing import Final

from companion.core.geo import LatLon
from companion.core.intent import Drive, HoldHeading, Intent, Stop
from companion.core.state import lacks_heading, lacks_position
from companion.geofence.fence import Fence
from companion.vehicle.modes.controller import ModeController, ModeInputs
from companion.vehicle.modes.station import Station, nearest_inside

_STOP = Stop()
_AHEAD = Drive(0.5, 0.0)
_DRIFT_M_S: Final = 0.3  # in a slower current a boat without a heading drifts
_AHEAD_S, _PAUSE_S = 6.0, 10.0  # searching for the heading
_ASTRAY_RAD: Final = 0.8  # from the current: from here on it carries the boat sideways as fast as astern
_STILL_M_S: Final = 0.05  # a slower current has no direction


class LoiterMode(ModeController):
    """Keeps station at the place of entry, or at the nearest water inside the fence."""

    def __init__(self, fence: Fence) -> None:
        self._fence = fence
        self._station = Station()
        self._into_current: HoldHeading | None = None  # while the position is unknown
        self._search_s = math.nan  # when the latest search for the heading began

    def enter(self, inputs: ModeInputs | None) -> None:
        """Keep station here, or at the nearest water inside the fence."""
        self._into_current = None
        self._station.set(nearest_inside(inputs, self._fence))

    def exit(self) -> None:
        """Stop holding into the current."""
        self._into_current = None

    def move_to(self, position: LatLon) -> None:
        """Keep station there instead."""
        self._station.set(position)

    @property
    def destination(self) -> LatLon | None:
        return self._station.position

    @property
    def needs_position(self) -> bool:
        """Whether the present intent needs a position: not while the boat holds into the current."""
        return self._into_current is None

    def intent(self, inputs: ModeInputs) -> Intent:
        """Keep station, hold into the current, or search for the heading."""
        nav, timeout_s = inputs.nav, inputs.config.motors.estimate_timeout_s
        if lacks_heading(nav, timeout_s):
            return self._search_heading(inputs)
        self._search_s = math.nan
        if not lacks_position(nav, timeout_s):
            if self._into_current is not None:
                self._into_current = None
                self._station.set(inputs.position)
            return self._station.intent(inputs)
        if self._into_current is None:
            has_current = math.hypot(nav.current_north_m_s, nav.current_east_m_s) > _STILL_M_S
            upstream_rad = math.atan2(-nav.current_east_m_s, -nav.current_north_m_s)
            heading_rad = upstream_rad if has_current else nav.heading_rad
            self._into_current = HoldHeading(heading_rad, 0.0, _ASTRAY_RAD)
        return self._into_current

    def _search_heading(self, inputs: ModeInputs) -> Intent:
        """Ahead for _AHEAD_S, then a pause; adrift in a slow current. The station is wherever that ends."""
        nav, now_s = inputs.nav, inputs.now_s
        self._station.set(nearest_inside(inputs, self._fence))
        drifts = math.hypot(nav.current_north_m_s, nav.current_east_m_s) <= _DRIFT_M_S
        if drifts or lacks_position(nav, inputs.config.motors.estimate_timeout_s):
            return _STOP
        if not now_s - self._search_s < _AHEAD_S + _PAUSE_S:
            self._search_s = now_s
        return _AHEAD if now_s - self._search_s < _AHEAD_S else _STOP
