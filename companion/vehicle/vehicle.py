"""The vehicle: mode, arming, home, mission and failsafes. Requests go in, an intent comes out each tick."""

from collections.abc import Sequence

from companion.config.boat_config import BoatConfig
from companion.core.geo import LatLon, LocalFrame, Point
from companion.core.health import lacks_heading, lacks_position
from companion.core.intent import Intent, KeepStation, Stop
from companion.core.modes import Mode
from companion.core.requests import ACCEPTED, Outcome, Request
from companion.core.state import NavState
from companion.core.status_text import Severity, StatusText
from companion.core.vehicle_status import VehicleStatus
from companion.failsafe.guards import may_drift
from companion.failsafe.inputs import BoardReadings
from companion.failsafe.monitor import Failsafes
from companion.failsafe.recovery.recovery import RecoveryManeuvers
from companion.failsafe.recovery.transition_table import Trigger
from companion.failsafe.response import RECHECK_DRIFT_S
from companion.geofence.fence import Fence, FenceArea
from companion.persistence.losses import FENCE, Losses
from companion.rc.manual_input import ManualInput
from companion.sensors.readings import BatteryReading, GnssFix
from companion.vehicle.arming import PreArmReport, arming_faults, radio_fault
from companion.vehicle.commands import execute
from companion.vehicle.failsafes import NO_HEADING, run_failsafes, run_recovery
from companion.vehicle.mission.progress import MissionProgress
from companion.vehicle.mission.steps import Mission
from companion.vehicle.modes.controller import ModeInputs
from companion.vehicle.modes.registry import ModeRegistry
from companion.vehicle.modes.rtl import home_fault
from companion.vehicle.return_route import ReturnRoute
from companion.vehicle.track import SailedTrack

_STOP = Stop()
_RESTARTING = "Program: restarting"


class Vehicle:
    """What the boat is doing and why. Knows neither wire nor hardware."""

    def __init__(self, config: BoatConfig) -> None:
        self.config = config  # replaced by the owner whenever a parameter changes
        self.mode = Mode.HOLD
        self.armed = False
        self.home: LatLon | None = None
        self.fence = Fence()
        self.manual_input = ManualInput()
        self.track = SailedTrack()
        self.progress = MissionProgress()
        self.status_texts: list[StatusText] = []  # to the operator, until `take_status_texts`
        self._route = ReturnRoute(self.fence, self.status_texts)
        self.modes = ModeRegistry(
            self.fence, self._route, self.progress, self.track, self.manual_input, self.status_texts
        )
        self.failsafes = Failsafes(config, self.manual_input)
        self.operator = self.failsafes.operator
        self.planner = self.failsafes.planner
        self.recovery = RecoveryManeuvers()
        self.board = BoardReadings()  # replaced by the owner before each cycle of the failsafes
        self.speed_m_s: float | None = None  # asked for by the operator; None: cruise speed
        self.nav: NavState | None = None
        self.frame: LocalFrame | None = None
        self.fix: GnssFix | None = None
        self.battery: BatteryReading | None = None
        self.is_returning_from_mission = False  # RTL is the mission's last item, and it is under way
        self.is_restarting = False  # the program is about to begin anew: it does not arm any more
        self.is_resuming = False  # it is about to arm itself, or to go on; any mode or disarming ends that
        self.losses = Losses()
        self._home_is_chosen = False
        self._pre_arm = PreArmReport()
        self._now_s = 0.0

    @property
    def target(self) -> LatLon | None:
        """Where GUIDED is sailing to; None once there."""
        return self.modes.guided.target

    @property
    def status(self) -> VehicleStatus:
        """What other parts of the boat depend on, for this tick."""
        recovery = self.recovery
        return VehicleStatus(
            self.mode,
            self.armed,
            self.failsafes.active,
            self.modes.loiter.needs_position,
            recovery.is_ungrounding,
            recovery.is_checking,
            recovery.motor_check.motors,
            self.is_restarting,
        )

    # What the owner calls each tick

    def update_state(
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
        self.fence.update(frame, self.home, self.config.fence)
        if nav is not None and frame is not None:
            self._route.prepare(frame, self.home, self.config, nav)
            self.modes.auto.prepare(frame)

    def reset_position(self, far_m: float) -> None:
        """The boat was carried so far that positions are measured from another origin. Disarmed only."""
        self.notify(Severity.NOTICE, f"Position: {far_m / 1e3:.0f} km away, origin moved here")
        self.track.restart(None)
        if not self._home_is_chosen:
            self.home = None

    def decide(self) -> Intent:
        """What to sail now. Runs the failsafes first."""
        if self.failsafes.is_due(self._now_s):
            run_failsafes(self, self._now_s)
        for text in self.losses.update(self._now_s):
            self.notify(Severity.WARNING, text)
        if not self.armed:
            for fault in self._pre_arm.update(self.arming_faults, self._now_s, self.config.arming.repeat_s):
                self.notify(Severity.CRITICAL, f"PreArm: {fault}")
            return _STOP
        inputs = self._mode_inputs()
        self._record_track()
        if self.recovery.is_active:
            return run_recovery(self, self._now_s)
        if self.mode is Mode.MANUAL:
            return self.modes.manual.drive(self.config, self._now_s)
        if self.mode is Mode.HOLD or inputs is None:
            return _STOP
        check = self.recovery.motor_check
        if check.motors.has_failed:
            has_room = may_drift(self.nav, self.fence, RECHECK_DRIFT_S)
            if check.is_due(self._now_s, has_room=has_room):
                self.recovery.handle(Trigger.CHECK, self._now_s)
        intent = self.modes.controllers[self.mode].intent(inputs)
        if self.is_returning_from_mission and self._route.has_arrived:
            self.is_returning_from_mission = False
            self.notify(Severity.NOTICE, "Mission complete")
        if self.mode is Mode.AUTO:
            for position in self.progress.take_homes():
                self.set_home(position)
            if self.progress.finished:
                return self._end_mission(intent, inputs)
        return intent

    def take_status_texts(self) -> list[StatusText]:
        """Lines for the operator since the last call."""
        if not self.status_texts:
            return []
        status_texts = self.status_texts.copy()
        self.status_texts.clear()
        return status_texts

    # What stations ask

    def request(self, request: Request) -> Outcome:
        """Carry out a request, at once or not at all."""
        return execute(request, self, self._now_s)

    def set_mission(self, mission: Mission) -> None:
        """Swap in a new mission. In AUTO the boat sails on if nothing up to here has changed, else it goes
        straight to the new first item.
        """
        goes_on = self.progress.replace(mission)
        if self.mode is Mode.AUTO and self.progress.is_empty:
            self.change_mode(Mode.LOITER, "mission cleared")
        elif self.mode is Mode.AUTO and self.armed:
            what = f"goes on with item {self.progress.current_seq}" if goes_on else "begins at item 1"
            self.notify(Severity.INFO, f"New mission {what}")

    def set_fence(self, areas: Sequence[FenceArea]) -> None:
        """Swap in a new fence; it counts at once."""
        self.fence.set_areas(areas)
        self.fence.update(self.frame, self.home, self.config.fence)
        self._warn_of_rally_points()

    def set_rally(self, places: Sequence[LatLon]) -> None:
        """Swap in new rally points; the way home leads to the nearest of them and home."""
        self._route.rally = tuple(places)
        self._warn_of_rally_points()

    def _warn_of_rally_points(self) -> None:
        for number, place in enumerate(self._route.rally):
            if self.frame is not None and not self.fence.allows(self.frame.to_local(place)):
                self.notify(Severity.WARNING, f"Rally point {number} is outside the fence")

    def home_distance_m(self, point: Point) -> float:
        """How far it is home by the water; infinite where there is no way."""
        return self._route.home_distance_m(point)

    def select_mode(self, mode: Mode) -> Outcome:
        """Somebody chooses a mode: failsafes that are active leave it at that."""
        outcome = self.change_mode(mode)
        if outcome.accepted:
            self.is_resuming = False
            self.recovery.handle(Trigger.ABORT, self._now_s)
            self.failsafes.overrule()
        return outcome

    def can_enter(self, mode: Mode) -> bool:
        """Whether the boat could change to a mode that steers by the position."""
        return not (self.estimate_fault() or self._mode_fault(mode))

    def stop_on_fault(self, why: str, *, disarms: bool) -> None:
        """Something in the program has gone wrong: HOLD, or disarm. Told once, however often it happens."""
        if not self.armed or (self.mode is Mode.HOLD and not disarms):
            return
        self.notify(Severity.CRITICAL, why)
        self.recovery.handle(Trigger.ABORT, self._now_s)
        if disarms:
            self.disarm("by the program")
        else:
            self.force_mode(Mode.HOLD, "fault")

    def change_mode(self, mode: Mode, why: str = "") -> Outcome:
        """Change mode if the boat can, and say why not if it cannot. The present mode just goes on."""
        if mode.needs_position and (fault := self.estimate_fault() or self._mode_fault(mode)):
            return self.refuse(f"{mode.name}: {fault}")
        return self.force_mode(mode, why)

    def force_mode(self, mode: Mode, why: str) -> Outcome:
        """Change mode, whatever it lacks."""
        if mode is not self.mode:
            self.modes.controllers[self.mode].exit()
            self.mode = mode
            self.is_returning_from_mission = False
            self.speed_m_s = None
            self.notify(Severity.INFO, f"Mode {mode.name}{': ' + why if why else ''}")
            self.modes.controllers[mode].enter(self._mode_inputs())
        return ACCEPTED

    def arming_faults(self) -> list[str]:
        """Why the boat would not arm now; empty when it would."""
        config = self.config
        faults = arming_faults(config.arming, config.motors, self.mode, self.nav, self.fix, self.battery)
        if config.arming.check and self.is_outside and not self.mode.rules.comes_inside:
            faults.append("Fence: the boat is outside; armed in LOITER or RTL it comes back")
        if config.arming.check and self.losses.text(FENCE):
            faults.append("Fence: the stored fence is lost: upload or clear it")
        if fault := radio_fault(self.manual_input, config, self._now_s):
            faults.append(fault)
        if self.is_restarting:
            faults.append(_RESTARTING)
        return faults

    @property
    def is_outside(self) -> bool:
        """Whether the boat is beyond the fence, as far as it knows where it is."""
        return self.nav is not None and self.fence.is_outside(self.nav.point)

    @property
    def is_guided(self) -> bool:
        """Whether another program may steer by set-points."""
        return self.mode is Mode.GUIDED or (self.mode is Mode.AUTO and self.progress.is_handed_over)

    @property
    def has_returned(self) -> bool:
        """Whether RTL has arrived."""
        return self._route.has_arrived

    @property
    def destination(self) -> LatLon | None:
        """Where the boat is heading: the current waypoint or target, None when it steers for none."""
        return self.modes.controllers[self.mode].destination

    # How

    def _mode_inputs(self) -> ModeInputs | None:
        if self.nav is None or self.frame is None:
            return None
        speed_m_s = self.speed_m_s or self.config.speed.cruise_m_s
        return ModeInputs(self.nav, self.frame, self.config, self.home, speed_m_s, self._now_s)

    def estimate_fault(self) -> str:
        """Why the boat cannot steer by its position; empty when it can."""
        if self.nav is None or self.frame is None:
            return "no position yet"
        if lacks_position(self.nav, self.config.motors.estimate_timeout_s):
            return "position is stale"
        return NO_HEADING if lacks_heading(self.nav, self.config.motors.estimate_timeout_s) else ""

    def _record_track(self) -> None:
        """Record the way back; in SMART_RTL it is being sailed."""
        nav, setting = self.nav, self.config.modes
        if nav is None or self.frame is None or lacks_position(nav, self.config.motors.estimate_timeout_s):
            return
        if self.mode is Mode.SMART_RTL:
            self.track.resume_at(nav.point)
        else:
            self.track.add(nav.point, setting.trail_accuracy_m, setting.trail_points)

    def _mode_fault(self, mode: Mode) -> str:
        inputs = self._mode_inputs()
        return "" if inputs is None or mode is self.mode else self.modes.controllers[mode].fault(inputs)

    def _end_mission(self, intent: Intent, inputs: ModeInputs) -> Intent:
        if self.progress.go_home and self.change_mode(Mode.RTL, "mission item").accepted:
            self.is_returning_from_mission = True
            return self.modes.controllers[self.mode].intent(inputs)
        self.notify(Severity.NOTICE, "Mission complete")
        if self.config.mission.done_behave == 0:
            self.change_mode(Mode.HOLD, "mission complete")
            return _STOP
        self.change_mode(Mode.LOITER, "mission complete")
        if isinstance(intent, KeepStation):
            self.modes.loiter.move_to(inputs.frame.to_global(intent.point))
        return intent

    def arm(self, force: bool) -> Outcome:
        if self.armed:
            return ACCEPTED
        faults = self.arming_faults() if not force else [_RESTARTING] if self.is_restarting else []
        if faults:
            for fault in faults:
                self.notify(Severity.CRITICAL, f"Arm: {fault}")
            return Outcome(False, faults[0])
        self.armed = True
        inputs = self._mode_inputs()
        if not self._home_is_chosen and inputs is not None:
            self.home = inputs.position
        self.manual_input.release()
        self.track.restart(None if self.estimate_fault() or self.nav is None else self.nav.point)
        self.modes.controllers[self.mode].enter(inputs)
        self.notify(Severity.INFO, "Armed")
        return ACCEPTED

    def disarm(self, reason: str) -> Outcome:
        self.is_resuming = False
        if self.armed:
            self.armed = False
            self.recovery.reset()
            self.failsafes.motors.rearm()
            self.notify(Severity.INFO, f"Disarmed {reason}")
        return ACCEPTED

    def set_home(self, position: LatLon | None) -> Outcome:
        if position is None:
            inputs = self._mode_inputs()
            if inputs is None:
                return self.refuse("Home: no position yet")
            position = inputs.position
        if fault := home_fault(position, self.frame):
            return self.refuse(f"Home: {fault}")
        self.home, self._home_is_chosen = position, True
        return ACCEPTED

    def notify(self, severity: int, text: str) -> None:
        self.status_texts.append(StatusText(severity, text))

    def refuse(self, reason: str) -> Outcome:
        """Say why a request is not carried out. Stations pop up an error; a warning they only list."""
        self.notify(Severity.ERROR, reason)
        return Outcome(False, reason)
