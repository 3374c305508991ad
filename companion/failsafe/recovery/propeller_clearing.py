"""Clearing the propellers: stop, pulses astern, drift, and let the mode go on."""

from companion.core.intent import Drive, Intent, Stop

_STOP = Stop()
_STOP_S = 1.5  # what winds itself round a shaft that turns comes off one that has stopped, and turned back
_PULSE_S = 1.0
_PAUSE_S = 0.6
_PULSES = 3
_DRIFT_S = 2.0
_ASTERN = Drive(-1.0, 0.0)
_LENGTH_S = _STOP_S + _PULSES * (_PULSE_S + _PAUSE_S) + _DRIFT_S


class PropellerClearing:
    """One try. It steers in place of the mode for as long as it `is_running`."""

    __slots__ = ("_began_s", "is_running")

    def __init__(self) -> None:
        self.is_running = False
        self._began_s = 0.0

    def begin(self, now_s: float) -> None:
        """Start, or start anew."""
        self.is_running, self._began_s = True, now_s

    def stop(self) -> None:
        """Break off: the boat is disarmed, or somebody has chosen a mode."""
        self.is_running = False

    def intent(self, now_s: float) -> Intent:
        """What the motors are to do now; ends by itself."""
        at_s = now_s - self._began_s
        if not 0.0 <= at_s < _LENGTH_S:
            self.is_running = False
        pulse_s = at_s - _STOP_S
        if self.is_running and 0.0 <= pulse_s < _PULSES * (_PULSE_S + _PAUSE_S):
            return _ASTERN if pulse_s % (_PULSE_S + _PAUSE_S) < _PULSE_S else _STOP
        return _STOP
