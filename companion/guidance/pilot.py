"""The pilot: turns an intent into what the control loops are to hold this tick."""

import math

import msgspec

from companion.config import BoatConfig
from companion.geo import Line, Point, distance_m
from companion.guidance.circle import circle_course_rad, circle_speed_m_s
from companion.guidance.drift import Drift
from companion.guidance.line_of_sight import desired_course_rad, lookahead_m
from companion.guidance.speed_profile import leg_speed_m_s, steered_speed_m_s, turn_lead_m
from companion.guidance.station_keeping import StationKeeping
from companion.guidance.turning import Turning
from companion.state import Demand, NavState
from companion.units import wrap_pi
from companion.vehicle.intent import (
    Drive,
    FollowCircle,
    FollowLeg,
    HoldCourse,
    HoldHeading,
    HoldTurn,
    Intent,
    KeepStation,
    Stop,
)

_STOP = Stop()


class Pilot:
    """Guidance's memory: drift, anchor line, turn, and the corner that an early turn has missed."""

    __slots__ = ("_missed", "_station", "_station_point", "_turning", "drift")

    def __init__(self) -> None:
        self.drift = Drift()
        self._station = StationKeeping()
        self._station_point: Point | None = None
        self._turning = Turning()
        self._missed: Point | None = None

    def update(
        self, intent: Intent, nav: NavState | None, config: BoatConfig, dt_s: float
    ) -> Demand | Drive | Stop:
        """What to hold now. Stop and Drive go through; without a NavState everything else is Stop.

        A boat adrift or steered by hand teaches the drift as well as one on a leg.
        """
        if nav is not None:
            self.drift.update(nav, dt_s)
        if not isinstance(intent, KeepStation):
            self._station_point = None
        if not isinstance(intent, HoldTurn):
            self._turning.reset()
        if isinstance(intent, Stop | Drive):
            return intent
        if nav is None:
            return _STOP
        if isinstance(intent, FollowLeg):
            return self._follow(intent, nav, config)
        if isinstance(intent, KeepStation):
            return self._keep(intent.point, nav, config, dt_s)
        if isinstance(intent, FollowCircle):
            course, cross_track = circle_course_rad(intent, nav, config)
            distance = distance_m(nav.point, intent.centre)
            speed = circle_speed_m_s(intent, config)
            return self._make_good(course, speed, nav, config, cross_track, distance)
        if isinstance(intent, HoldCourse):
            return self._make_good(intent.course_rad, intent.speed_m_s, nav, config)
        heading = (
            intent.heading_rad
            if isinstance(intent, HoldHeading)
            else self._turning.update(intent.yaw_rate_rad_s, nav, dt_s)
        )
        error = wrap_pi(heading - nav.heading_rad)
        return Demand(heading, steered_speed_m_s(intent.speed_m_s, error, config.guidance))

    def _make_good(
        self,
        course_rad: float,
        speed_m_s: float,
        nav: NavState,
        config: BoatConfig,
        cross_track_m: float = 0.0,
        distance_m: float = 0.0,
    ) -> Demand:
        """Hold the bow against the drift so that the boat goes that way over ground."""
        water_speed = max(self.drift.water_speed_m_s(nav), config.guidance.min_speed_m_s)
        heading = wrap_pi(self.drift.heading_for_course_rad(course_rad, water_speed))
        speed = steered_speed_m_s(speed_m_s, wrap_pi(heading - nav.heading_rad), config.guidance)
        return Demand(heading, speed, cross_track_m, distance_m)

    def _keep(self, point: Point, nav: NavState, config: BoatConfig, dt_s: float) -> Demand:
        last = self._station_point
        if last is None or distance_m(last, point) > config.guidance.station_radius_m:
            self._station.reset()  # a point that moves little, as one that is followed does, is the same
        self._station_point = point
        return self._station.update(point, nav, config.guidance, config.speed.cruise_m_s, dt_s)

    def _follow(self, leg: FollowLeg, nav: NavState, config: BoatConfig) -> Demand:
        setting = config.guidance
        if leg.radius_m > 0.0:
            setting = msgspec.structs.replace(setting, waypoint_radius_m=leg.radius_m)
        here, end = nav.point, leg.end
        line = aim = leg.line if leg.line.length_m > 1e-6 else Line(here, end)
        along, cross_track = line.along_and_cross_track_m(here)
        to_go, aim_cross = line.length_m - along, cross_track
        ground_speed = math.hypot(nav.north_m_s, nav.east_m_s)
        turn: float | None = None
        if leg.next_line is not None:
            turn = wrap_pi(leg.next_line.course_rad - line.course_rad)
            if to_go < turn_lead_m(turn, ground_speed, setting) and self._is_closing(end, nav):
                aim = leg.next_line
                _, aim_cross = aim.along_and_cross_track_m(here)
        cross_speed = aim.cross_speed_m_s(nav.north_m_s, nav.east_m_s)
        ahead = lookahead_m(ground_speed, config.speed.cruise_m_s, setting)
        wanted = desired_course_rad(aim.course_rad, aim_cross, cross_speed, ahead)
        speed = leg_speed_m_s(leg.speed_m_s, to_go, turn, setting)
        return self._make_good(wanted, speed, nav, config, cross_track, math.hypot(to_go, cross_track))

    def _is_closing(self, end: Point, nav: NavState) -> bool:
        """Whether a turn begun early may go on.

        Once it carries the boat away from the corner before the mission has gone on to the next leg, the
        rest of this leg is sailed without: else a small waypoint could be passed by for ever.
        """
        if end == self._missed:
            return False
        closing = (end.north_m - nav.north_m) * nav.north_m_s + (end.east_m - nav.east_m) * nav.east_m_s
        self._missed = end if closing < 0.0 else None
        return closing >= 0.0
