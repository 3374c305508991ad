"""From intent to motor command: guidance a few times a second, control every tick.

Guidance (avoidance, pilot, fence brake) is costly and changes slowly. It runs every GUIDANCE_S, or at once
after a new request; the loops behind it (heading, speed, gate) run every tick on its latest output.
"""

from msgspec.structs import replace

from companion.config.boat_config import BoatConfig
from companion.control.gate import Gate
from companion.control.helm import Helm
from companion.control.single_thruster import SINGLE_THRUSTER_SPEED
from companion.core.intent import Drive, Intent, Stop
from companion.core.state import STOPPED, Demand, MotorCommand, NavState, Thrust
from companion.core.status_text import StatusText
from companion.core.vehicle_status import VehicleStatus
from companion.geofence.brake import FenceBrake
from companion.geofence.fence import Fence
from companion.guidance.drift_heading import DriftHeading
from companion.guidance.pilot import Pilot
from companion.guidance.stall_detector import StallDetector
from companion.obstacles.perception.perception import ObstaclePerception
from companion.obstacles.perception.voyage_map import VoyageMap
from companion.obstacles.planning.planner import LocalPlanner

GUIDANCE_S = 0.1
_AT_LINE_M = 1.2  # half the hull length plus the position error
_TOUCHING = 0.8  # margins: half the hull length plus the error of the map of the voyage
_SLACK_S = 1e-6
_STOP = Stop()


class GuidancePipeline:
    """demand: set-points of the loops, None while they are open. headway: the stall detector. may_touch: the
    hull may touch something that was seen.
    """

    def __init__(self, config: BoatConfig, status_texts: list[StatusText], voyage: VoyageMap) -> None:
        """status_texts: where messages to the operator are appended. voyage: the map to keep."""
        self.perception = ObstaclePerception(config.avoidance, voyage)
        self.avoidance = LocalPlanner(status_texts)
        self.helm = Helm()
        self.gate = Gate()
        self.headway = StallDetector()
        self.demand: Demand | None = None
        self.may_touch = False
        self._pilot = Pilot()
        self._fence_brake = FenceBrake(status_texts)
        self._steered: Demand | Drive | Stop = _STOP
        self._command = STOPPED
        self._due_s = 0.0
        self._guided_s = 0.0
        self._drift_heading = DriftHeading()

    def reset(self) -> None:
        """Discard all state after a fault."""
        self._pilot, self.helm, self.gate = Pilot(), Helm(), Gate()
        self.avoidance.reset()
        self.perception.clear()
        self.idle()

    def idle(self) -> None:
        """Stop steering; guidance runs at the next tick."""
        self._steered, self.demand, self._due_s = _STOP, None, 0.0

    def request_update(self) -> None:
        """Run guidance at the next tick."""
        self._due_s = 0.0

    def is_due(self, now_s: float) -> bool:
        """Whether guidance runs at this tick."""
        return now_s >= self._due_s - _SLACK_S

    def guide(
        self,
        intent: Intent,
        nav: NavState | None,
        status: VehicleStatus,
        fence: Fence,
        config: BoatConfig,
        now_s: float,
    ) -> None:
        """Decide what the control loops hold for the next GUIDANCE_S."""
        dt_s = min(max(now_s - self._guided_s, 0.0), 2.0 * GUIDANCE_S)
        nav = None if nav is None else nav.without_waves
        self._guided_s = now_s
        self._due_s = now_s + GUIDANCE_S
        is_at_line = self.may_touch = False
        if nav is not None:
            self.may_touch = self.perception.voyage.is_near(nav.point, _TOUCHING * config.avoidance.margin_m)
            is_at_line = self.may_touch or fence.is_near(nav.point, _AT_LINE_M)
        self.headway.update(self.demand, self._command, nav, config, dt_s, is_at_line=is_at_line)
        if status.is_ungrounding:  # what it is to keep clear of, it lies on
            self.avoidance.reset()
            steered = self._pilot.update(intent, nav, config, dt_s)
        else:
            steered = self._keep_clear(intent, nav, status, fence, config, dt_s, now_s)
        if status.motors.has_failed and isinstance(steered, Demand) and nav is not None:
            speed_m_s = SINGLE_THRUSTER_SPEED * config.handling.top_speed_m_s
            steered = self._drift_heading.update(steered, nav, fence, speed_m_s, now_s)
        self._steered = steered
        self.demand = steered if isinstance(steered, Demand) else None

    def _keep_clear(
        self,
        intent: Intent,
        nav: NavState | None,
        status: VehicleStatus,
        fence: Fence,
        config: BoatConfig,
        dt_s: float,
        now_s: float,
    ) -> Demand | Drive | Stop:
        """The pilot between avoidance and fence."""
        intent = self.avoidance.update(
            self._fence_brake.hold(intent),
            nav,
            config,
            self.perception,
            fence,
            is_by_hand=status.mode.rules.is_by_hand,
            now_s=now_s,
        )
        steered = self._pilot.update(intent, nav, config, dt_s)
        steered = self.avoidance.limit.apply(steered, nav, config)
        if self.avoidance.eases and isinstance(steered, Demand):
            steered = replace(steered, brakes=False)
        if status.is_checking_motors:  # its pulses say nothing unless they are driven as they are meant
            return steered
        return self._fence_brake.limit(steered, intent, nav, fence, config, dt_s)

    def drive(
        self, nav: NavState | None, status: VehicleStatus, config: BoatConfig, now_s: float, dt_s: float
    ) -> MotorCommand:
        """Close the loops for one tick."""
        steered = self._steered
        nav = None if nav is None else nav.without_waves
        thrust = self.helm.update(steered, nav, config, dt_s, status.motors)
        command = self.gate.check(
            thrust,
            armed=status.armed,
            command_age_s=now_s - self._guided_s,
            nav=nav,
            needs_estimate=not isinstance(steered, Drive),
            setting=config.motors,
            dt_s=dt_s,
            needs_position=status.needs_position,
            estimate_age_s=now_s - nav.time_s if nav is not None else 0.0,
            rudder_slew_per_s=config.drive.slew_per_s,
            output_fault=status.output_fault,
        )
        if command.reason:
            self.helm.reset()
        self._command = command
        return command

    def test_motors(
        self, thrust: Thrust, config: BoatConfig, dt_s: float, *, may_turn: bool, command_age_s: float
    ) -> MotorCommand:
        """A motor test's command through the gate; nothing is steered for meanwhile."""
        self.idle()
        return self.gate.check(
            thrust,
            armed=may_turn,
            command_age_s=command_age_s,
            nav=None,
            needs_estimate=False,
            setting=config.motors,
            dt_s=dt_s,
            rudder_slew_per_s=config.drive.slew_per_s,
        )
