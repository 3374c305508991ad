"""The pilot: turns an intent into what the control loops are to hold this tick."""

import math

from companion.config import BoatConfig
from companion.guidance.line_of_sight import (
    CrabAngle,
    desired_course_rad,
    heading_for_course_rad,
    leg_course_rad,
    lookahead_m,
)
from companion.guidance.speed_profile import leg_speed_m_s, steered_speed_m_s
from companion.guidance.station_keeping import StationKeeping
from companion.state import Demand, NavState
from companion.units import wrap_pi
from companion.vehicle.intent import Drive, FollowLeg, Intent, KeepStation, Stop


class Pilot:
    """Holds guidance's only memories: the crab angle, and the line of the virtual anchor."""

    __slots__ = ("_crab", "_station", "_station_point")

    def __init__(self) -> None:
        self._crab = CrabAngle()
        self._station = StationKeeping()
        self._station_point: object = None

    def update(
        self, intent: Intent, nav: NavState | None, config: BoatConfig, dt_s: float
    ) -> Demand | Drive | Stop:
        """What to hold now. Stop and Drive go through; without a NavState everything else is Stop."""
        if nav is None or isinstance(intent, Stop | Drive):
            self._station_point = None
            self._crab.reset()
            return intent if isinstance(intent, Stop | Drive) else Stop()
        if isinstance(intent, FollowLeg):
            self._station_point = None
            return self._follow(intent, nav, config, dt_s)
        return self._keep(intent, nav, config, dt_s)

    def _keep(self, intent: KeepStation, nav: NavState, config: BoatConfig, dt_s: float) -> Demand:
        if intent.point != self._station_point:
            self._station.reset()
            self._crab.reset()
            self._station_point = intent.point
        return self._station.update(intent.point, nav, config.guidance, config.speed.cruise_m_s, dt_s)

    def _follow(self, leg: FollowLeg, nav: NavState, config: BoatConfig, dt_s: float) -> Demand:
        setting = config.guidance
        start, end = leg.start, leg.end
        course = leg_course_rad(start, end, nav.point)
        c, s = math.cos(course), math.sin(course)
        north, east = nav.north_m - end.north_m, nav.east_m - end.east_m
        to_go, cross_track = -(north * c + east * s), east * c - north * s
        speed_over_ground = math.hypot(nav.north_m_s, nav.east_m_s)
        ahead = lookahead_m(speed_over_ground, config.speed.cruise_m_s, setting)
        crab = self._crab.update(nav, setting.min_speed_m_s, dt_s)
        heading = heading_for_course_rad(desired_course_rad(course, cross_track, ahead), crab)
        turn = None if leg.next_end is None else wrap_pi(leg_course_rad(end, leg.next_end, end) - course)
        speed = leg_speed_m_s(leg.speed_m_s, to_go, turn, setting)
        speed = steered_speed_m_s(speed, wrap_pi(heading - nav.heading_rad), setting)
        return Demand(heading, speed, cross_track, math.hypot(north, east))
