"""Keeping station near a point: a virtual anchor.

Outside the radius the boat sails at the point, so against a current it always arrives from downstream.
Inside, it steers along a line through the point, as line of sight would, and moves ahead or astern along
it. That line is turned slowly toward the point whenever the point lies abeam, which is how the bow finds
its way into the drift without anything measuring the drift: the only direction from which the current
pushes straight back is upstream. Within half the radius nothing is asked but to stay.
"""

import math

from companion.config import Guidance
from companion.geo import Point
from companion.guidance.speed_profile import braking_speed_m_s, steered_speed_m_s
from companion.state import Demand, NavState
from companion.units import clamp, wrap_pi

STILL_SHARE = 0.5  # of the radius: inside, position errors ask for nothing
CLOSING_RATE_PER_S = 0.4  # speed asked for per metre away
TURN_RATE_RAD_S = 0.25  # of the line, per radius that the point lies abeam
ASTERN_RADII = 2.0  # this near, a point behind is backed to


class StationKeeping:
    """Remembers the direction of the line it lies on; None before the first update."""

    __slots__ = ("_line_rad",)

    def __init__(self) -> None:
        self._line_rad: float | None = None

    def reset(self) -> None:
        """Start anew, wherever the bow points then."""
        self._line_rad = None

    def update(
        self, point: Point, nav: NavState, setting: Guidance, cruise_m_s: float, dt_s: float
    ) -> Demand:
        """Heading and speed over ground (negative is astern) that keep the boat near the point."""
        north, east = point.north_m - nav.north_m, point.east_m - nav.east_m
        distance = math.hypot(north, east)
        if distance > setting.station_radius_m:
            return self._return(math.atan2(east, north), distance, nav, setting, cruise_m_s)
        return self._stay(north, east, distance, nav, setting, dt_s)

    def _return(
        self, bearing_rad: float, distance: float, nav: NavState, setting: Guidance, cruise_m_s: float
    ) -> Demand:
        is_behind = math.cos(bearing_rad - nav.heading_rad) < -0.5
        if is_behind and distance < ASTERN_RADII * setting.station_radius_m:
            line = wrap_pi(bearing_rad + math.pi)
            speed = -min(CLOSING_RATE_PER_S * distance, setting.min_speed_m_s)
        else:
            line = bearing_rad
            still = STILL_SHARE * setting.station_radius_m
            speed = min(
                cruise_m_s,
                CLOSING_RATE_PER_S * (distance - still) + setting.min_speed_m_s,
                braking_speed_m_s(distance - still, 0.0, setting),
            )
            speed = steered_speed_m_s(speed, wrap_pi(line - nav.heading_rad), setting)
        self._line_rad = line
        return Demand(line, speed, 0.0, distance)

    def _stay(
        self, north: float, east: float, distance: float, nav: NavState, setting: Guidance, dt_s: float
    ) -> Demand:
        line = nav.heading_rad if self._line_rad is None else self._line_rad
        radius = setting.station_radius_m
        excess = max(distance - STILL_SHARE * radius, 0.0) / distance if distance > 0.0 else 0.0
        c, s = math.cos(line), math.sin(line)
        ahead = excess * (north * c + east * s)
        abeam = excess * (east * c - north * s)
        line = wrap_pi(line + TURN_RATE_RAD_S * abeam / radius * dt_s)
        self._line_rad = line
        heading = wrap_pi(line + math.atan(abeam / (2.0 * radius)))
        speed = clamp(CLOSING_RATE_PER_S * ahead, -setting.min_speed_m_s, setting.min_speed_m_s)
        return Demand(heading, speed, 0.0, distance)
