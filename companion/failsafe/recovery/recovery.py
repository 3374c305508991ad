"""Recovery manoeuvres: they steer in place of the mode, which goes on afterwards."""

from typing import NamedTuple

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.intent import Drive, Intent, Stop
from companion.core.state import NavState
from companion.failsafe.actions import TRANSITIONS, UNGROUNDING, State, Trigger
from companion.failsafe.recovery.motor_check import MotorCheck
from companion.failsafe.recovery.ungrounding import Ungrounding
from companion.geofence.fence import Fence

_STOP = Stop()
# Clearing the propellers: stop, pulses astern, then drift free of what came off
_STOP_S = 1.5  # weed comes off a shaft that has stopped and turns backwards
_PULSE_S = 1.0  # a shaft reaches its speed within some tenths of a second
_PAUSE_S = 0.6  # it stops, so that each pulse jerks at the weed
_PULSES = 3  # rather than one long one, which would gather way astern
_DRIFT_S = 2.0  # at walking pace the wash and the weed in it are left behind
_ASTERN = Drive(-1.0, 0.0)
CLEARING_S = _STOP_S + _PULSES * (_PULSE_S + _PAUSE_S) + _DRIFT_S
# Comparing the motors, under way, while they go on being judged. With both at a similar command the current
# shows that a propeller is fouled, but not which one. One motor alone draws what that one draws.
_ALONE_S = 1.2  # 0.4 s until shaft and current are steady, and eight samples
_HALF = 0.45  # of throttle and of steering: together they drive one motor alone, at 0.9
_LEFT, _RIGHT = Drive(_HALF, _HALF), Drive(_HALF, -_HALF)
COMPARISON_S = 2.0 * _ALONE_S


def clearing_intent(elapsed_s: float) -> Intent:
    """What the motors do, so long after the start."""
    pulse_s = elapsed_s - _STOP_S
    if 0.0 <= pulse_s < _PULSES * (_PULSE_S + _PAUSE_S) and pulse_s % (_PULSE_S + _PAUSE_S) < _PULSE_S:
        return _ASTERN
    return _STOP


def comparison_intent(elapsed_s: float, *, is_left_first: bool) -> Intent:
    """What the motors do, so long after the start. The second one turns the boat back."""
    return _LEFT if (elapsed_s < _ALONE_S) is is_left_first else _RIGHT


class RecoveryStep(NamedTuple):
    """One cycle of a manoeuvre. text: for the operator. cleared: whether a motor check that has just ended
    acquits both motors; None while none has ended.
    """

    intent: Intent
    text: str = ""
    cleared: bool | None = None


class RecoveryManeuvers:
    """The state machine of `transition_table`, with what its states need to remember.

    is_left_first: the motor that a comparison begins with, set before it starts.
    """

    def __init__(self) -> None:
        self.state = State.IDLE
        self.motor_check = MotorCheck()
        self.is_left_first = True
        self._ungrounding = Ungrounding()
        self._began_s = 0.0

    @property
    def is_active(self) -> bool:
        """Whether a manoeuvre steers."""
        return self.state is not State.IDLE

    @property
    def is_ungrounding(self) -> bool:
        """Whether the boat is getting off the shore."""
        return self.state in UNGROUNDING

    @property
    def is_checking(self) -> bool:
        """Whether each motor is tested alone."""
        return self.state is State.CHECKING

    @property
    def hides_motors(self) -> bool:
        """Whether a manoeuvre moves the hull in a way that says nothing about the motors."""
        return self.state not in (State.IDLE, State.COMPARING)

    def handle(self, trigger: Trigger, now_s: float) -> bool:
        """Change the state by the table; False where the state ignores the trigger."""
        state = TRANSITIONS[self.state].get(trigger)
        if state is None:
            return False
        self.state = state
        if trigger in (Trigger.CLEAR, Trigger.COMPARE):
            self._began_s = now_s
        elif trigger is Trigger.CHECK:
            self.motor_check.begin(now_s)
        elif trigger is Trigger.UNGROUND:
            self._ungrounding.begin(now_s)
        return True

    def update(
        self,
        nav: NavState | None,
        fence: Fence,
        config: BoatConfig,
        left: float,
        right: float,
        now_s: float,
        seen: Point | None = None,
    ) -> RecoveryStep:
        """Go on with the manoeuvre under way. left, right: what the motors were given until now. seen: the
        nearest place of a shore that the rangers saw, if one is near.
        """
        if self.is_ungrounding:
            return self._unground(nav, fence, seen, config, now_s)
        if self.state is State.CHECKING:
            return self._check_motors(nav, left, right, now_s)
        elapsed_s = now_s - self._began_s
        if self.state is State.COMPARING:
            if elapsed_s >= COMPARISON_S:
                self.handle(Trigger.DONE, now_s)
            return RecoveryStep(comparison_intent(elapsed_s, is_left_first=self.is_left_first))
        if elapsed_s >= CLEARING_S:
            self.handle(Trigger.DONE, now_s)
            if self.motor_check.motors.has_failed:
                self.handle(Trigger.CHECK, now_s)  # has it helped?
        return RecoveryStep(clearing_intent(elapsed_s))

    def _unground(
        self, nav: NavState | None, fence: Fence, seen: Point | None, config: BoatConfig, now_s: float
    ) -> RecoveryStep:
        rounds = self._ungrounding.rounds
        intent, trigger = self._ungrounding.update(self.state, nav, fence, seen, config, now_s)
        if trigger is not None:
            self.handle(trigger, now_s)
        is_next_round = self._ungrounding.rounds > rounds
        return RecoveryStep(intent, "Aground: motors rest before the next try" if is_next_round else "")

    def _check_motors(self, nav: NavState | None, left: float, right: float, now_s: float) -> RecoveryStep:
        check = self.motor_check
        if nav is None:
            self.handle(Trigger.DONE, now_s)
            return RecoveryStep(_STOP)
        before = check.motors
        intent = check.update(nav.measured_yaw_rate_rad_s, left, right, now_s)
        if intent is not None:
            return RecoveryStep(intent)
        self.handle(Trigger.DONE, now_s)
        cleared = not check.is_unclear and not check.motors.has_failed and check.motors == before
        return RecoveryStep(_STOP, check.found(), cleared)

    def reset(self) -> None:
        """The boat is disarmed: stop, and take both motors for healthy."""
        self.state = State.IDLE
        self.motor_check = MotorCheck()
