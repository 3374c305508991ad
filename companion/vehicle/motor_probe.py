"""Trying the motors one by one: which of them answers, and which runs the wrong way round.

Each in turn is driven ahead and then astern. What wind and swing do to the turn rate is much the same in
both, so the difference between the two pulses is the motor's own doing, and that of a motor without thrust is
nearly nought.
"""

from companion.state import NavState
from companion.vehicle.intent import Drive, Intent, Stop

_STOP = Stop()
_SETTLE_S = 1.5
_PULSE_S = 1.0
_REST_S = 0.5
_HALF = 0.45  # throttle and steering of this much drive one motor alone at twice as much
_PULSES = (  # of the left motor and of the right, ahead and astern: when it begins, and what is driven
    (_SETTLE_S, Drive(_HALF, _HALF)),
    (_SETTLE_S + _PULSE_S, Drive(-_HALF, -_HALF)),
    (_SETTLE_S + 2.0 * _PULSE_S + _REST_S, Drive(_HALF, -_HALF)),
    (_SETTLE_S + 3.0 * _PULSE_S + _REST_S, Drive(-_HALF, _HALF)),
)
_LENGTH_S = _SETTLE_S + 4.0 * _PULSE_S + _REST_S
_AGAIN_S = 60.0  # a motor that did not pull is tried again after this
_SLACK_S = 1e-6
_DEAD_SHARE = 0.2  # of the better motor's answer
_FAINT_RAD_S = 0.08  # less than this from both tells nothing


class MotorProbe:
    """left and right: 1 a motor that answers, −1 one that runs the wrong way round and is driven the other
    way for it, 0 one that does not pull. It steers in place of the mode for as long as it `is_running`.
    """

    __slots__ = ("_began_s", "_change", "_last_rad_s", "_pulse", "is_running", "left", "right")

    def __init__(self) -> None:
        self.is_running = False
        self.left = self.right = 1
        self._began_s = 0.0
        self._pulse = -1
        self._last_rad_s = 0.0
        self._change = [0.0] * len(_PULSES)

    @property
    def is_lame(self) -> bool:
        """Whether only one motor is left to steer and sail with."""
        return self.left * self.right == 0

    @property
    def is_turned(self) -> bool:
        """Whether one is driven the other way round."""
        return self.left < 0 or self.right < 0

    def reset(self) -> None:
        """Both are thought to be well."""
        self.stop()
        self.left = self.right = 1

    def is_due(self, now_s: float) -> bool:
        """Whether it is time to see if a motor that did not pull does so now."""
        return self.is_lame and now_s - self._began_s > _AGAIN_S

    def begin(self, now_s: float) -> None:
        """Start, or start anew."""
        self.is_running, self._began_s, self._pulse = True, now_s, -1

    def stop(self) -> None:
        """Break off, with nothing learned."""
        self.is_running = False

    def intent(self, nav: NavState | None, now_s: float) -> Intent:
        """What the motors are to do now; ends by itself."""
        at_s = now_s - self._began_s + _SLACK_S
        if nav is None or not at_s >= 0.0:
            self.stop()
            return _STOP
        number = -1
        for candidate, (begins_s, _) in enumerate(_PULSES):
            if begins_s <= at_s < begins_s + _PULSE_S:
                number = candidate
        if number != self._pulse:
            if self._pulse >= 0:
                self._change[self._pulse] = nav.yaw_rate_rad_s - self._last_rad_s
            self._pulse, self._last_rad_s = number, nav.yaw_rate_rad_s
        if at_s >= _LENGTH_S:
            self._judge()
        return _PULSES[number][1] if number >= 0 else _STOP

    def _judge(self) -> None:
        """Both motors ahead turn the boat away from their own side."""
        self.is_running = False
        left = self._change[0] - self._change[1]
        right = self._change[3] - self._change[2]
        most = max(abs(left), abs(right))
        if most < _FAINT_RAD_S:
            return
        self.left = _answer(left / most) * (self.left or 1)
        self.right = _answer(right / most) * (self.right or 1)

    def fault(self) -> str:
        """Which motor does not pull; empty when both do."""
        return "" if not self.is_lame else f"{'Right' if self.left else 'Left'} motor does not pull"

    def found(self) -> str:
        """The outcome, in words."""
        words = {1: "pulls", 0: "does not pull", -1: "is reversed: turned round"}
        return f"Left motor {words[self.left]}, right {words[self.right]}"


def _answer(share: float) -> int:
    if abs(share) < _DEAD_SHARE:
        return 0
    return 1 if share > 0.0 else -1
