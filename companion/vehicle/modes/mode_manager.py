"""What the boat does in each mode: whether it can, how it begins, and what it sails now."""

import math
from itertools import pairwise

from companion.config.boat_config import BoatConfig
from companion.core.geo import LatLon, LocalFrame
from companion.core.health import lacks_heading, lacks_position
from companion.core.intent import Drive, HoldHeading, Intent, KeepStation, Stop
from companion.core.modes import Mode
from companion.core.requests import SetPoint
from companion.core.state import NavState
from companion.core.status_text import Severity, StatusText
from companion.estimation.estimator import MAX_OFFSET_M
from companion.geofence.fence import Fence
from companion.rc.manual_input import ManualInput
from companion.vehicle.mission.approach import Approach
from companion.vehicle.mission.check import MissionCheck
from companion.vehicle.mission.progress import MissionProgress
from companion.vehicle.mission.steps import GoRound, Waypoint
from companion.vehicle.modes.circle import Orbit, ahead_of
from companion.vehicle.modes.follow import Following
from companion.vehicle.modes.goto import Passage
from companion.vehicle.modes.rtl import WayHome
from companion.vehicle.modes.smart_rtl import WayBack
from companion.vehicle.modes.track import SailedTrack
from companion.vehicle.situation import Situation

_STOP = Stop()
_AHEAD = Drive(0.5, 0.0)
_CARRIED_M_S = 0.3  # a set that a boat without a heading does not leave itself to
_GROPE_S, _REST_S = 6.0, 10.0  # straight ahead to find the heading; then, if it was in vain, adrift
_STILL_M_S = 0.05  # water that hardly moves has no direction to point into


class Conduct:
    """The modes' memories. Says what there is to say to the operator in `notices`, which the owner takes."""

    def __init__(self, fence: Fence, sticks: ManualInput, trail: SailedTrack) -> None:
        self.progress = MissionProgress()
        self.sticks = sticks
        self.passage = Passage()
        self.trail = trail
        self.following = Following()
        self.status_texts: list[StatusText] = []
        self.stemming: HoldHeading | None = None  # LOITER without a position: no more than heading and thrust
        self.mission_check = MissionCheck(self.status_texts)
        self._fence = fence
        self.way_home = WayHome(fence, self.status_texts)
        self.approach = Approach(fence, self.way_home, self.status_texts)
        self._way_back = WayBack(self.trail)
        self._groped_s = math.nan  # since when the boat goes ahead to find its heading
        self._orbit: Orbit | None = None
        self._set_point: SetPoint | None = None
        self._set_point_s = -math.inf
        self._lost_lead = False

    def prepare(self, frame: LocalFrame, home: LatLon | None, config: BoatConfig, nav: NavState) -> None:
        """What takes longer than a tick goes on: the way home, and a look through the mission."""
        self.way_home.prepare(frame, home, config, nav)
        self.mission_check.advance(self.progress.mission, self._fence, frame)

    def fault(self, mode: Mode, now: Situation) -> str:
        """What a mode that steers by the position lacks; empty when it can be entered."""
        if mode is Mode.AUTO:
            return "no mission" if self.progress.is_empty else self.mission_check.fault
        if mode is Mode.RTL and not self.way_home.rally:
            fault = "" if now.home is None else distance_fault(now.home, now.frame)
            return "no home" if now.home is None else f"home is {fault}" if fault else ""
        if mode is Mode.SMART_RTL:
            if self.trail.is_lost:
                return f"the track is longer than SRTL_POINTS {now.config.modes.trail_points}"
            if not self.trail.points:
                return "no track, the boat was not armed"
            leaves = any(self._fence.crosses(one, other) for one, other in pairwise(self.trail.points))
            return "the track leaves the fence" if leaves else ""
        if mode is Mode.FOLLOW:
            return self.following.fault(now.nav, now.frame, now.config.follow, now.now_s)
        return ""

    def begin(self, mode: Mode, now: Situation | None) -> None:
        """A mode begins, or the boat is armed in it."""
        self._set_point = self.stemming = None
        if mode.is_by_hand:
            self.sticks.set_reference(None if now is None else now.nav)
        elif mode is Mode.AUTO:
            if self.progress.finished:
                self.progress.restart()
            self.progress.resume()
        elif mode is Mode.RTL:
            self.passage.stay(None)
            self.way_home.begin()
        elif mode is Mode.SMART_RTL:
            self._way_back.begin()
        elif mode is Mode.CIRCLE:
            self._orbit = None
        else:
            self._lost_lead = False
            self.passage.stay(None if now is None else self._nearest_inside(now))

    def record(self, mode: Mode, now: Situation) -> None:
        """Keep the way back in mind. To be called every tick of an armed boat that knows where it is."""
        if mode is Mode.SMART_RTL:
            self.trail.rest(now.nav.point)
        else:
            modes = now.config.modes
            self.trail.add(now.nav.point, modes.trail_accuracy_m, modes.trail_points)

    def decide(self, mode: Mode, now: Situation) -> Intent:
        """What to sail now, in any mode that steers by the position."""
        match mode:
            case Mode.AUTO:
                intent = self.progress.update(now.nav, now.frame, now.config, now.now_s)
                if self.progress.is_handed_over:
                    return self._guided(now)
                return self.approach.update(intent, self.progress, now.nav, now.config)
            case Mode.GUIDED:
                return self._guided(now)
            case Mode.RTL:
                return self._sail_home(now)
            case Mode.SMART_RTL:
                return self._sail_back(now)
            case Mode.CIRCLE:
                return self._circle(now)
            case Mode.FOLLOW:
                return self._follow(now)
            case Mode.LOITER:
                return self._loiter(now)
        return self.sticks.intent(mode, now.config, now.now_s) if mode.is_by_hand else _STOP

    def _nearest_inside(self, now: Situation) -> LatLon:
        """Where to stay: here, or on the nearest water inside the fence."""
        fence, margin_m = self._fence, now.config.fence.margin_m + now.config.guidance.station_radius_m
        if fence.margin_m(now.nav.point) >= now.config.fence.margin_m:
            return now.here
        return now.frame.to_global(fence.inside(now.nav.point, margin_m))

    def stays_inside(self, frame: LocalFrame | None) -> bool:
        """LOITER: whether the place to stay at is inside the fence."""
        station = self.passage.station
        return station is not None and frame is not None and self._fence.allows(frame.to_local(station))

    def is_guided(self, mode: Mode) -> bool:
        """Whether another program may steer by set-points."""
        return mode is Mode.GUIDED or (mode is Mode.AUTO and self.progress.is_handed_over)

    def go(self, to: LatLon) -> None:
        """GUIDED: sail there."""
        self._set_point = None
        self.passage.go(to)

    def hold(self, set_point: SetPoint, now_s: float) -> None:
        """GUIDED: hold this until it goes stale."""
        self._set_point, self._set_point_s = set_point, now_s

    def aim(self, mode: Mode) -> LatLon | None:
        """Where the boat is heading: the current waypoint or target, None when it steers for none."""
        if mode is Mode.AUTO and self.progress.current_seq < len(self.progress.mission):
            step = self.progress.mission[self.progress.current_seq]
            is_place = isinstance(step, Waypoint | GoRound) and isinstance(step.position, LatLon)
            return step.position if is_place else None  # type: ignore[union-attr,return-value]
        if mode is Mode.RTL:
            return self.way_home.target
        if mode in (Mode.GUIDED, Mode.LOITER):
            return self.passage.target or self.passage.station
        return None

    def _guided(self, now: Situation) -> Intent:
        if self._set_point is not None:
            if now.now_s - self._set_point_s <= now.config.modes.set_point_timeout_s:
                return self._set_point.hold
            self._set_point = None
            self.passage.stay(now.here)
            self.status_texts.append(
                StatusText(Severity.WARNING, "GUIDED: set-point is stale, keeping station")
            )
        return self._sail(Mode.GUIDED, now, now.speed_m_s)

    def _sail(self, mode: Mode, now: Situation, speed_m_s: float) -> Intent:
        """To the target, then keep station there."""
        target = self.passage.target
        intent = self.passage.update(now.nav, now.frame, now.config.guidance.waypoint_radius_m, speed_m_s)
        if target is not None and self.passage.target is None:
            self.status_texts.append(StatusText(Severity.INFO, f"{mode.name}: arrived"))
        return intent

    def _sail_home(self, now: Situation) -> Intent:
        arrived = self.way_home.arrived
        speed_m_s = now.config.mission.rtl_speed_m_s or now.speed_m_s
        intent = self.way_home.update(now.nav, now.config, speed_m_s, now.now_s)
        if self.way_home.arrived and not arrived:
            self.status_texts.append(StatusText(Severity.INFO, "RTL: arrived"))
        return intent

    def _loiter(self, now: Situation) -> Intent:
        """Keep station; without a position, keep the bow into the water's last known set and stem it; without
        a heading, feel for it.
        """
        nav = now.nav
        if lacks_heading(nav, now.config.motors.estimate_timeout_s):
            return self._feel_way(now)
        self._groped_s = math.nan
        if not lacks_position(nav, now.config.motors.estimate_timeout_s):
            if self.stemming is not None:
                self.stemming = None
                self.passage.stay(now.here)
            return self._sail(Mode.LOITER, now, now.speed_m_s)
        if self.stemming is None:
            is_set = math.hypot(nav.current_north_m_s, nav.current_east_m_s) > _STILL_M_S
            upstream = math.atan2(-nav.current_east_m_s, -nav.current_north_m_s)
            self.stemming = HoldHeading(upstream if is_set else nav.heading_rad, 0.0)
        return self.stemming

    def _feel_way(self, now: Situation) -> Intent:
        """Straight ahead for some seconds: a boat that makes way shows by its course where its bow points. In
        water that hardly moves it may as well drift. It stays where it is once the heading is known.
        """
        nav = now.nav
        self.passage.stay(self._nearest_inside(now))
        is_set = math.hypot(nav.current_north_m_s, nav.current_east_m_s) > _CARRIED_M_S
        if not is_set or lacks_position(nav, now.config.motors.estimate_timeout_s):
            return _STOP
        if not now.now_s - self._groped_s < _GROPE_S + _REST_S:
            self._groped_s = now.now_s
        return _AHEAD if now.now_s - self._groped_s < _GROPE_S else _STOP

    def _sail_back(self, now: Situation) -> Intent:
        arrived = self._way_back.arrived
        speed_m_s = now.config.mission.rtl_speed_m_s or now.speed_m_s
        intent = self._way_back.update(now.nav, now.config.guidance.waypoint_radius_m, speed_m_s)
        if self._way_back.arrived and not arrived:
            self.status_texts.append(StatusText(Severity.INFO, "SMART_RTL: arrived"))
        return intent

    def _circle(self, now: Situation) -> Intent:
        modes = now.config.modes
        if self._orbit is None:
            centre = ahead_of(now.nav, modes.circle_radius_m)
            self._orbit = Orbit(centre, modes.circle_radius_m, modes.circle_direction == 0)
        return self._orbit.intent(modes.circle_speed_m_s or now.speed_m_s)

    def _follow(self, now: Situation) -> Intent:
        fault = self.following.fault(now.nav, now.frame, now.config.follow, now.now_s)
        if fault:
            if not self._lost_lead:
                self._lost_lead = True
                self.passage.stay(now.here)
                self.status_texts.append(StatusText(Severity.WARNING, f"FOLLOW: {fault}, keeping station"))
            return self._sail(Mode.FOLLOW, now, now.speed_m_s)
        self._lost_lead = False
        return self.following.intent(now.nav, now.frame, now.config, now.speed_m_s, now.now_s)


def distance_fault(home: LatLon, frame: LocalFrame | None) -> str:
    """Why this is no home for the boat where it is; empty when it is one, or that is not known yet."""
    if frame is None or math.hypot(*frame.to_local(home)) <= MAX_OFFSET_M:
        return ""
    return f"more than {MAX_OFFSET_M / 1e3:.0f} km away"


def station_of(intent: Intent, now: Situation) -> LatLon:
    """Where an intent keeps station, else where the boat is."""
    return now.frame.to_global(intent.point) if isinstance(intent, KeepStation) else now.here
