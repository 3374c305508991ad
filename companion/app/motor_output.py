"""The motors' and the rudder's end of the data flow: the latest command, stopping, the watchdog's trips."""

from companion.config.thrusters import Thrusters
from companion.control.allocation import motor_pwm
from companion.core.state import STOPPED, MotorCommand, MotorStates
from companion.hal.interfaces import Hardware


class MotorOutput:
    """command: the latest one written."""

    def __init__(self, hardware: Hardware) -> None:
        self.command: MotorCommand = STOPPED
        self._hardware = hardware
        self._trips = 0  # of the cutoff, as far as the operator knows

    def write(self, command: MotorCommand, motors: MotorStates, setting: Thrusters) -> None:
        """Drive the motors and set the rudder."""
        self.command = command
        self._hardware.motors.write(*motor_pwm(command, motors, setting))
        if self._hardware.rudder is not None:
            self._hardware.rudder.write(command.rudder)

    def stop(self) -> None:
        """Motors off, at once, then the rudder amidships. Raises what the drivers raise."""
        self.command = STOPPED
        self._hardware.motors.stop()
        if self._hardware.rudder is not None:
            self._hardware.rudder.write(0.0)

    def trip_text(self, timeout_s: float) -> str:
        """A message once the cutoff has stopped the motors of a stalled program; empty otherwise."""
        cutoff = self._hardware.cutoff
        if cutoff is None or cutoff.trips == self._trips:
            return ""
        self._trips = cutoff.trips
        return f"Program stalled: motors cut off after {timeout_s:g} s"
