"""Clear the propellers: stop, pulses astern, then drift free of what came off."""

from companion.core.intent import Drive, Intent, Stop

_STOP = Stop()
_STOP_S = 1.5  # weed comes off a shaft that has stopped and turns backwards
_PULSE_S = 1.0
_PAUSE_S = 0.6
_PULSES = 3
_DRIFT_S = 2.0
_ASTERN = Drive(-1.0, 0.0)
CLEARING_S = _STOP_S + _PULSES * (_PULSE_S + _PAUSE_S) + _DRIFT_S


def clearing_intent(elapsed_s: float) -> Intent:
    """What the motors do, so long after the start."""
    pulse_s = elapsed_s - _STOP_S
    if 0.0 <= pulse_s < _PULSES * (_PULSE_S + _PAUSE_S) and pulse_s % (_PULSE_S + _PAUSE_S) < _PULSE_S:
        return _ASTERN
    return _STOP
