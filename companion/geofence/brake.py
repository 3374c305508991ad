"""Fence brake: limits the speed so that the boat stops inside the fence, in every mode."""

import math

from msgspec.structs import replace

from companion.config.boat_config import BoatConfig
from companion.control.speed import feed_forward
from companion.core.geo import Point
from companion.core.intent import Drive, FollowCircle, FollowLeg, HoldCourse, Intent, KeepStation, Stop
from companion.core.state import Demand, NavState
from companion.core.status_text import Severity, StatusText
from companion.core.units import clamp, wrap_pi
from companion.geofence.fence import Fence
from companion.guidance.speed_profile import REACTION_S, braking_speed_m_s

_AVOID_FENCE = 1  # of avoidance.enable
_GAIN_M_S = 0.5  # possible speed increase before the next update
_GENTLE_SHARE = 0.5  # of the room is planned for braking: near rest only the propellers brake, and weakly
_CURRENT_S = 2.0  # time for which the current carries the boat on
_UNDER_WAY_M_S = 0.1  # below it, the course over ground is mostly noise
_BACK_PER_S = 0.4  # speed astern per metre too near
_ASHORE_M = 1.2  # from a line, half the hull and the error of the position: the hull may touch the shore
_STOPPED_S = 0.5  # time below steerage way after which the boat counts as stopped


class FenceBrake:
    """Limits the speed towards a line to what the boat can lose before it.

    Both the course over ground and the demanded course are checked, with the current. Lines abeam or astern
    have no effect. An autonomous boat that was stopped keeps station until the intent changes, as it would
    otherwise drift over the line, and reports it in `status_texts`. Without a recent position nothing is
    limited.

    A boat that cannot turn on the spot needs room ahead for its turn. With less it goes astern, its rudder
    turning it on, until the room is there: it turns in several moves.
    """

    def __init__(self, status_texts: list[StatusText]) -> None:
        self._status_texts = status_texts
        self._stopped: Intent | None = None  # the intent when the boat stopped
        self._stopped_s = 0.0
        self._station: KeepStation | None = None

    def hold(self, intent: Intent) -> Intent:
        """The intent, or the station where it led to the line."""
        if self._stopped is not None and intent != self._stopped:
            self._stopped, self._stopped_s, self._station = None, 0.0, None
        return intent if self._station is None else self._station

    def limit(
        self,
        steered: Demand | Drive | Stop,
        intent: Intent,
        nav: NavState | None,
        fence: Fence,
        config: BoatConfig,
        dt_s: float,
    ) -> Demand | Drive | Stop:
        """Apply the limit. intent: as given to `hold`."""
        is_on = fence.is_active and bool(config.avoidance.enable & _AVOID_FENCE)
        if not is_on or nav is None or isinstance(steered, Stop):
            return self._let_pass(steered)
        reach_m = _reach_m(math.hypot(nav.north_m_s, nav.east_m_s) + _GAIN_M_S, config)
        if not fence.is_near(nav.point, reach_m) or nav.position_age_s > config.motors.estimate_timeout_s:
            return self._let_pass(steered)
        ahead = _Ahead(nav, fence, reach_m, config)
        if isinstance(steered, Drive):
            return ahead.drive(steered)
        braked = ahead.demand(steered)
        if self._station is None and isinstance(intent, FollowLeg | HoldCourse | FollowCircle):
            is_barred = ahead.is_slow and _leads_over(intent, nav, fence, reach_m)
            self._watch(is_barred, intent, nav, fence, config, dt_s)
        return braked

    def _let_pass(self, steered: Demand | Drive | Stop) -> Demand | Drive | Stop:
        """Nothing is limited: a wait for the station has ended."""
        if self._station is None:
            self._stopped, self._stopped_s = None, 0.0
        return steered

    def _watch(
        self, is_barred: bool, intent: Intent, nav: NavState, fence: Fence, config: BoatConfig, dt_s: float
    ) -> None:
        """Keep station once the boat has been stopped for long enough."""
        if not is_barred or fence.is_outside(nav.point):
            self._stopped, self._stopped_s = None, 0.0
            return
        self._stopped = intent
        self._stopped_s += dt_s
        if self._stopped_s >= _STOPPED_S:
            margin_m = config.fence.margin_m + config.guidance.station_radius_m
            self._station = KeepStation(fence.inside(nav.point, margin_m))
            self._status_texts.append(StatusText(Severity.WARNING, "Fence ahead: keeping station"))


def _leads_over(
    intent: FollowLeg | HoldCourse | FollowCircle, nav: NavState, fence: Fence, reach_m: float
) -> bool:
    """Whether the intent leads over a line."""
    if isinstance(intent, FollowLeg):
        return fence.crosses(nav.point, intent.end)
    if isinstance(intent, HoldCourse):
        return fence.room_m(nav.point, intent.course_rad, reach_m) < reach_m
    return fence.room_m(nav.point, math.atan2(nav.east_m_s, nav.north_m_s), reach_m) < reach_m


class _Ahead:
    """The fence ahead at this tick. is_slow: no steerage way is left."""

    def __init__(self, nav: NavState, fence: Fence, reach_m: float, config: BoatConfig) -> None:
        self._nav = nav
        self._fence = fence
        self._reach_m = reach_m
        self._config = config
        self._point: Point = nav.point
        self.is_slow = False

    def demand(self, demand: Demand) -> Demand:
        """The demand with less speed, or slightly astern if too near."""
        wanted = demand.speed_m_s
        speed = self._along(demand.heading_rad, wanted)
        drive, setting, nav = self._config.drive, self._config.guidance, self._nav
        off_rad = abs(wrap_pi(demand.heading_rad - nav.heading_rad))
        if wanted > 0.0 and not drive.can_pivot and off_rad > 0.5 * setting.pivot_angle_rad:
            c, s = math.cos(nav.heading_rad), math.sin(nav.heading_rad)
            room_m = drive.turn_radius_m * min(1.0 - math.cos(off_rad), 1.0)  # what the turn takes up ahead
            ahead = self._towards(c, s, room_m)
            astern = self._towards(-c, -s)
            # Against the line with no room either way it drives on: if the shore holds it, that shows
            if ahead < speed and (astern > 0.0 or not self._fence.is_near(nav.point, _ASHORE_M)):
                speed = max(ahead, -min(setting.min_speed_m_s, max(astern, 0.0)))
                self.is_slow = speed <= 0.0 and astern <= setting.min_speed_m_s
        return demand if speed == wanted else replace(demand, speed_m_s=speed, brakes=True)

    def drive(self, drive: Drive) -> Drive:
        """Manual throttle, limited to what holds the allowed speed."""
        nav, setting = self._nav, self._config.speed
        top = setting.cruise_m_s / max(setting.cruise_throttle, 0.05)
        wanted = drive.throttle * top if drive.throttle else nav.surge_m_s
        speed = self._along(nav.heading_rad, wanted)
        if speed == wanted:
            return drive
        current_m_s = nav.current_along_m_s(nav.heading_rad)
        most = feed_forward(speed - current_m_s, setting) + setting.kp * (speed - nav.surge_m_s)
        throttle = min(drive.throttle, most) if wanted > 0.0 else max(drive.throttle, most)
        return Drive(clamp(throttle, -1.0, 1.0), drive.steering)

    def _along(self, heading_rad: float, wanted_m_s: float) -> float:
        """The allowed part of a speed along a heading, negative astern."""
        nav = self._nav
        c, s = math.cos(heading_rad), math.sin(heading_rad)
        aside_m_s = nav.current_east_m_s * c - nav.current_north_m_s * s
        speed = abs(wanted_m_s)
        side = 1.0 if wanted_m_s >= 0.0 else -1.0
        allowed = self._towards(c * wanted_m_s - s * aside_m_s, s * wanted_m_s + c * aside_m_s)
        along_m_s = side * (nav.north_m_s * c + nav.east_m_s * s)
        if along_m_s > _UNDER_WAY_M_S:
            allowed = min(allowed, max(self._towards(nav.north_m_s, nav.east_m_s), 0.0))
        self.is_slow = allowed <= self._config.guidance.min_speed_m_s
        if allowed >= speed:
            return wanted_m_s
        if allowed < 0.0:
            allowed = -min(-allowed, max(self._towards(-side * c, -side * s), 0.0))
        return side * allowed

    def _towards(self, north_m_s: float, east_m_s: float, spare_m: float = 0.0) -> float:
        """The speed limit in a direction: infinite with no line ahead, negative if too near.

        spare_m: room to be left.
        """
        room_m = self._fence.room_m(self._point, math.atan2(east_m_s, north_m_s), self._reach_m)
        if room_m >= self._reach_m:
            return math.inf
        nav, setting = self._nav, self._config.guidance
        speed_m_s = math.hypot(north_m_s, east_m_s)
        along = nav.current_north_m_s * north_m_s + nav.current_east_m_s * east_m_s
        current_m_s = along / max(speed_m_s, 1e-9)
        room_m -= self._config.fence.margin_m + max(current_m_s, 0.0) * _CURRENT_S + spare_m
        if room_m < 0.0:
            return max(_BACK_PER_S * room_m, -setting.min_speed_m_s)
        return braking_speed_m_s(_GENTLE_SHARE * room_m, 0.0, setting)


def _reach_m(speed_m_s: float, config: BoatConfig) -> float:
    """Distance at which the brake begins to act at this speed, with margin and current."""
    braking_m = speed_m_s * REACTION_S + speed_m_s * speed_m_s / (2.0 * config.guidance.accel_m_s2)
    reach_m = config.fence.margin_m + speed_m_s * _CURRENT_S + braking_m / _GENTLE_SHARE
    return reach_m + 2.0 * config.drive.least_radius_m
