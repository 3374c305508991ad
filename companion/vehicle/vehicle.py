"""The vehicle: mode, arming, home, mission and failsafes. Requests go in, an intent comes out each tick."""

from companion.config import BoatConfig
from companion.geo import LatLon, LocalFrame, Point
from companion.requests import (
    ACCEPTED,
    Arm,
    ChangeMode,
    ChangeSpeed,
    Disarm,
    GoTo,
    ManualInput,
    Outcome,
    Request,
    SetCurrentItem,
    SetHome,
    StartMission,
)
from companion.sensors.readings import BatteryReading, GnssFix
from companion.state import NavState
from companion.vehicle.arming import PreArmReport, arming_faults
from companion.vehicle.failsafe import Action, Alarm, BatteryWatch, OperatorWatch
from companion.vehicle.intent import Drive, Intent, KeepStation, Stop
from companion.vehicle.leg import Leg
from companion.vehicle.mission_progress import MissionProgress
from companion.vehicle.mission_steps import Mission, Waypoint
from companion.vehicle.modes import Mode, mode_from_number
from companion.vehicle.notice import Notice, Severity


class Vehicle:
    """What the boat is doing and why. Knows neither wire nor hardware."""

    def __init__(self, config: BoatConfig) -> None:
        self.config = config  # replaced by the owner whenever a parameter changes
        self.mode = Mode.HOLD
        self.armed = False
        self.home: LatLon | None = None
        self.progress = MissionProgress()
        self.operator = OperatorWatch()
        self.battery_watch = BatteryWatch()
        self.target: LatLon | None = None  # GUIDED's
        self.speed_m_s: float | None = None  # asked for by the operator; None: cruise speed
        self.nav: NavState | None = None
        self.frame: LocalFrame | None = None
        self.fix: GnssFix | None = None
        self.battery: BatteryReading | None = None
        self._home_is_chosen = False
        self._manual = ManualInput(0.0, 0.0)
        self._manual_s = -1e9
        self._station: LatLon | None = None
        self._leg: Leg | None = None  # towards the target
        self._pre_arm = PreArmReport()
        self._notices: list[Notice] = []
        self._now_s = 0.0

    # What the owner calls each tick

    def sense(
        self,
        nav: NavState | None,
        frame: LocalFrame | None,
        fix: GnssFix | None,
        battery: BatteryReading | None,
        now_s: float,
    ) -> None:
        """Take the tick's knowledge of the world, before requests and `decide`."""
        self.nav, self.frame, self.fix, self.battery, self._now_s = nav, frame, fix, battery, now_s
        if self.home is None and nav is not None and frame is not None:
            self.home = frame.to_global(nav.point)

    def decide(self) -> Intent:
        """What to sail now. Runs the failsafes first."""
        for alarm in (
            self.operator.update(self.config.failsafe, self._now_s),
            self.battery_watch.update(self.config.failsafe, self.battery, self._now_s),
        ):
            if alarm is not None:
                self._act_on(alarm)
        if not self.armed:
            for fault in self._pre_arm.update(self.arming_faults, self._now_s):
                self._notices.append(Notice(Severity.CRITICAL, f"PreArm: {fault}"))
            return Stop()
        nav, frame = self.nav, self.frame
        if self.mode is Mode.MANUAL:
            stale = self._now_s - self._manual_s > self.config.failsafe.manual_timeout_s
            return Stop() if stale else Drive(self._manual.throttle, self._manual.steering)
        if self.mode is Mode.HOLD or nav is None or frame is None:
            return Stop()
        if self.mode is Mode.AUTO:
            return self._sail_mission(nav, frame)
        if self.mode is Mode.LOITER:
            return KeepStation(self._station_point(nav, frame))
        return self._sail_to_target(nav, frame)

    def take_notices(self) -> list[Notice]:
        """Lines for the operator since the last call."""
        notices, self._notices = self._notices, []
        return notices

    # What stations ask

    def request(self, request: Request) -> Outcome:
        """Carry out a request, at once or not at all."""
        match request:
            case Arm(force):
                return self._arm(force)
            case Disarm(reason):
                return self._disarm(reason)
            case ChangeMode(number):
                mode = mode_from_number(number)
                if mode is None:
                    return self._refuse(f"Mode {number} is not available on this boat")
                return self.enter(mode)
            case StartMission(first_seq):
                return self._start_mission(first_seq)
            case SetCurrentItem(seq):
                if not self.progress.set_current(seq):
                    return self._refuse(f"Mission has no item {seq} (last is {self.progress.last_seq})")
                return ACCEPTED
            case GoTo():
                return self._go_to(request)
            case ChangeSpeed(speed_m_s):
                if self.mode is Mode.AUTO:
                    self.progress.speed_m_s = speed_m_s
                else:
                    self.speed_m_s = speed_m_s
                return ACCEPTED
            case SetHome(position):
                return self._set_home(position)
            case ManualInput():
                self._manual, self._manual_s = request, self._now_s
                return ACCEPTED

    def take_mission(self, mission: Mission) -> None:
        """Swap in a new mission. In AUTO the boat goes straight on to the new first item."""
        self.progress.replace(mission)
        if self.mode is Mode.AUTO and self.progress.is_empty:
            self.enter(Mode.LOITER, "mission cleared")

    def enter(self, mode: Mode, why: str = "") -> Outcome:
        """Change mode if the boat can, and say why not if it cannot. The present mode just goes on."""
        if mode.needs_position and (fault := self._position_fault()):
            return self._refuse(f"{mode.name}: {fault}")
        if mode is Mode.AUTO and self.progress.is_empty:
            return self._refuse("AUTO: no mission")
        if mode is Mode.RTL and self.home is None:
            return self._refuse("RTL: no home")
        if mode is not self.mode:
            self.mode = mode
            self.speed_m_s = None
            self._notices.append(Notice(Severity.INFO, f"Mode {mode.name}{': ' + why if why else ''}"))
            self._begin_mode(mode)
        return ACCEPTED

    def arming_faults(self) -> list[str]:
        """Why the boat would not arm now; empty when it would."""
        config = self.config
        return arming_faults(config.arming, config.motors, self.mode, self.nav, self.fix, self.battery)

    def active_position(self) -> LatLon | None:
        """Where the boat is heading: the current waypoint or target, None when it steers for none."""
        if self.mode is Mode.AUTO and self.progress.current_seq < len(self.progress.mission):
            step = self.progress.mission[self.progress.current_seq]
            return step.position if isinstance(step, Waypoint) else None
        if self.mode in (Mode.GUIDED, Mode.RTL, Mode.LOITER):
            return self.target or self._station
        return None

    # How

    def _position_fault(self) -> str:
        """Why the boat cannot steer by its position; empty when it can."""
        if self.nav is None or self.frame is None:
            return "no position yet"
        stale = self.nav.position_age_s > self.config.motors.estimate_timeout_s
        return "position is stale" if stale else ""

    def _begin_mode(self, mode: Mode) -> None:
        self._leg = None
        here = self.frame.to_global(self.nav.point) if self.nav and self.frame else None
        if mode is Mode.AUTO:
            if self.progress.finished:
                self.progress.restart()
            self.progress.resume()
        elif mode is Mode.RTL:
            self.target = self.home
        elif mode in (Mode.LOITER, Mode.GUIDED):
            self._station, self.target = here, None

    def _sail_mission(self, nav: NavState, frame: LocalFrame) -> Intent:
        cruise_m_s = self.config.speed.cruise_m_s
        intent = self.progress.update(nav, frame, self.config.guidance, cruise_m_s, self._now_s)
        if self.progress.finished:
            station = intent.point if isinstance(intent, KeepStation) else nav.point
            self._notices.append(Notice(Severity.NOTICE, "Mission complete"))
            if self.progress.go_home:
                self.enter(Mode.RTL, "mission item")
                return self._sail_to_target(nav, frame)
            if self.config.mission.done_behave == 0:
                self.enter(Mode.HOLD, "mission complete")
                return Stop()
            self.enter(Mode.LOITER, "mission complete")
            self._station = frame.to_global(station)
        return intent

    def _sail_to_target(self, nav: NavState, frame: LocalFrame) -> Intent:
        """GUIDED and RTL: sail to the target, then keep station there."""
        if self.target is None:
            return KeepStation(self._station_point(nav, frame))
        if self._leg is None:
            self._leg = Leg(nav.point, frame.to_local(self.target))
        if self._leg.has_ended(nav, self.config.guidance.waypoint_radius_m):
            self._station, self.target = self.target, None
            self._notices.append(Notice(Severity.INFO, f"{self.mode.name}: arrived"))
            return KeepStation(self._leg.end)
        speed_m_s = self.speed_m_s or self.config.speed.cruise_m_s
        if self.mode is Mode.RTL:
            speed_m_s = self.config.mission.rtl_speed_m_s or speed_m_s
        return self._leg.intent(speed_m_s)

    def _station_point(self, nav: NavState, frame: LocalFrame) -> Point:
        if self._station is None:
            self._station = frame.to_global(nav.point)
        return frame.to_local(self._station)

    def _arm(self, force: bool) -> Outcome:
        if self.armed:
            return ACCEPTED
        faults = [] if force else self.arming_faults()
        if faults:
            for fault in faults:
                self._notices.append(Notice(Severity.CRITICAL, f"Arm: {fault}"))
            return Outcome(False, faults[0])
        self.armed = True
        if not self._home_is_chosen and self.nav and self.frame:
            self.home = self.frame.to_global(self.nav.point)
        self._manual_s = -1e9
        self._begin_mode(self.mode)
        self._notices.append(Notice(Severity.INFO, "Armed"))
        return ACCEPTED

    def _disarm(self, reason: str) -> Outcome:
        if self.armed:
            self.armed = False
            self._notices.append(Notice(Severity.INFO, f"Disarmed {reason}"))
        return ACCEPTED

    def _start_mission(self, first_seq: int | None) -> Outcome:
        if first_seq is not None and not self.progress.set_current(max(first_seq, 1)):
            return self._refuse(f"Mission has no item {first_seq} (last is {self.progress.last_seq})")
        return self.enter(Mode.AUTO)

    def _go_to(self, request: GoTo) -> Outcome:
        if self.mode is not Mode.GUIDED:
            if not request.change_mode:
                return self._refuse("Go to: not in GUIDED")
            outcome = self.enter(Mode.GUIDED)
            if not outcome.accepted:
                return outcome
        if request.speed_m_s is not None:
            self.speed_m_s = request.speed_m_s
        self.target, self._leg = request.position, None
        return ACCEPTED

    def _set_home(self, position: LatLon | None) -> Outcome:
        if position is None:
            if self.nav is None or self.frame is None:
                return self._refuse("Home: no position yet")
            position = self.frame.to_global(self.nav.point)
        self.home, self._home_is_chosen = position, True
        return ACCEPTED

    def _refuse(self, reason: str) -> Outcome:
        self._notices.append(Notice(Severity.WARNING, reason))
        return Outcome(False, reason)

    def _act_on(self, alarm: Alarm) -> None:
        self._notices.append(Notice(Severity.CRITICAL, f"Failsafe: {alarm.text}"))
        if alarm.action is Action.DISARM:
            self._disarm("by failsafe")
        elif not self.armed or self.mode is Mode.HOLD:
            return
        elif alarm.action in (Action.RTL, Action.SMART_RTL_OR_RTL):
            self._retreat(Mode.RTL)
        elif alarm.action in (Action.HOLD, Action.SMART_RTL_OR_HOLD):
            self._retreat(Mode.HOLD)
        elif alarm.action is Action.LOITER_OR_HOLD and self.mode is not Mode.RTL:
            self._retreat(Mode.LOITER)  # a boat on its way home goes on

    def _retreat(self, mode: Mode) -> None:
        if not self.enter(mode, "failsafe").accepted:
            self.enter(Mode.HOLD, "failsafe")
