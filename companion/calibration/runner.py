"""Runs a calibration afloat: one at a time, near the boat's station.

It replaces the station keeping of LOITER or GUIDED. It is aborted when the mode or the vehicle's intent
changes, a failsafe fires, the estimate has a fault, an obstacle is near, the boat leaves the circle, or time
is up. The boat then keeps its station again, and no parameter has changed.
"""

import math
from collections.abc import Callable
from typing import Final, NamedTuple

from companion.calibration.crash_stop import measure_stop
from companion.calibration.heading import tune_heading
from companion.calibration.routine import CalibrationError, Routine, RoutineInputs, TrialFinding
from companion.calibration.thrusters import calibrate
from companion.config.boat_config import BoatConfig
from companion.core.intent import Intent, KeepStation
from companion.core.readings import GnssFix
from companion.core.state import MotorCommand, NavState, lacks_heading, lacks_position
from companion.core.vehicle_status import VehicleStatus
from companion.geofence.fence import Fence

USUAL_S: Final = 20.0  # times top speed: the radius, unless one is asked for
LEAST_S: Final = 8.0
_LONGEST_S: Final = 1800.0


class Calibration(NamedTuple):
    """A kind of calibration. is_bare: it drives the motors without trim. usual_s: about its duration.

    layouts: of drives that it can measure; refusal: what the operator of another boat is told.
    """

    name: str
    routine: Callable[[RoutineInputs], Routine]
    is_bare: bool
    usual_s: float
    layouts: tuple[str, ...] = ("differential", "rudder", "differential_rudder")
    refusal: str = ""


# Its pulses and turns tell two motors apart by how they turn the boat at rest
THRUSTERS: Final = Calibration(
    "Thruster calibration", calibrate, True, 480.0, ("differential",),
    "measures two motors; set a rudder boat's by hand",
)  # fmt: skip
# Its relay is the sticks', which move motors and rudder together where there are both
HEADING: Final = Calibration(
    "Heading autotune", tune_heading, False, 150.0, ("differential", "rudder"),
    "steers with motors or a rudder, not both",
)  # fmt: skip
STOP: Final = Calibration("Stop calibration", measure_stop, False, 240.0)


class CalibrationResult(NamedTuple):
    """How a calibration has ended: with findings, or for a reason."""

    kind: Calibration
    findings: list[TrialFinding]
    reason: str


class CalibrationRunner:
    """kind: the one running, or the latest. is_running: `update` is to be called every tick.

    is_bare: the motors get their commands without trim. radius_m: of the circle that it keeps to.
    """

    def __init__(self) -> None:
        self.is_running = self.is_bare = False
        self.kind = THRUSTERS
        self.radius_m = 0.0
        self._routine: Routine | None = None
        self._inputs: RoutineInputs | None = None
        self._station: KeepStation | None = None
        self._began_status = VehicleStatus()
        self._began_s = self._fix_s = 0.0
        self._result: CalibrationResult | None = None

    def start(
        self,
        kind: Calibration,
        radius_m: float,
        status: VehicleStatus,
        nav: NavState | None,
        fence: Fence,
        config: BoatConfig,
        now_s: float,
    ) -> str:
        """Start, keeping within radius_m of the boat's station; 0 derives it from top speed.

        Returns why not, empty when it has started.
        """
        if self.is_running:
            return f"{self.kind.name} is under way"
        if config.drive.layout not in kind.layouts:
            return kind.refusal
        if not status.armed:
            return "arm first"
        timeout_s = config.motors.estimate_timeout_s
        if (
            not status.mode.rules.keeps_station
            or nav is None
            or lacks_position(nav, timeout_s)
            or lacks_heading(nav, timeout_s)
        ):
            return "choose LOITER first"
        if status.failsafes or nav.faults:
            return "something is wrong with the boat"
        top_m_s = config.handling.top_speed_m_s
        asked_m = radius_m if radius_m > 0.0 else USUAL_S * top_m_s
        room_m = fence.margin_m(nav.point) - config.fence.margin_m
        if radius_m > 0.0 and room_m < radius_m:
            return f"the fence leaves {max(room_m, 0.0):.1f} m"
        self.radius_m = min(asked_m, room_m)
        if self.radius_m < LEAST_S * top_m_s:
            return f"needs {LEAST_S * top_m_s:.1f} m of free water all round"
        self.kind, self._began_status, self._began_s = kind, status, now_s
        self._station = self._routine = None
        self.is_running, self.is_bare = True, kind.is_bare
        return ""

    def stop(self, reason: str) -> None:
        """Abort, if one is running."""
        if self.is_running:
            if self._routine is not None:
                self._routine.close()
            self._end([], reason)

    def take_result(self) -> CalibrationResult | None:
        """How the latest one has ended, once."""
        result, self._result = self._result, None
        return result

    def progress_percent(self, now_s: float) -> int:
        """Estimated from the usual time of this kind; 99 at most."""
        return min(int(100.0 * (now_s - self._began_s) / self.kind.usual_s), 99)

    def update(
        self,
        intent: Intent,
        status: VehicleStatus,
        nav: NavState | None,
        fence: Fence,
        config: BoatConfig,
        now_s: float,
        *,
        fix: GnssFix | None,
        command: MotorCommand,
        is_slowed: bool,
    ) -> Intent:
        """The calibration's intent in place of the vehicle's.

        command: of the last tick. is_slowed: obstacle avoidance limits the speed.
        """
        if not self.is_running:
            return intent
        reason = self._abort_reason(intent, status, nav, config, now_s)
        if reason or nav is None or not isinstance(intent, KeepStation):
            self.stop(reason or "no position")
            return intent
        is_new = fix is not None and fix.time_s > self._fix_s
        if fix is not None:
            self._fix_s = fix.time_s
        if self._routine is None or self._inputs is None:
            self._inputs = RoutineInputs(nav, None, command, config, now_s, intent.point, self.radius_m)
            self._station, self._routine = intent, self.kind.routine(self._inputs)
        inputs = self._inputs
        inputs.nav, inputs.command, inputs.config, inputs.now_s = nav, command, config, now_s
        inputs.fix = fix if is_new else None
        inputs.is_fenced, inputs.is_slowed = fence.is_active, is_slowed
        if inputs.off_m > self.radius_m:
            self.stop(f"the boat is {inputs.off_m:.1f} m from its station")
            return intent
        try:
            return next(self._routine)
        except StopIteration as end:
            self._end(end.value, "")
        except CalibrationError as error:
            self._end([], str(error))
        return intent

    def _abort_reason(
        self, intent: Intent, status: VehicleStatus, nav: NavState | None, config: BoatConfig, now_s: float
    ) -> str:
        """Why not to go on; empty when all is well."""
        timeout_s = config.motors.estimate_timeout_s
        if not status.armed:
            return "disarmed"
        if status.failsafes & ~self._began_status.failsafes:
            return "failsafe"
        if status.mode is not self._began_status.mode:
            return f"mode {status.mode.name}"
        if not isinstance(intent, KeepStation) or (self._station is not None and intent != self._station):
            return "the boat was asked for something else"
        if nav is None or nav.faults or lacks_position(nav, timeout_s) or lacks_heading(nav, timeout_s):
            return "position or heading are in doubt"
        if not math.isfinite(now_s) or now_s - self._began_s > _LONGEST_S:
            return "it takes too long"
        return ""

    def _end(self, findings: list[TrialFinding], reason: str) -> None:
        self.is_running = self.is_bare = False
        self._routine = None
        self._result = CalibrationResult(self.kind, findings, reason)
