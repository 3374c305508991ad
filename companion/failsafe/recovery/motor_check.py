"""Motor check: drive each motor alone, and tell by the turn rate whether it gives thrust, and which way.

Each motor in turn is driven ahead and then astern. Least squares fit the turn rate r by the commands u,

    r' = k_l u_l |u_l| − k_r u_r |u_r| − r / τ + b

where τ damps the turn and b is the moment of wind and of the swing before. The gain k of a motor without
thrust is close to zero, that of a reversed motor negative. A hull that touches ground leaves large residuals.
"""

import math

from companion.core.fitting import Fit
from companion.core.intent import Drive, Intent, Stop
from companion.core.state import HEALTHY_MOTORS, MotorState, MotorStates

_STOP = Stop()
_SETTLE_S = 1.5  # the turn before decays: more than twice the lake boat's yaw time (0.6 s)
_PULSE_S = 1.0  # more than one yaw time: the turn rate is far above the gyro's noise
_REST_S = 0.5  # between the motors: shaft and gate pass through zero
_HALF = 0.45  # of throttle and of steering: together they drive one motor alone, at 0.9
_PULSES = (  # start and command: left motor ahead and astern, right motor ahead and astern
    (_SETTLE_S, Drive(_HALF, _HALF)),
    (_SETTLE_S + _PULSE_S, Drive(-_HALF, -_HALF)),
    (_SETTLE_S + 2.0 * _PULSE_S + _REST_S, Drive(_HALF, -_HALF)),
    (_SETTLE_S + 3.0 * _PULSE_S + _REST_S, Drive(-_HALF, _HALF)),
)
_LENGTH_S = _SETTLE_S + 4.0 * _PULSE_S + _REST_S
_AGAIN_S = 60.0  # a failed motor is checked again after this,
_SLACK_S = 1e-6
_SOON_S = 25.0  # or after this with room to drift, twice as long each time
_LONGEST_S = 120.0  # between two checks with room
_SAMPLE_S = 0.1  # the period of the failsafes
_DEAD_SHARE = 0.2  # of the better motor's gain: less counts as no thrust
_WEAK_SHARE = 0.6  # less counts as weak: a propeller that slips, worn brushes, a bad contact
_FAINT_RAD_S2 = 0.05  # gain: with less from both motors the result is unclear
_WORDS = {
    MotorState.HEALTHY: "works",
    MotorState.FAILED: "gives no thrust",
    MotorState.REVERSED: "is reversed: compensated",
}
_UNEXPLAINED = 0.8  # of the squares: with larger residuals something else turned the hull


class MotorCheck:
    """motors: the result so far. is_unclear: the last check gave none. shares: of the better motor's gain."""

    def __init__(self) -> None:
        self.is_unclear = False
        self.shares = (1.0, 1.0)
        self.motors = HEALTHY_MOTORS
        self._began_s = 0.0
        self._wait_s = _SOON_S
        self._soon_s = self._again_s = 0.0  # the next check: with room to drift, without
        self._fit = Fit(4)
        self._last = (math.nan, 0.0)  # when the present sample began, and the turn rate then

    def is_due(self, now_s: float, *, has_room: bool) -> bool:
        """Whether it is time to check a failed motor again. has_room: to drift meanwhile."""
        return self.motors.has_failed and now_s > (self._soon_s if has_room else self._again_s)

    def assume_failed(self, is_left: bool, now_s: float) -> None:
        """Without room for a check, take a motor for failed until there is."""
        failed, other = MotorState.FAILED, self.motors.right if is_left else self.motors.left
        if other is failed:
            other = MotorState.HEALTHY
        self.motors = MotorStates(failed, other) if is_left else MotorStates(other, failed)
        self._soon_s, self._again_s = now_s + _SOON_S, now_s + _AGAIN_S

    def begin(self, now_s: float) -> None:
        """Start, or start anew."""
        self._began_s = now_s
        self._soon_s, self._again_s = now_s + self._wait_s, now_s + _AGAIN_S
        self._wait_s = min(2.0 * self._wait_s, _LONGEST_S)
        self._fit, self._last = Fit(4), (math.nan, 0.0)

    def update(self, yaw_rate_rad_s: float, left: float, right: float, now_s: float) -> Intent | None:
        """What the motors do now; None once the check is over. left, right: their commands until now."""
        at_s = now_s - self._began_s + _SLACK_S
        self._sample(yaw_rate_rad_s, left, right, now_s)
        if at_s >= _LENGTH_S:
            self._judge()
            return None
        for begins_s, drive in _PULSES:
            if begins_s <= at_s < begins_s + _PULSE_S:
                return drive
        return _STOP

    def _sample(self, rate_rad_s: float, left: float, right: float, now_s: float) -> None:
        began_s, first_rad_s = self._last
        lasted_s = now_s - began_s
        if lasted_s >= _SAMPLE_S - _SLACK_S:
            turning = 0.5 * (first_rad_s + rate_rad_s)
            push = left * abs(left), -right * abs(right)
            regressors = (push[0] * lasted_s, push[1] * lasted_s, turning * lasted_s, lasted_s)
            self._fit.add(regressors, rate_rad_s - first_rad_s)
        if not lasted_s < _SAMPLE_S - _SLACK_S:
            self._last = now_s, rate_rad_s

    def _judge(self) -> None:
        """A motor ahead turns the boat away from its own side."""
        solved = self._fit.solve()
        self.is_unclear = solved is None
        if solved is None:
            return
        found, _ = solved
        left, right = found[0], found[1]
        most = max(abs(left), abs(right))
        is_faint = most < _FAINT_RAD_S2
        self.is_unclear = is_faint or self._fit.residual(found) > _UNEXPLAINED * self._fit.square
        if self.is_unclear:
            return
        self.shares = left / most, right / most
        self.motors = MotorStates(*map(_answer, self.shares, (self.motors.left, self.motors.right)))
        if not self.motors.has_failed:
            self._wait_s = _SOON_S

    def fault(self) -> str:
        """Which motor gives no thrust, in words; empty when both work."""
        if not self.motors.has_failed:
            return ""
        return f"{'Left' if self.motors.left is MotorState.FAILED else 'Right'} motor gives no thrust"

    def found(self) -> str:
        """The result, for the operator."""
        if self.is_unclear:
            return "Motor check: result unclear"
        left, right = (
            "is weak" if state is MotorState.HEALTHY and abs(share) < _WEAK_SHARE else _WORDS[state]
            for share, state in zip(self.shares, (self.motors.left, self.motors.right), strict=True)
        )
        return f"Left motor {left}, right {right}"


def _answer(share: float, before: MotorState) -> MotorState:
    """The state of a motor by its share of the better one's gain; a reversed one is driven inverted."""
    if abs(share) < _DEAD_SHARE:
        return MotorState.FAILED
    is_reversed = (share < 0.0) is not (before is MotorState.REVERSED)
    return MotorState.REVERSED if is_reversed else MotorState.HEALTHY
