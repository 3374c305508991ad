"""The vehicle: mode, arming, home, mission and failsafes. Requests go in, an intent comes out each tick."""

import math
from collections.abc import Sequence

from companion.config import BoatConfig
from companion.estimation.health import lacks_heading, lacks_position
from companion.geo import LatLon, LocalFrame, Point
from companion.requests import ACCEPTED, Outcome, Request
from companion.sensors.readings import BatteryReading, GnssFix
from companion.state import NavState
from companion.vehicle.arming import PreArmReport, arming_faults
from companion.vehicle.clearing import Clearing
from companion.vehicle.conduct import Conduct, station_of
from companion.vehicle.failsafes.actions import RETREATS, WAYS_HOME, Action
from companion.vehicle.failsafes.failsafes import Alarm, Failsafes
from companion.vehicle.failsafes.ladder import Move
from companion.vehicle.failsafes.power import shortfall
from companion.vehicle.fence import Fence, FenceArea
from companion.vehicle.intent import Intent, Stop
from companion.vehicle.mission_steps import Mission
from companion.vehicle.modes import Mode
from companion.vehicle.motor_probe import MotorProbe
from companion.vehicle.notice import Notice, Severity
from companion.vehicle.orders import carry_out
from companion.vehicle.situation import Situation

_STOP = Stop()
_RANGE_S = 1.0  # how often the charge is held against the way home
_DRIFT_S = 60.0  # clearing the propellers and trying the motors, twice over, and getting under way again
_NO_HEADING = "no heading"
_LIMP_SHARE = 0.5  # of cruise speed: what a propeller with weed, or a cool head, still manages


class Vehicle:
    """What the boat is doing and why. Knows neither wire nor hardware."""

    def __init__(self, config: BoatConfig) -> None:
        self.config = config  # replaced by the owner whenever a parameter changes
        self.mode = Mode.HOLD
        self.armed = False
        self.home: LatLon | None = None
        self.fence = Fence()
        self.conduct = Conduct(self.fence)
        self.progress = self.conduct.progress
        self.failsafes = Failsafes(config, self.conduct.sticks)
        self.operator = self.failsafes.signs.operator
        self.planner = self.failsafes.signs.planner
        self.clearing = Clearing()
        self.probe = MotorProbe()
        self.speed_m_s: float | None = None  # asked for by the operator; None: cruise speed
        self.nav: NavState | None = None
        self.frame: LocalFrame | None = None
        self.fix: GnssFix | None = None
        self.battery: BatteryReading | None = None
        self.standing_order = False  # the boat is about to arm itself; any mode or disarming ends that
        self._range_due_s = 0.0
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
        if nav is not None and frame is not None:
            self.conduct.prepare(frame, self.home, self.config, nav)

    def decide(self) -> Intent:
        """What to sail now. Runs the failsafes first."""
        if self.failsafes.is_due(self._now_s):
            self._watch()
        if not self.armed:
            for fault in self._pre_arm.update(self.arming_faults, self._now_s):
                self.tell(Severity.CRITICAL, f"PreArm: {fault}")
            return _STOP
        now = self._situation()
        if now is not None and not lacks_position(now.nav, self.config.motors.estimate_timeout_s):
            self.conduct.record(self.mode, now)
        if self.clearing.is_running:
            return self._clear()
        if self.probe.is_running:
            return self._try_motors()
        if self.mode is Mode.MANUAL:
            return self.conduct.sticks.intent(self.mode, self.config, self._now_s)
        if self.mode is Mode.HOLD or now is None:
            return _STOP
        if self.probe.is_due(self._now_s):
            self.probe.begin(self._now_s)
        intent = self.conduct.decide(self.mode, now)
        if self.mode is Mode.AUTO:
            for position in self.progress.take_homes():
                self.set_home(position)
            if self.progress.finished:
                return self._end_mission(intent, now)
        return intent

    def _clear(self) -> Intent:
        intent = self.clearing.intent(self._now_s)
        if self.probe.is_lame and not self.clearing.is_running:
            self.probe.begin(self._now_s)  # has it helped?
        return intent

    def _try_motors(self) -> Intent:
        intent = self.probe.intent(self.nav, self._now_s)
        if not self.probe.is_running:
            self.tell(Severity.WARNING, self.probe.found())
            self.failsafes.signs.lame = self.probe.fault()
            motors = self.failsafes.signs.motors
            motors.heeds_current = self.probe.is_lame or self.probe.is_turned
            motors.reset()
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
        return carry_out(request, self, self._now_s)

    def take_mission(self, mission: Mission) -> None:
        """Swap in a new mission. In AUTO the boat sails on if nothing up to here has changed, else it goes
        straight to the new first item.
        """
        goes_on = self.progress.replace(mission)
        if self.mode is Mode.AUTO and self.progress.is_empty:
            self.enter(Mode.LOITER, "mission cleared")
        elif self.mode is Mode.AUTO and self.armed:
            what = f"goes on with item {self.progress.current_seq}" if goes_on else "begins at item 1"
            self.tell(Severity.INFO, f"New mission {what}")

    def take_fence(self, areas: Sequence[FenceArea]) -> None:
        """Swap in a new fence; it counts at once."""
        self.fence.take(areas)
        self.fence.lay(self.frame, self.home, self.config.fence)

    def take_rally(self, places: Sequence[LatLon]) -> None:
        """Swap in new rally points; the way home leads to the nearest of them and home."""
        self.conduct.way_home.rally = tuple(places)

    def home_distance_m(self, point: Point) -> float:
        """How far it is home by the water; infinite where there is no way."""
        return self.conduct.way_home.home_distance_m(point)

    def choose(self, mode: Mode) -> Outcome:
        """Somebody chooses a mode: failsafes that are active leave it at that."""
        outcome = self.enter(mode)
        if outcome.accepted:
            self.standing_order = False
            self.clearing.stop()
            self.probe.stop()
            self.failsafes.overrule()
        return outcome

    def can_enter(self, mode: Mode) -> bool:
        """Whether the boat could change to a mode that steers by the position."""
        return not (self._estimate_fault() or self._mode_fault(mode))

    def halt(self, why: str, *, disarms: bool) -> None:
        """Something in the program has gone wrong: HOLD, or disarm. Told once, however often it happens."""
        if not self.armed or (self.mode is Mode.HOLD and not disarms):
            return
        self.tell(Severity.CRITICAL, f"{why}, motors off")
        self.clearing.stop()
        self.probe.stop()
        if disarms:
            self.disarm("by the program")
        else:
            self._enter(Mode.HOLD, "fault")

    def enter(self, mode: Mode, why: str = "") -> Outcome:
        """Change mode if the boat can, and say why not if it cannot. The present mode just goes on."""
        if mode.needs_position and (fault := self._estimate_fault() or self._mode_fault(mode)):
            return self.refuse(f"{mode.name}: {fault}")
        return self._enter(mode, why)

    def _enter(self, mode: Mode, why: str) -> Outcome:
        if mode is not self.mode:
            self.mode = mode
            self.speed_m_s = None
            self.tell(Severity.INFO, f"Mode {mode.name}{': ' + why if why else ''}")
            self.conduct.begin(mode, self._situation())
        return ACCEPTED

    def arming_faults(self) -> list[str]:
        """Why the boat would not arm now; empty when it would."""
        config = self.config
        faults = arming_faults(config.arming, config.motors, self.mode, self.nav, self.fix, self.battery)
        if config.arming.check and self.nav is not None and self.fence.is_outside(self.nav.point):
            faults.append("Fence: the boat is outside")
        return faults

    def active_position(self) -> LatLon | None:
        """Where the boat is heading: the current waypoint or target, None when it steers for none."""
        return self.conduct.aim(self.mode)

    # How

    def _situation(self) -> Situation | None:
        if self.nav is None or self.frame is None:
            return None
        speed_m_s = self.speed_m_s or self.config.speed.cruise_m_s
        return Situation(self.nav, self.frame, self.config, self.home, speed_m_s, self._now_s)

    def _estimate_fault(self) -> str:
        """Why the boat cannot steer by its position; empty when it can."""
        if self.nav is None or self.frame is None:
            return "no position yet"
        if lacks_position(self.nav, self.config.motors.estimate_timeout_s):
            return "position is stale"
        return _NO_HEADING if lacks_heading(self.nav, self.config.motors.estimate_timeout_s) else ""

    def _mode_fault(self, mode: Mode) -> str:
        now = self._situation()
        return "" if now is None or mode is self.mode else self.conduct.fault(mode, now)

    def _end_mission(self, intent: Intent, now: Situation) -> Intent:
        self.tell(Severity.NOTICE, "Mission complete")
        if self.progress.go_home:
            self.enter(Mode.RTL, "mission item")
            return self.conduct.decide(self.mode, now)
        if self.config.mission.done_behave == 0:
            self.enter(Mode.HOLD, "mission complete")
            return _STOP
        self.enter(Mode.LOITER, "mission complete")
        self.conduct.passage.stay(station_of(intent, now))
        return intent

    def arm(self, force: bool) -> Outcome:
        if self.armed:
            return ACCEPTED
        faults = [] if force else self.arming_faults()
        if faults:
            for fault in faults:
                self.tell(Severity.CRITICAL, f"Arm: {fault}")
            return Outcome(False, faults[0])
        self.armed = True
        now = self._situation()
        if not self._home_is_chosen and now is not None:
            self.home = now.here
        self.conduct.sticks.release()
        self.conduct.trail.begin(None if self._estimate_fault() or self.nav is None else self.nav.point)
        self.conduct.begin(self.mode, now)
        self.tell(Severity.INFO, "Armed")
        return ACCEPTED

    def disarm(self, reason: str) -> Outcome:
        self.standing_order = False
        if self.armed:
            self.armed = False
            self.clearing.stop()
            self.probe.reset()
            self.failsafes.signs.lame = ""
            self.failsafes.signs.motors.heeds_current = True
            self.tell(Severity.INFO, f"Disarmed {reason}")
        return ACCEPTED

    def set_home(self, position: LatLon | None) -> Outcome:
        if position is None:
            now = self._situation()
            if now is None:
                return self.refuse("Home: no position yet")
            position = now.here
        self.home, self._home_is_chosen = position, True
        return ACCEPTED

    def tell(self, severity: int, text: str) -> None:
        self._notices.append(Notice(severity, text))

    def refuse(self, reason: str) -> Outcome:
        self.tell(Severity.WARNING, reason)
        return Outcome(False, reason)

    # Failsafes

    def _watch(self) -> None:
        """Let the failsafes look, and do what they ask."""
        signs, nav = self.failsafes.signs, self.nav
        signs.now_s, signs.config, signs.mode, signs.armed = self._now_s, self.config, self.mode, self.armed
        signs.nav, signs.fix, signs.battery = nav, self.fix, self.battery
        signs.is_guided = self.conduct.is_guided(self.mode)
        if self._now_s >= self._range_due_s:
            self._range_due_s = self._now_s + _RANGE_S
            signs.home = None if self.home is None or self.frame is None else self.frame.to_local(self.home)
            signs.home_distance_m = math.inf if nav is None else self.home_distance_m(nav.point)
            signs.shortfall = shortfall(signs)
        signs.fence.update(self.fence, nav, self.config.motors, self._now_s)
        for alarm in self.failsafes.update(self.clearing.is_running or self.probe.is_running):
            self._act_on(alarm)

    def _act_on(self, alarm: Alarm) -> None:
        action, row = alarm.action, alarm.ladder.row
        if alarm.move is Move.ENDS:
            if alarm.text:
                self.tell(Severity.NOTICE, f"Failsafe over: {alarm.text}")
            return
        does_nothing = not self.armed or self.mode is Mode.HOLD or action is Action.NONE
        if alarm.move is Move.CLIMBS and does_nothing and action is not Action.DISARM:
            return
        still = ", still" if alarm.move is Move.CLIMBS else ""
        severity = Severity.WARNING if action is Action.NONE else Severity.CRITICAL
        self.tell(severity, f"Failsafe: {alarm.text}{still}")
        if action is Action.CLEAR_PROPELLERS and self.probe.is_turned:
            action = Action.TRY_MOTORS  # what was turned round may be right again
        if action is Action.DISARM:
            self.disarm("by failsafe")
        elif does_nothing:
            return
        elif action is Action.CLEAR_PROPELLERS and self.probe.is_lame and not self._may_drift():
            return  # sailing with one motor is all that keeps it off
        elif action is Action.CLEAR_PROPELLERS:
            self.tell(Severity.WARNING, "Clearing the propellers")
            self.clearing.begin(self._now_s)
        elif action is Action.TRY_MOTORS:
            self.tell(Severity.WARNING, "Trying the motors")
            self.clearing.stop()
            self.probe.begin(self._now_s)
        elif not (row.spares_way_home and self.mode in WAYS_HOME and action is not Action.HOLD):
            self._retreat(action)
            if row.limps:
                self.speed_m_s = _LIMP_SHARE * self.config.speed.cruise_m_s

    def _may_drift(self) -> bool:
        """Whether the water carries the boat over no line while it clears its propellers."""
        nav = self.nav
        if nav is None:
            return True
        drift_m = _DRIFT_S * math.hypot(nav.set_north_m_s, nav.set_east_m_s)
        course = math.atan2(nav.set_east_m_s, nav.set_north_m_s)
        return self.fence.room_m(nav.point, course, drift_m) >= drift_m

    def _retreat(self, action: Action) -> None:
        """The first mode of an action that can be entered; without a position, LOITER by dead reckoning."""
        self.clearing.stop()
        self.probe.stop()
        for mode in RETREATS[action]:
            if mode is Mode.LOITER and self._estimate_fault() and self._can_reckon():
                self._enter(mode, "failsafe, by dead reckoning")
                return
            if mode is Mode.LOITER and self._estimate_fault() == _NO_HEADING:
                self._enter(mode, "failsafe, adrift until there is a heading")
                return
            if self.enter(mode, "failsafe").accepted:
                return
        self.enter(Mode.HOLD, "failsafe")

    def _can_reckon(self) -> bool:
        nav, timeout_s = self.nav, self.config.motors.estimate_timeout_s
        return nav is not None and self.frame is not None and not lacks_heading(nav, timeout_s)
