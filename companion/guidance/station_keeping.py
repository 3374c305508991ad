"""Station keeping near a point, in current and wind.

In a current the boat points its bow into it and holds position. The desired velocity over ground,
proportional to the distance, minus the current gives the velocity through the water: the part against the
current by thrust, the lateral part by turning the bow slightly. It never turns around. An integral term
corrects errors of the estimated current. From farther away the boat sails towards the point and turns early
enough to drift onto it bow first.

Without a current the boat keeps its heading, is idle within half the radius, and otherwise moves ahead or
astern along a line through the point that turns slowly towards it.

A boat that cannot turn on the spot keeps its bow into a current likewise, by way ahead. Without a current it
drifts within the radius. Beyond, it sails ahead towards the point, and drifts again near it. A point within
its turning circle cannot be turned to: it goes straight on until the circle has left the point. So it stays
within station_radius_m and three turning radii of the point.
"""

import math

from companion.config.boat_config import BoatConfig
from companion.config.tuning import Guidance
from companion.core.geo import Point
from companion.core.state import Demand, NavState
from companion.core.units import clamp, wrap_pi
from companion.guidance.course_to_steer import make_good
from companion.guidance.speed_profile import braking_speed_m_s, steered_speed_m_s

STILL_SHARE = 0.5  # of the radius: position noise is ignored within it
CLOSING_RATE_PER_S = 0.4  # speed per metre of distance
TURN_RATE_RAD_S = 0.25  # of the line, per radius of lateral distance
ASTERN_RADII = 2.0  # within this, a point behind is approached astern
INTO_CURRENT_SHARE = 0.5  # of min_speed_m_s: current above which the bow points into it,
LEAVING_SHARE = 0.3  # and below which it no longer does
NEAR_RADII = 2.0  # this near it lies with its bow into the current, or as near as it is carried in a turn
EASE_SHARE = 0.3  # of the current: least speed against it, to keep the bow into it
LEARNING_PER_S2 = 0.03  # integral gain, speed per metre and second
MAX_LEARNED_SHARE = 0.5  # of min_speed_m_s
_CLEAR_SHARE = 1.25  # of the turning circle: left so far, or the boat would turn and go straight by turns
_DIRECT_RAD = 0.3  # off the bow: a point nearly ahead is sailed at


class StationKeeping:
    """Keeps the direction of the line, None before the first update, and the integral in m/s."""

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Start again at the present heading."""
        self._line_rad: float | None = None
        self._is_into_current = self._is_returning = self._is_leaving = False
        self._learned_north = self._learned_east = 0.0

    def update(self, point: Point, nav: NavState, config: BoatConfig, dt_s: float) -> Demand:
        """Heading and speed over ground (negative: astern) that keep the boat near the point."""
        setting = config.guidance
        north, east = point.north_m - nav.north_m, point.east_m - nav.east_m
        distance = math.hypot(north, east)
        current_m_s = math.hypot(nav.current_north_m_s, nav.current_east_m_s)
        share = LEAVING_SHARE if self._is_into_current else INTO_CURRENT_SHARE
        self._is_into_current = current_m_s > share * setting.min_speed_m_s
        if self._is_into_current:
            near = max(NEAR_RADII * setting.station_radius_m, current_m_s * turning_s(config))
            if distance > near:
                return self._approach(math.atan2(east, north), distance, nav, config)
            return self._hold_into_current(north, east, distance, current_m_s, nav, config, dt_s)
        if not config.drive.can_pivot:
            return self._circle_back(north, east, distance, nav, config)
        if distance > setting.station_radius_m:
            return self._return(math.atan2(east, north), distance, nav, config)
        return self._stay(north, east, distance, nav, setting, dt_s)

    def _approach(self, bearing_rad: float, distance: float, nav: NavState, config: BoatConfig) -> Demand:
        """Sail towards the point, in a current."""
        speed = min(config.speed.cruise_m_s, braking_speed_m_s(distance, 0.0, config.guidance))
        demand = make_good(bearing_rad, speed, nav, config, 0.0, distance)
        self._line_rad = demand.heading_rad
        return demand

    def _hold_into_current(
        self,
        north: float,
        east: float,
        distance: float,
        current_m_s: float,
        nav: NavState,
        config: BoatConfig,
        dt_s: float,
    ) -> Demand:
        """Hold against the current: `up` is against it, `across` to starboard of that."""
        setting = config.guidance
        up_north, up_east = -nav.current_north_m_s / current_m_s, -nav.current_east_m_s / current_m_s
        top, slow = config.handling.top_speed_m_s, setting.min_speed_m_s
        if distance < setting.station_radius_m:
            most = MAX_LEARNED_SHARE * slow
            self._learned_north = clamp(self._learned_north + LEARNING_PER_S2 * north * dt_s, -most, most)
            self._learned_east = clamp(self._learned_east + LEARNING_PER_S2 * east * dt_s, -most, most)
        closing = CLOSING_RATE_PER_S
        want_north = closing * north + self._learned_north
        want_east = closing * east + self._learned_east
        up = current_m_s + want_north * up_north + want_east * up_east
        across = want_east * up_north - want_north * up_east
        up = clamp(up, EASE_SHARE * current_m_s, top)
        across = clamp(across, -up, up)
        upstream = math.atan2(up_east, up_north)
        heading = wrap_pi(upstream + math.atan2(across, up))
        self._line_rad = heading
        # The part of the desired velocity through the water along the present heading.
        off = wrap_pi(nav.heading_rad - upstream)
        water = up * math.cos(off) + across * math.sin(off) if abs(off) < 0.5 * math.pi else 0.0
        if not config.drive.can_pivot and abs(wrap_pi(heading - nav.heading_rad)) > setting.pivot_angle_rad:
            water = max(water, slow)  # it turns under way
        return Demand(heading, water + nav.current_along_m_s(nav.heading_rad), 0.0, distance)

    def _return(self, bearing_rad: float, distance: float, nav: NavState, config: BoatConfig) -> Demand:
        setting = config.guidance
        is_behind = math.cos(bearing_rad - nav.heading_rad) < -0.5
        if is_behind and distance < ASTERN_RADII * setting.station_radius_m:
            line = wrap_pi(bearing_rad + math.pi)
            speed = -min(CLOSING_RATE_PER_S * distance, setting.min_speed_m_s)
        else:
            line = bearing_rad
            speed = _closing_speed_m_s(distance, config)
            speed = steered_speed_m_s(speed, wrap_pi(line - nav.heading_rad), config)
        self._line_rad = line
        return Demand(line, speed, 0.0, distance)

    def _circle_back(
        self, north: float, east: float, distance: float, nav: NavState, config: BoatConfig
    ) -> Demand:
        """Drift within the radius, sail back to the point from beyond it."""
        setting, bearing = config.guidance, math.atan2(east, north)
        still = STILL_SHARE * setting.station_radius_m
        self._is_returning = distance > (still if self._is_returning else setting.station_radius_m)
        self._line_rad = nav.heading_rad
        if not self._is_returning:
            return Demand(nav.heading_rad, 0.0, 0.0, distance)
        off = abs(wrap_pi(bearing - nav.heading_rad))
        slow = min(setting.min_speed_m_s, config.speed.cruise_m_s)
        # A chord at the angle `off` from the bow leaves the turning circle at 2 R sin(off).
        chord = 2.0 * config.drive.turn_radius_m * math.sin(off)
        self._is_leaving = (
            off > _DIRECT_RAD and distance < (_CLEAR_SHARE if self._is_leaving else 1.0) * chord
        )
        if self._is_leaving:
            return Demand(nav.heading_rad, slow, 0.0, distance)
        speed = max(steered_speed_m_s(_closing_speed_m_s(distance, config), off, config), slow)
        return Demand(bearing, speed, 0.0, distance)

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


def _closing_speed_m_s(distance: float, config: BoatConfig) -> float:
    """Speed towards a point from which the boat stops in time."""
    still = STILL_SHARE * config.guidance.station_radius_m
    return min(
        config.speed.cruise_m_s,
        CLOSING_RATE_PER_S * (distance - still) + config.guidance.min_speed_m_s,
        braking_speed_m_s(distance - still, 0.0, config.guidance),
    )


def turning_s(config: BoatConfig) -> float:
    """Time to turn around."""
    fastest = config.handling.turn_rate_rad_s
    if config.drive.least_radius_m > 0.0:
        fastest = min(fastest, config.speed.cruise_m_s / config.drive.least_radius_m)
    return math.pi / fastest + config.handling.yaw_time_s
