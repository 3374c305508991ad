"""Trials under way: one at a time, on the water about the boat's station, and at an end as soon as anything
else happens.

A trial takes the place of LOITER's (or GUIDED's) station keeping. It breaks off when the mode or what is
asked of the boat changes, a failsafe fires, the estimate has a fault, something is in the way, the boat
leaves the circle, or time is up; the boat then keeps its station again, or does what it was asked, and
nothing has been changed.
"""

import math
from collections.abc import Callable
from typing import Final, NamedTuple

from companion.calibration.heading import tune_heading
from companion.calibration.thrusters import calibrate
from companion.calibration.trial import Finding, Routine, Sight, TrialError
from companion.config.boat_config import BoatConfig
from companion.core.health import lacks_heading, lacks_position
from companion.core.intent import Intent, KeepStation
from companion.core.modes import Mode
from companion.core.state import MotorCommand, NavState
from companion.sensors.readings import GnssFix
from companion.vehicle.vehicle import Vehicle

USUAL_S: Final = 20.0  # of top speed: the radius, unless one is asked for
LEAST_S: Final = 8.0
_LONGEST_S: Final = 1800.0
_MODES: Final = (Mode.LOITER, Mode.GUIDED)


class Kind(NamedTuple):
    """One of the trials. is_bare: it measures the motors as they are. usual_s: how long it takes, about."""

    name: str
    routine: Callable[[Sight], Routine]
    is_bare: bool
    usual_s: float


THRUSTERS: Final = Kind("Thruster calibration", calibrate, True, 480.0)
HEADING: Final = Kind("Heading autotune", tune_heading, False, 150.0)


class Ending(NamedTuple):
    """How a trial has ended: with findings, or for a reason."""

    kind: Kind
    findings: list[Finding]
    reason: str


class Trials:
    """is_running: the owner calls `update` every tick. is_bare: the motors get commands as they are."""

    __slots__ = (
        "_active", "_began_s", "_circle_m", "_ending", "_fix_s", "_given", "_kind", "_mode", "_routine",
        "_vehicle", "is_bare", "is_running",
    )  # fmt: skip

    def __init__(self, vehicle: Vehicle) -> None:
        self.is_running = self.is_bare = False
        self._vehicle = vehicle
        self._kind = THRUSTERS
        self._routine: Routine | None = None
        self._given: KeepStation | None = None
        self._mode, self._active = vehicle.mode, 0
        self._circle_m = 0.0
        self._began_s = self._fix_s = 0.0
        self._ending: Ending | None = None

    @property
    def radius_m(self) -> float:
        """Of the circle that it keeps to."""
        return self._circle_m

    @property
    def kind(self) -> Kind:
        """The one that is running, or has run last."""
        return self._kind

    def begin(self, kind: Kind, radius_m: float, now_s: float) -> str:
        """Start, keeping within radius_m of the boat's station; 0 is what the boat's speed asks for.

        Returns why not, empty when it has begun.
        """
        vehicle = self._vehicle
        nav, config = vehicle.nav, vehicle.config
        if self.is_running:
            return f"{self._kind.name} is under way"
        if not vehicle.armed:
            return "arm first"
        if vehicle.mode not in _MODES or not vehicle.can_enter(vehicle.mode) or nav is None:
            return "choose LOITER first"
        if vehicle.failsafes.active or nav.faults:
            return "something is wrong with the boat"
        top_m_s = config.handling.top_speed_m_s
        asked_m = radius_m if radius_m > 0.0 else USUAL_S * top_m_s
        room_m = vehicle.fence.margin_m(nav.point) - config.fence.margin_m
        if radius_m > 0.0 and room_m < radius_m:
            return f"the fence leaves {max(room_m, 0.0):.1f} m"
        self._circle_m = min(asked_m, room_m)
        if self._circle_m < LEAST_S * top_m_s:
            return f"needs {LEAST_S * top_m_s:.1f} m of free water all round"
        self._kind, self._mode, self._active = kind, vehicle.mode, vehicle.failsafes.active
        self._given = self._routine = None
        self._began_s = now_s
        self.is_running, self.is_bare = True, kind.is_bare
        return ""

    def stop(self, reason: str) -> None:
        """Break off, if one is running."""
        if self.is_running:
            if self._routine is not None:
                self._routine.close()
            self._end([], reason)

    def take_ending(self) -> Ending | None:
        """How the last one has ended, once."""
        ending, self._ending = self._ending, None
        return ending

    def progress_percent(self, now_s: float) -> int:
        """About how far it is."""
        return min(int(100.0 * (now_s - self._began_s) / self._kind.usual_s), 99)

    def update(
        self,
        intent: Intent,
        nav: NavState | None,
        fix: GnssFix | None,
        command: MotorCommand,
        is_slowed: bool,
        now_s: float,
    ) -> Intent:
        """What to sail instead of the vehicle's intent.

        command: of the last tick. is_slowed: avoidance has seen something.
        """
        if not self.is_running:
            return intent
        config = self._vehicle.config
        reason = self._objection(intent, nav, config, now_s)
        if reason or nav is None or not isinstance(intent, KeepStation):
            self.stop(reason or "no position")
            return intent
        is_new = fix is not None and fix.time_s > self._fix_s
        if fix is not None:
            self._fix_s = fix.time_s
        sight = Sight(
            nav, fix if is_new else None, command, config, now_s, intent.point, self._circle_m,
            self._vehicle.fence.is_active, is_slowed,
        )  # fmt: skip
        if sight.off_m > self._circle_m:
            self.stop(f"the boat is {sight.off_m:.1f} m from its station")
            return intent
        try:
            if self._routine is None:
                self._given, self._routine = intent, self._kind.routine(sight)
                return next(self._routine)
            return self._routine.send(sight)
        except StopIteration as end:
            self._end(end.value, "")
        except TrialError as error:
            self._end([], str(error))
        return intent

    def _objection(self, intent: Intent, nav: NavState | None, config: BoatConfig, now_s: float) -> str:
        """Why not to go on; empty when all is well."""
        vehicle, timeout_s = self._vehicle, config.motors.estimate_timeout_s
        if not vehicle.armed:
            return "disarmed"
        if vehicle.failsafes.active & ~self._active:
            return "failsafe"
        if vehicle.mode is not self._mode:
            return f"mode {vehicle.mode.name}"
        if not isinstance(intent, KeepStation) or (self._given is not None and intent != self._given):
            return "the boat was asked for something else"
        if nav is None or nav.faults or lacks_position(nav, timeout_s) or lacks_heading(nav, timeout_s):
            return "position or heading are in doubt"
        if not math.isfinite(now_s) or now_s - self._began_s > _LONGEST_S:
            return "it takes too long"
        return ""

    def _end(self, findings: list[Finding], reason: str) -> None:
        self.is_running = self.is_bare = False
        self._routine = None
        self._ending = Ending(self._kind, findings, reason)
