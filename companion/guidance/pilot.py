"""The pilot: turns an intent into what the control loops are to hold this tick."""

import math

from companion.config import BoatConfig
from companion.geo import Line, Point, distance_m
from companion.guidance.circle import circle_course_rad, circle_speed_m_s
from companion.guidance.corner import SHARPEST_RAD, Corner, corner_between
from companion.guidance.course_to_steer import course_to_steer
from companion.guidance.line_of_sight import desired_course_rad, lookahead_m
from companion.guidance.onward import onward_speed_m_s
from companion.guidance.speed_profile import leg_speed_m_s, steered_speed_m_s
from companion.guidance.station_keeping import LYING_SHARE, StationKeeping, turning_s
from companion.guidance.turning import Turning
from companion.state import Demand, NavState
from companion.units import clamp, wrap_pi
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
_GLIMPSE_S = 0.1  # over which the coming turn of the heading is measured
_LEAP = 2.0  # times the fastest turn: the heading asked for does not turn, it is another one
_LAY_RADII = 1.0  # of a waypoint before its arc: up to there the arc is laid anew as the set changes
_NEW_SET_SHARE = 0.25  # of min_speed_m_s: that much change
_LOST_RADII = 1.5  # of a waypoint: this far off its arc, a corner is done with


class Pilot:
    """Guidance's memory: the corners about the present leg, anchor line, turn."""

    __slots__ = (
        "_ahead", "_astern", "_laid_set", "_leg", "_onward_m_s", "_station", "_station_point", "_turning",
    )  # fmt: skip

    def __init__(self) -> None:
        self._leg: FollowLeg | None = None
        self._laid_set = (0.0, 0.0)  # for which the corner ahead was laid
        self._ahead: Corner | None = None  # at the end of the leg
        self._astern: Corner | None = None  # the one that led onto it, until it is sailed out
        self._onward_m_s = math.inf  # allowed at the end of the leg, for the corners behind it
        self._station = StationKeeping()
        self._station_point: Point | None = None
        self._turning = Turning()

    def update(
        self, intent: Intent, nav: NavState | None, config: BoatConfig, dt_s: float
    ) -> Demand | Drive | Stop:
        """What to hold now. Stop and Drive go through; without a NavState everything else is Stop."""
        if not isinstance(intent, KeepStation | FollowLeg):
            self._station_point = None
        if not isinstance(intent, FollowLeg):
            self._leg = self._ahead = self._astern = None
        if not isinstance(intent, HoldTurn):
            self._turning.reset()
        if isinstance(intent, Stop | Drive):
            return intent
        if nav is None:
            return _STOP
        if isinstance(intent, FollowLeg):
            return self._follow(intent, nav, config, dt_s)
        if isinstance(intent, KeepStation):
            return self._keep(intent.point, nav, config, dt_s)
        if isinstance(intent, FollowCircle):
            course, cross_track, turn = circle_course_rad(intent, nav, config)
            distance = distance_m(nav.point, intent.centre)
            speed = circle_speed_m_s(intent, config)
            later = course + turn * _GLIMPSE_S
            return self._make_good(course, speed, nav, config, cross_track, distance, later, speed)
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
        next_course_rad: float | None = None,
        next_speed_m_s: float = 0.0,
        least_ahead_m_s: float | None = None,
    ) -> Demand:
        """Point the bow so that the boat goes that way over ground.

        next_course_rad, next_speed_m_s: what is wanted _GLIMPSE_S later, where it changes.
        least_ahead_m_s: through the water along the course, negative where the boat may be let down.
        """
        set_n, set_e = nav.set_north_m_s, nav.set_east_m_s
        top = config.handling.top_speed_m_s
        slow = config.guidance.min_speed_m_s if least_ahead_m_s is None else least_ahead_m_s
        heading, water = course_to_steer(course_rad, speed_m_s, set_n, set_e, slow, top)
        yaw_rate = 0.0
        if next_course_rad is not None:
            later, _ = course_to_steer(next_course_rad, next_speed_m_s, set_n, set_e, slow, top)
            yaw_rate = wrap_pi(later - heading) / _GLIMPSE_S
            fastest = config.handling.turn_rate_rad_s
            if abs(yaw_rate) > _LEAP * fastest:
                yaw_rate = 0.0  # nothing to go along with
            yaw_rate = clamp(yaw_rate, -fastest, fastest)
        heading = wrap_pi(heading)
        if slow < 0.0:
            water *= max(math.cos(heading - nav.heading_rad), 0.0)  # what the bow, as it points, makes of it
        else:
            water = steered_speed_m_s(water, wrap_pi(heading - nav.heading_rad), config.guidance)
        speed = water + nav.set_along_m_s(nav.heading_rad)
        return Demand(heading, speed, cross_track_m, distance_m, yaw_rate)

    def _keep(self, point: Point, nav: NavState, config: BoatConfig, dt_s: float) -> Demand:
        last = self._station_point
        if last is None or distance_m(last, point) > config.guidance.station_radius_m:
            self._station.reset()  # a point that moves little, as one that is followed does, is the same
        self._station_point = point
        return self._station.update(point, nav, config, dt_s)

    def _follow(self, leg: FollowLeg, nav: NavState, config: BoatConfig, dt_s: float) -> Demand:
        if leg is not self._leg:
            self._begin(leg, nav, config)
        setting, handling = config.guidance, config.handling
        here = nav.point
        line = leg.line if leg.line.length_m > 1e-6 else Line(here, leg.end)
        along_line, cross_track = line.along_and_cross_track_m(here)
        to_go = line.length_m - along_line
        ground = math.hypot(nav.north_m_s, nav.east_m_s)
        if self._ahead is not None and to_go > _LAY_RADII * setting.waypoint_radius_m + self._ahead.entry_m:
            set_n, set_e = nav.set_north_m_s, nav.set_east_m_s
            if (
                abs(set_n - self._laid_set[0]) + abs(set_e - self._laid_set[1])
                > _NEW_SET_SHARE * setting.min_speed_m_s
            ):
                self._lay_corner(leg, nav, config)
        speed = self._speed_m_s(leg, to_go, config)
        if leg.next_line is None:
            carried = nav.set_along_m_s(line.course_rad)
            if carried > LYING_SHARE * setting.min_speed_m_s:
                # Lest a set from astern carry it past, it turns about before and is let down on the stop.
                room = to_go - carried * turning_s(config)
                if room <= 0.0:
                    return self._keep(leg.end, nav, config, dt_s)
                speed = min(speed, leg_speed_m_s(leg.speed_m_s, room, carried, config))
        ahead = lookahead_m(ground, config.speed.cruise_m_s, setting)
        distance = math.hypot(to_go, cross_track)
        path = self._astern or self._ahead
        if path is None:
            cross_speed = line.cross_speed_m_s(nav.north_m_s, nav.east_m_s)
            course = desired_course_rad(line.course_rad, cross_track, cross_speed, ahead, handling.yaw_time_s)
            return self._make_good(course, speed, nav, config, cross_track, distance)
        along, cross = path.along_and_cross_track_m(here)
        if path is self._ahead and along > path.length_m:
            self._ahead = None  # the corner was missed: the rest of this leg is sailed without
        if path is self._ahead:
            next_speed = self._speed_m_s(leg, to_go - ground * _GLIMPSE_S, config)
        else:
            speed = next_speed = min(speed, path.speed_m_s(along, leg.speed_m_s, config))
            if along > path.length_m + path.exit_m or abs(cross) > _LOST_RADII * setting.waypoint_radius_m:
                self._astern = None
        tangent = path.course_rad(along)
        cross_speed = nav.east_m_s * math.cos(tangent) - nav.north_m_s * math.sin(tangent)
        preview = along + handling.slip_m + handling.yaw_time_s * ground
        correction = desired_course_rad(0.0, cross, cross_speed, ahead, handling.yaw_time_s)
        course = path.course_rad(preview)
        later = path.course_rad(preview + _GLIMPSE_S * ground)
        least = path.least_ahead_m_s(along, config)
        return self._make_good(
            course + correction,
            speed,
            nav,
            config,
            cross_track,
            distance,
            later + correction,
            next_speed,
            least,
        )

    def _begin(self, leg: FollowLeg, nav: NavState, config: BoatConfig) -> None:
        """Take up a leg: the corner that lay ahead is the one that leads onto it, if it does."""
        last, line = self._leg, leg.line
        if last is None or last.start != leg.start or last.end != leg.end:
            corner = self._ahead
            leads_on = corner is not None and (corner.next_line.start, corner.next_line.end) == (
                line.start,
                line.end,
            )
            self._astern = corner if leads_on else None
        self._leg = leg
        self._lay_corner(leg, nav, config)

    def _lay_corner(self, leg: FollowLeg, nav: NavState, config: BoatConfig) -> None:
        """Lay the arc at the end of a leg as the set is now."""
        onward, self._ahead, self._onward_m_s = leg.next_line, None, math.inf
        self._laid_set = set_n, set_e = nav.set_north_m_s, nav.set_east_m_s
        if onward is not None:
            radius = leg.radius_m or config.guidance.waypoint_radius_m
            self._ahead = corner_between(leg.line, onward, radius, config, set_n, set_e)
            if leg.onward:
                self._onward_m_s = onward_speed_m_s(onward, leg.onward, radius, leg.speed_m_s, config)

    def _speed_m_s(self, leg: FollowLeg, to_go_m: float, config: BoatConfig) -> float:
        corner, onward, most = self._ahead, leg.next_line, leg.speed_m_s
        if self._onward_m_s < most:
            most = leg_speed_m_s(most, to_go_m, self._onward_m_s, config)
        if corner is not None:
            return corner.speed_m_s(corner.entry_m - to_go_m, most, config)
        if onward is not None and abs(wrap_pi(onward.course_rad - leg.line.course_rad)) < SHARPEST_RAD:
            return most
        return leg_speed_m_s(most, to_go_m, 0.0, config)
