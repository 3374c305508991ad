"""Clear the propellers: stop, pulses astern, then drift free of what came off."""

from companion.core.intent import Drive, Intent, Stop

_STOP = Stop()
_STOP_S = 1.5  # weed comes off a shaft that has stopped and turns backwards
_PULSE_S = 1.0  # a shaft reaches its speed within some tenths of a second
_PAUSE_S = 0.6  # it stops, so that each pulse jerks at the weed
_PULSES = 3  # rather than one long one, which would gather way astern
_DRIFT_S = 2.0  # at walking pace the wash and the weed in it are left behind
_ASTERN = Drive(-1.0, 0.0)
CLEARING_S = _STOP_S + _PULSES * (_PULSE_S + _PAUSE_S) + _DRIFT_S


def clearing_intent(elapsed_s: float) -> Intent:
    """What the motors do, so long after the start."""
    pulse_s = elapsed_s - _STOP_S
    if 0.0 <= pulse_s < _PULSES * (_PULSE_S + _PAUSE_S) and pulse_s % (_PULSE_S + _PAUSE_S) < _PULSE_S:
        return _ASTERN
    return _STOP
