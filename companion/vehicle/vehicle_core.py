"""The vehicle's state, and how mode and arming change. What commands and failsafes act upon."""

from collections.abc import Callable

from companion.config.boat_config import BoatConfig
from companion.core.geo import LatLon, LocalFrame
from companion.core.modes import Mode
from companion.core.readings import BatteryReading, GnssFix
from companion.core.requests import ACCEPTED, Outcome
from companion.core.state import NavState, lacks_heading, lacks_position
from companion.core.status_text import Severity, StatusText
from companion.core.vehicle_status import VehicleStatus
from companion.failsafe.actions import Trigger
from companion.failsafe.inputs import BoardReadings
from companion.failsafe.monitor import Failsafes
from companion.failsafe.recovery.recovery import RecoveryManeuvers
from companion.geofence.fence import Fence
from companion.obstacles.perception.voyage_map import VoyageMap
from companion.persistence.mission_store import FENCE, DataLosses
from companion.rc.manual_input import ManualInput
from companion.vehicle.arming import PreArmReport, absolute_faults, fence_faults, rc_fault, sensor_faults
from companion.vehicle.mission.progress import MissionProgress
from companion.vehicle.modes.controller import ModeInputs
from companion.vehicle.modes.registry import ModeRegistry
from companion.vehicle.return_route import ReturnRoute
from companion.vehicle.surroundings import Surroundings
from companion.vehicle.track import SailedTrack

NO_HEADING = "no heading"


class VehicleCore:
    """The vehicle without its cycle. Modes and failsafes are objects of their own."""

    def __init__(self, config: BoatConfig) -> None:
        self.config = config  # replaced by the boat when a parameter changes
        self.mode = Mode.HOLD
        self.armed = False
        self.home: LatLon | None = None
        self.fence = Fence()
        self.manual_input = ManualInput()
        self.track = SailedTrack()
        self.progress = MissionProgress()
        self.list_ids = (0, 0, 0)  # of mission, fence and rally points, by content; 0 if empty
        self.status_texts: list[StatusText] = []  # to the operator, until `take_status_texts`
        self.voyage = VoyageMap()  # kept by the perception
        surroundings = Surroundings(self.fence, self.voyage, self.track)
        self.route = ReturnRoute(surroundings, self.status_texts)
        self.modes = ModeRegistry(
            surroundings, self.route, self.progress, self.track, self.manual_input, self.status_texts
        )
        self.failsafes = Failsafes(config, self.manual_input)
        self.recovery = RecoveryManeuvers()
        self.board = BoardReadings()  # replaced by the boat before each cycle of the failsafes
        self.speed_m_s: float | None = None  # set by the operator; None: cruise speed
        self.nav: NavState | None = None
        self.frame: LocalFrame | None = None
        self.fix: GnssFix | None = None
        self.battery: BatteryReading | None = None
        self.has_battery_monitor = False
        self.compass_fault: Callable[[], str] = lambda: ""  # why its headings cannot be trusted
        self.output_fault = ""  # why the motors or the rudder do not answer
        self.is_returning_from_mission = False  # in RTL, as the mission's last item
        self.is_restarting = False  # the program restarts soon: no arming
        self.is_resuming = False  # by itself after a power loss; selecting a mode or disarming ends that
        self.retreated_from: Mode | None = None  # by a failsafe, since the operator last chose a mode
        self.data_losses = DataLosses()
        self.is_home_set = False  # by a request: arming does not move it
        self._pre_arm = PreArmReport()
        self._now_s = 0.0

    def update_state(
        self,
        nav: NavState | None,
        frame: LocalFrame | None,
        fix: GnssFix | None,
        battery: BatteryReading | None,
        now_s: float,
    ) -> None:
        """Take the tick's estimate and readings, before requests and `decide`."""
        self.nav, self.frame, self.fix, self.battery, self._now_s = nav, frame, fix, battery, now_s
        if self.home is None and nav is not None and frame is not None:
            self.home = frame.to_global(nav.point)
        self.fence.update(frame, self.home, self.config.fence)
        if nav is not None and frame is not None:
            self.modes.auto.prepare(frame)

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
            self.output_fault,
        )

    @property
    def is_outside(self) -> bool:
        """Whether the known position is outside the fence."""
        return self.nav is not None and self.fence.is_outside(self.nav.point)

    @property
    def is_guided(self) -> bool:
        """Whether another program may steer by set-points."""
        return self.mode is Mode.GUIDED or (self.mode is Mode.AUTO and self.progress.is_handed_over)

    @property
    def destination(self) -> LatLon | None:
        """The current waypoint, target or station; None without one."""
        return self.modes.controllers[self.mode].destination

    @property
    def way_left_m(self) -> float | None:
        """Length of the way to the destination; None where it is straight, or not known."""
        return None if self.nav is None else self.modes.controllers[self.mode].way_left_m(self.nav)

    def reset_position(self, far_m: float) -> None:
        """The local frame has a new origin, far_m away. Disarmed only."""
        self.notify(Severity.NOTICE, f"Position: {far_m / 1e3:.0f} km away, origin moved here")
        self.track.restart(None)
        if not self.is_home_set:
            self.home = None

    def arm(self, force: bool) -> Outcome:
        """Let the motors turn. force: only motors that cannot be driven and a restart prevent it."""
        if self.armed:
            return ACCEPTED
        faults = self.arming_faults()
        if force:
            faults = absolute_faults(self.output_fault, is_restarting=self.is_restarting)
        if faults:
            for fault in faults:
                self.notify(Severity.CRITICAL, f"Arm: {fault}")
            return Outcome(False, faults[0])
        self.armed, self.retreated_from = True, None
        inputs = self._mode_inputs()
        if not self.is_home_set and inputs is not None:
            self.home = inputs.position
        self.manual_input.release()
        self.voyage.clear()
        self.track.restart(None if self.estimate_fault() or self.nav is None else self.nav.point)
        self.modes.controllers[self.mode].enter(inputs)
        self.notify(Severity.INFO, "Armed")
        return ACCEPTED

    def disarm(self, reason: str) -> Outcome:
        """Motors off. reason: by whom or by what, for the operator."""
        self.is_resuming = False
        if self.armed:
            self.armed = False
            self.recovery.reset()
            self.failsafes.motors.rearm()
            self.notify(Severity.INFO, f"Disarmed {reason}")
        return ACCEPTED

    def arming_faults(self) -> list[str]:
        """Why the boat cannot arm now, worst first; empty when it can."""
        config, mode = self.config, self.mode
        faults = sensor_faults(
            config, mode, self.nav, self.fix, self.battery, has_battery_monitor=self.has_battery_monitor
        )
        if config.arming.check:
            is_lost = bool(self.data_losses.text(FENCE))
            if mode.rules.needs_position and (fault := self.compass_fault()):
                faults.append(f"Compass: {fault}")
            faults += fence_faults(mode, is_outside=self.is_outside, is_lost=is_lost)
        if fault := rc_fault(self.manual_input, config, self._now_s):
            faults.append(fault)
        return absolute_faults(self.output_fault, is_restarting=self.is_restarting) + faults

    def select_mode(self, mode: Mode) -> Outcome:
        """The operator selects a mode. Active failsafes take no further action."""
        outcome = self.change_mode(mode)
        if outcome.accepted:
            self.is_resuming, self.retreated_from = False, None
            self.recovery.handle(Trigger.ABORT, self._now_s)
            self.failsafes.overrule()
        return outcome

    def change_mode(self, mode: Mode, why: str = "") -> Outcome:
        """Enter a mode, or say why it cannot be entered. The present mode continues."""
        if mode.rules.needs_position and (fault := self.estimate_fault() or self._mode_fault(mode)):
            return self.refuse(f"{mode.name}: {fault}")
        return self.force_mode(mode, why)

    def force_mode(self, mode: Mode, why: str) -> Outcome:
        """Enter a mode, whatever it lacks."""
        if mode is not self.mode:
            self.modes.controllers[self.mode].exit()
            self.mode = mode
            self.is_returning_from_mission = False
            self.speed_m_s = None
            self.notify(Severity.INFO, f"Mode {mode.name}{': ' + why if why else ''}")
            self.modes.controllers[mode].enter(self._mode_inputs())
        return ACCEPTED

    def can_enter(self, mode: Mode) -> bool:
        """Whether the boat could enter a mode that needs a position."""
        return not (self.estimate_fault() or self._mode_fault(mode))

    def stop_on_fault(self, why: str, *, disarms: bool) -> None:
        """A fault of the program: HOLD, or disarm. Reported once."""
        if not self.armed or (self.mode is Mode.HOLD and not disarms):
            return
        self.notify(Severity.CRITICAL, why)
        self.recovery.handle(Trigger.ABORT, self._now_s)
        if disarms:
            self.disarm("by the program")
        else:
            self.force_mode(Mode.HOLD, "fault")

    def estimate_fault(self) -> str:
        """Why the boat cannot steer by its position; empty when it can."""
        if self.nav is None or self.frame is None:
            return "no position yet"
        if lacks_position(self.nav, self.config.motors.estimate_timeout_s):
            return "position is stale"
        return NO_HEADING if lacks_heading(self.nav, self.config.motors.estimate_timeout_s) else ""

    def _mode_fault(self, mode: Mode) -> str:
        inputs = self._mode_inputs()
        return "" if inputs is None or mode is self.mode else self.modes.controllers[mode].fault(inputs)

    def _mode_inputs(self) -> ModeInputs | None:
        if self.nav is None or self.frame is None:
            return None
        speed_m_s = self.speed_m_s or self.config.speed.cruise_m_s
        return ModeInputs(self.nav, self.frame, self.config, self.home, speed_m_s, self._now_s)

    def notify(self, severity: int, text: str) -> None:
        """Send a message to the operator."""
        self.status_texts.append(StatusText(severity, text))

    def refuse(self, reason: str) -> Outcome:
        """Refuse a request. Stations show an error in a pop-up; a warning they only list."""
        self.notify(Severity.ERROR, reason)
        return Outcome(False, reason)
