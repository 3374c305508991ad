"""Motor comparison: drive each motor alone for a moment, under way, while the motors go on being judged.

With both motors at a similar command the current shows that a propeller is fouled, but not which one. One
motor alone draws what that one draws.
"""

from companion.core.intent import Drive, Intent

_PULSE_S = 1.2  # 0.4 s until shaft and current are steady, and eight samples
_HALF = 0.45  # of throttle and of steering: together they drive one motor alone, at 0.9
_LEFT, _RIGHT = Drive(_HALF, _HALF), Drive(_HALF, -_HALF)
COMPARISON_S = 2.0 * _PULSE_S


def comparison_intent(elapsed_s: float, *, is_left_first: bool) -> Intent:
    """What the motors do, so long after the start. The second one turns the boat back."""
    return _LEFT if (elapsed_s < _PULSE_S) is is_left_first else _RIGHT
