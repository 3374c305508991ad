"""What goes before the mode: clearing the propellers, trying the motors, getting off the shore."""

from typing import TYPE_CHECKING

from companion.core.intent import Intent, Stop
from companion.core.status_text import Severity
from companion.failsafe.recovery.motor_check import MotorCheck
from companion.failsafe.recovery.propeller_clearing import PropellerClearing
from companion.failsafe.recovery.ungrounding import Ungrounding

if TYPE_CHECKING:
    from companion.vehicle.vehicle import Vehicle

_STOP = Stop()


class RecoveryManeuvers:
    """One at a time steers."""

    __slots__ = ("_vehicle", "clearing", "probe", "refloat")

    def __init__(self, vehicle: "Vehicle") -> None:
        self._vehicle = vehicle
        self.clearing = PropellerClearing()
        self.probe = MotorCheck()
        self.refloat = Ungrounding()

    @property
    def is_running(self) -> bool:
        """Whether one of them steers."""
        return self.clearing.is_running or self.probe.is_running or self.refloat.is_running

    def stop(self) -> None:
        """Break off: somebody has chosen a mode."""
        self.clearing.stop()
        self.probe.stop()
        self.refloat.stop()

    def reset(self) -> None:
        """Break off, and forget what was found out: the boat is disarmed."""
        self.stop()
        self.probe.reset()
        signs = self._vehicle.failsafes.signs
        signs.failed_motor = ""
        signs.motors.rearm()

    def intent(self, now_s: float) -> Intent:
        """What the motors are to do now. To be called while one is running."""
        if self.refloat.is_running:
            return self._get_off(now_s)
        if self.clearing.is_running:
            return self._clear(now_s)
        return self._try_motors(now_s)

    def _get_off(self, now_s: float) -> Intent:
        refloat, vehicle = self.refloat, self._vehicle
        rounds = refloat.rounds
        intent = refloat.intent(vehicle.nav, vehicle.fence, vehicle.config, now_s)
        if refloat.rounds > rounds:
            vehicle.notify(Severity.WARNING, "Aground: motors rest, then it tries again")
        return intent

    def _clear(self, now_s: float) -> Intent:
        intent = self.clearing.intent(now_s)
        if self.probe.motors.has_failed and not self.clearing.is_running:
            self.probe.begin(now_s)  # has it helped?
        return intent

    def _try_motors(self, now_s: float) -> Intent:
        signs = self._vehicle.failsafes.signs
        probe = self.probe
        before = probe.motors
        intent = probe.intent(self._vehicle.nav, signs.left, signs.right, now_s)
        if not probe.is_running:
            self._vehicle.notify(Severity.WARNING, probe.found())
            signs.failed_motor = probe.fault()
            is_cleared = not probe.is_unclear and not probe.motors.has_failed and probe.motors == before
            if is_cleared:
                signs.motors.clear(now_s)
            else:
                signs.motors.reset()
        return intent
