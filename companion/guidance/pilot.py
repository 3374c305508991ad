"""Turns an intent into set-points of the control loops."""

import math

from msgspec.structs import replace

from companion.config.boat_config import BoatConfig
from companion.core import intent as intents
from companion.core.geo import Line, Point, distance_m
from companion.core.state import Demand, NavState
from companion.core.units import clamp, wrap_pi
from companion.guidance.circle import circle_course_rad, circle_speed_m_s
from companion.guidance.course_to_steer import course_to_steer, make_good, steerable_speed_m_s
from companion.guidance.path_following import GLIMPSE_S, Guide, PathFollowing
from companion.guidance.speed_profile import GAINING_SHARE, leg_speed_m_s, steered_speed_m_s
from companion.guidance.station_keeping import INTO_CURRENT_SHARE, StationKeeping, turning_s

_STOP = intents.Stop()
_LEAP = 2.0  # times the fastest turn: a faster change is a new heading, not a turn
_MOST_OFF_RAD = 1.2  # from the path, to either side: beyond it the boat makes no way along it
_LEAD_RAD = 0.5  # of a turn in a current: leaves thrust for the speed
CURRENT_S = 2.0  # smooths the current that legs are steered for: GNSS noise is in it; gusts last 4 s
MAX_LEAD_RAD = 1.0  # beyond the saturation of the heading loop


class Turning:
    """Keeps the heading set-point; None before the first update."""

    def __init__(self) -> None:
        self._heading_rad: float | None = None

    def reset(self) -> None:
        """Start again at the present heading."""
        self._heading_rad = None

    def update(self, yaw_rate_rad_s: float, nav: NavState, dt_s: float) -> float:
        """The heading for this tick, in [−π, π). At rate 0 it is constant."""
        heading = nav.heading_rad if self._heading_rad is None else self._heading_rad
        lead = wrap_pi(heading + yaw_rate_rad_s * dt_s - nav.heading_rad)
        self._heading_rad = heading = wrap_pi(nav.heading_rad + clamp(lead, -MAX_LEAD_RAD, MAX_LEAD_RAD))
        return heading


class Pilot:
    """State of guidance: path, station, turn."""

    def __init__(self) -> None:
        self._current_m_s: complex | None = None  # on legs, smoothed: north + i east
        self._path = PathFollowing()
        self._station = StationKeeping()
        self._station_point: Point | None = None
        self._turning = Turning()

    def update(
        self, intent: intents.Intent, nav: NavState | None, config: BoatConfig, dt_s: float
    ) -> Demand | intents.Drive | intents.Stop:
        """The set-points. Stop and Drive pass through; without a NavState everything else is Stop."""
        if not isinstance(intent, intents.KeepStation | intents.FollowLeg):
            self._station_point = None
        if not isinstance(intent, intents.FollowLeg):
            self._path.forget()
            self._current_m_s = None
        if not isinstance(intent, intents.HoldTurn):
            self._turning.reset()
        if isinstance(intent, intents.Stop | intents.Drive):
            return intent
        if nav is None:
            return _STOP
        if isinstance(intent, intents.FollowLeg):
            return self._follow(intent, nav, config, dt_s)
        if isinstance(intent, intents.KeepStation):
            return self._keep_station(intent.point, nav, config, dt_s)
        if isinstance(intent, intents.FollowCircle):
            if not config.drive.can_pivot and intent.radius_m < config.drive.turn_radius_m:
                intent = replace(intent, radius_m=config.drive.turn_radius_m)
            course, cross_track, turn = circle_course_rad(intent, nav, config)
            distance = distance_m(nav.point, intent.centre)
            speed = circle_speed_m_s(intent, config)
            demand = make_good(course, speed, nav, config, cross_track, distance)
            later, _ = course_to_steer(course + turn * GLIMPSE_S, speed, nav, config)
            return replace(demand, yaw_rate_rad_s=_yaw_rate_rad_s(demand.heading_rad, later, config))
        if isinstance(intent, intents.HoldCourse):
            return make_good(intent.course_rad, intent.speed_m_s, nav, config)
        heading = (
            intent.heading_rad
            if isinstance(intent, intents.HoldHeading)
            else self._turning.update(intent.yaw_rate_rad_s, nav, dt_s)
        )
        error = wrap_pi(heading - nav.heading_rad)
        speed = intent.speed_m_s
        if isinstance(intent, intents.HoldHeading) and abs(error) > intent.turns_beyond_rad:
            speed = max(speed, 0.0 if config.drive.can_pivot else config.guidance.min_speed_m_s)
        return Demand(heading, steered_speed_m_s(speed, error, config))

    def _keep_station(self, point: Point, nav: NavState, config: BoatConfig, dt_s: float) -> Demand:
        last = self._station_point
        if last is None or distance_m(last, point) > config.guidance.station_radius_m:
            self._station.reset()  # a small move, as of a followed vehicle, is the same station
        self._station_point = point
        return self._station.update(point, nav, config, dt_s)

    def _smoothed(self, nav: NavState, dt_s: float) -> NavState:
        """The state with a smoothed current."""
        current = complex(nav.current_north_m_s, nav.current_east_m_s)
        smooth = current if self._current_m_s is None else self._current_m_s
        self._current_m_s = smooth = smooth + (1.0 - math.exp(-dt_s / CURRENT_S)) * (current - smooth)
        return replace(nav, current_north_m_s=smooth.real, current_east_m_s=smooth.imag)

    def _follow(self, leg: intents.FollowLeg, nav: NavState, config: BoatConfig, dt_s: float) -> Demand:
        line = leg.line if leg.line.length_m > 1e-6 else Line(nav.point, leg.end)
        along_line, cross_track = line.along_and_cross_track_m(nav.point)
        to_go = line.length_m - along_line
        guide = self._path.update(leg, nav, config)
        speed = guide.speed_m_s
        # Without a turn on the spot it passes the corner slowly, and turns behind it
        stops = guide.stops and config.drive.can_pivot
        if leg.next_line is None or stops:
            carried = nav.current_along_m_s(line.course_rad)
            if carried > INTO_CURRENT_SHARE * config.guidance.min_speed_m_s:
                # In a following current, turn around before the stop and drift onto it.
                room = to_go - carried * turning_s(config)
                if room <= 0.0:
                    return self._keep_station(leg.end, nav, config, dt_s)
                speed = min(speed, leg_speed_m_s(leg.speed_m_s, room, carried, config))
        later_speed = min(guide.later_speed_m_s, speed)
        away = math.hypot(to_go, cross_track)
        smooth = self._smoothed(nav, dt_s)
        return _along_path(guide, speed, later_speed, smooth, config, cross_track, away)


def _along_path(
    guide: Guide,
    speed_m_s: float,
    later_speed_m_s: float,
    nav: NavState,
    config: BoatConfig,
    cross_track_m: float,
    distance_m: float,
) -> Demand:
    """The heading for the present speed, the throttle for the desired one.

    A boat that turns on the spot drifts in a current. It therefore keeps at least the current's speed through
    the water, and turns in steps that leave thrust for it.
    """
    setting = config.guidance
    change = GAINING_SHARE * setting.accel_m_s2 * config.handling.yaw_time_s
    _, water = course_to_steer(guide.course_rad, speed_m_s, nav, config)
    makes = steerable_speed_m_s(guide.course_rad, speed_m_s, change, nav)
    later_makes = makes + later_speed_m_s - speed_m_s
    heading, _ = course_to_steer(guide.course_rad, makes, nav, config)
    later, _ = course_to_steer(guide.later_course_rad, later_makes, nav, config)
    yaw_rate = _yaw_rate_rad_s(heading, later, config)
    heading = guide.tangent_rad + clamp(wrap_pi(heading - guide.tangent_rad), -_MOST_OFF_RAD, _MOST_OFF_RAD)
    error = wrap_pi(heading - nav.heading_rad)
    steered = steered_speed_m_s(water, error, config)
    if abs(wrap_pi(guide.tangent_rad - nav.heading_rad)) < setting.pivot_angle_rad:
        steered = max(steered, min(setting.min_speed_m_s, water))  # only beside its path: no turn on the spot
    current_m_s = math.hypot(nav.current_north_m_s, nav.current_east_m_s)
    if current_m_s > INTO_CURRENT_SHARE * setting.min_speed_m_s and abs(error) < 0.5 * math.pi:
        steered = max(steered, min(current_m_s, water))
        heading = nav.heading_rad + clamp(error, -_LEAD_RAD, _LEAD_RAD)
    demanded = steered + nav.current_along_m_s(nav.heading_rad)
    return Demand(wrap_pi(heading), demanded, cross_track_m, distance_m, yaw_rate)


def _yaw_rate_rad_s(heading_rad: float, later_rad: float, config: BoatConfig) -> float:
    """Rate of a heading that changes to later_rad within GLIMPSE_S."""
    yaw_rate = wrap_pi(later_rad - heading_rad) / GLIMPSE_S
    fastest = config.handling.turn_rate_rad_s
    if abs(yaw_rate) > _LEAP * fastest:
        return 0.0  # no feed-forward
    return clamp(yaw_rate, -fastest, fastest)
