"""The vehicle: mode, arming, home, mission and failsafes. Requests go in, an intent comes out each tick."""

from collections.abc import Sequence

from companion.config import BoatConfig
from companion.geo import LatLon, LocalFrame
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
    SetPoint,
    Sighting,
    StartMission,
)
from companion.sensors.readings import BatteryReading, GnssFix
from companion.state import NavState
from companion.vehicle.arming import PreArmReport, arming_faults
from companion.vehicle.conduct import Conduct, station_of
from companion.vehicle.failsafe import RETREATS, Action, Alarm, BatteryWatch, OperatorWatch
from companion.vehicle.fence import Fence, FenceArea
from companion.vehicle.intent import Intent, Stop
from companion.vehicle.mission_steps import Mission
from companion.vehicle.modes import Mode, mode_from_number
from companion.vehicle.notice import Notice, Severity
from companion.vehicle.situation import Situation

_STOP = Stop()
_NOT_GUIDED = Outcome(False, "not in GUIDED")


class Vehicle:
    """What the boat is doing and why. Knows neither wire nor hardware."""

    def __init__(self, config: BoatConfig) -> None:
        self.config = config  # replaced by the owner whenever a parameter changes
        self.mode = Mode.HOLD
        self.armed = False
        self.home: LatLon | None = None
        self.fence = Fence()
        self.conduct = Conduct()
        self.progress = self.conduct.progress
        self.operator = OperatorWatch()
        self.battery_watch = BatteryWatch()
        self.speed_m_s: float | None = None  # asked for by the operator; None: cruise speed
        self.nav: NavState | None = None
        self.frame: LocalFrame | None = None
        self.fix: GnssFix | None = None
        self.battery: BatteryReading | None = None
        self._home_is_chosen = False
        self._pre_arm = PreArmReport()
        self._notices = self.conduct.notices
        self._now_s = 0.0

    @property
    def target(self) -> LatLon | None:
        """Where GUIDED or RTL is under way to; None once there."""
        return self.conduct.passage.target

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
        self.fence.lay(frame, self.home, self.config.fence)

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
                self._tell(Severity.CRITICAL, f"PreArm: {fault}")
            return _STOP
        now = self._situation()
        if now is not None and now.nav.position_age_s <= self.config.motors.estimate_timeout_s:
            self.conduct.record(self.mode, now)
        if self.mode is Mode.MANUAL:
            return self.conduct.sticks.intent(self.mode, self.config, self._now_s)
        if self.mode is Mode.HOLD or now is None:
            return _STOP
        intent = self.conduct.decide(self.mode, now)
        if self.mode is Mode.AUTO:
            for position in self.progress.take_homes():
                self._set_home(position)
            if self.progress.finished:
                return self._end_mission(intent, now)
        return intent

    def take_notices(self) -> list[Notice]:
        """Lines for the operator since the last call."""
        if not self._notices:
            return []
        notices = self._notices.copy()
        self._notices.clear()
        return notices

    # What stations ask

    def request(self, request: Request) -> Outcome:
        """Carry out a request, at once or not at all."""
        match request:
            case ManualInput():
                self.conduct.sticks.take(request, self._now_s)
                return ACCEPTED
            case SetPoint():
                return self._hold(request)
            case Sighting():
                is_lead = self.conduct.following.sight(request, self.config.follow, self._now_s)
                return ACCEPTED if is_lead else Outcome(False, "not the one to follow")
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
            case SetCurrentItem():
                return self._set_current(request)
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

    def take_mission(self, mission: Mission) -> None:
        """Swap in a new mission. In AUTO the boat sails on if nothing up to here has changed, else it goes
        straight to the new first item.
        """
        goes_on = self.progress.replace(mission)
        if self.mode is Mode.AUTO and self.progress.is_empty:
            self.enter(Mode.LOITER, "mission cleared")
        elif self.mode is Mode.AUTO and self.armed:
            what = f"goes on with item {self.progress.current_seq}" if goes_on else "begins at item 1"
            self._tell(Severity.INFO, f"New mission {what}")

    def take_fence(self, areas: Sequence[FenceArea]) -> None:
        """Swap in a new fence; it counts at once."""
        self.fence.take(areas)
        self.fence.lay(self.frame, self.home, self.config.fence)

    def enter(self, mode: Mode, why: str = "") -> Outcome:
        """Change mode if the boat can, and say why not if it cannot. The present mode just goes on."""
        if mode.needs_position and (fault := self._position_fault() or self._mode_fault(mode)):
            return self._refuse(f"{mode.name}: {fault}")
        if mode is not self.mode:
            self.mode = mode
            self.speed_m_s = None
            self._tell(Severity.INFO, f"Mode {mode.name}{': ' + why if why else ''}")
            self.conduct.begin(mode, self._situation())
        return ACCEPTED

    def arming_faults(self) -> list[str]:
        """Why the boat would not arm now; empty when it would."""
        config = self.config
        return arming_faults(config.arming, config.motors, self.mode, self.nav, self.fix, self.battery)

    def active_position(self) -> LatLon | None:
        """Where the boat is heading: the current waypoint or target, None when it steers for none."""
        return self.conduct.aim(self.mode)

    # How

    def _situation(self) -> Situation | None:
        if self.nav is None or self.frame is None:
            return None
        speed_m_s = self.speed_m_s or self.config.speed.cruise_m_s
        return Situation(self.nav, self.frame, self.config, self.home, speed_m_s, self._now_s)

    def _position_fault(self) -> str:
        """Why the boat cannot steer by its position; empty when it can."""
        if self.nav is None or self.frame is None:
            return "no position yet"
        stale = self.nav.position_age_s > self.config.motors.estimate_timeout_s
        return "position is stale" if stale else ""

    def _mode_fault(self, mode: Mode) -> str:
        now = self._situation()
        return "" if now is None or mode is self.mode else self.conduct.fault(mode, now)

    def _end_mission(self, intent: Intent, now: Situation) -> Intent:
        self._tell(Severity.NOTICE, "Mission complete")
        if self.progress.go_home:
            self.enter(Mode.RTL, "mission item")
            return self.conduct.decide(self.mode, now)
        if self.config.mission.done_behave == 0:
            self.enter(Mode.HOLD, "mission complete")
            return _STOP
        self.enter(Mode.LOITER, "mission complete")
        self.conduct.passage.stay(station_of(intent, now))
        return intent

    def _arm(self, force: bool) -> Outcome:
        if self.armed:
            return ACCEPTED
        faults = [] if force else self.arming_faults()
        if faults:
            for fault in faults:
                self._tell(Severity.CRITICAL, f"Arm: {fault}")
            return Outcome(False, faults[0])
        self.armed = True
        now = self._situation()
        if not self._home_is_chosen and now is not None:
            self.home = now.here
        self.conduct.sticks.release()
        self.conduct.trail.begin(None if self._position_fault() or self.nav is None else self.nav.point)
        self.conduct.begin(self.mode, now)
        self._tell(Severity.INFO, "Armed")
        return ACCEPTED

    def _disarm(self, reason: str) -> Outcome:
        if self.armed:
            self.armed = False
            self._tell(Severity.INFO, f"Disarmed {reason}")
        return ACCEPTED

    def _start_mission(self, first_seq: int | None) -> Outcome:
        if first_seq is not None and not self.progress.set_current(max(first_seq, 1)):
            return self._refuse(f"Mission has no item {first_seq} (last is {self.progress.last_seq})")
        return self.enter(Mode.AUTO)

    def _set_current(self, request: SetCurrentItem) -> Outcome:
        seq = self.progress.current_seq if request.seq is None else request.seq
        is_named_or_over = request.seq is not None or self.progress.finished
        if is_named_or_over and not self.progress.set_current(seq):
            return self._refuse(f"Mission has no item {seq} (last is {self.progress.last_seq})")
        if request.reset:
            self.progress.forget_jumps()
        return ACCEPTED

    def _go_to(self, request: GoTo) -> Outcome:
        if not self.conduct.is_guided(self.mode):
            if not request.change_mode:
                return self._refuse("Go to: not in GUIDED")
            outcome = self.enter(Mode.GUIDED)
            if not outcome.accepted:
                return outcome
        if request.speed_m_s is not None:
            self.speed_m_s = request.speed_m_s
        self.conduct.go(request.position)
        return ACCEPTED

    def _hold(self, set_point: SetPoint) -> Outcome:
        if not self.conduct.is_guided(self.mode):
            return _NOT_GUIDED
        self.conduct.hold(set_point, self._now_s)
        return ACCEPTED

    def _set_home(self, position: LatLon | None) -> Outcome:
        if position is None:
            now = self._situation()
            if now is None:
                return self._refuse("Home: no position yet")
            position = now.here
        self.home, self._home_is_chosen = position, True
        return ACCEPTED

    def _tell(self, severity: int, text: str) -> None:
        self._notices.append(Notice(severity, text))

    def _refuse(self, reason: str) -> Outcome:
        self._tell(Severity.WARNING, reason)
        return Outcome(False, reason)

    def _act_on(self, alarm: Alarm) -> None:
        self._tell(Severity.CRITICAL, f"Failsafe: {alarm.text}")
        if alarm.action is Action.DISARM:
            self._disarm("by failsafe")
        elif not self.armed or self.mode is Mode.HOLD or alarm.action is Action.NONE:
            return
        elif alarm.action is Action.LOITER_OR_HOLD and self.mode in (Mode.RTL, Mode.SMART_RTL):
            return  # a boat on its way home goes on
        elif not any(self.enter(mode, "failsafe").accepted for mode in RETREATS[alarm.action]):
            self.enter(Mode.HOLD, "failsafe")
