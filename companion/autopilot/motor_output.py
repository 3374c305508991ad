"""The motors' and the rudder's end of the data flow: the latest command, stopping, the watchdog's trips; and
the net under the boat's tick.
"""

import contextlib
import logging
import math
from enum import IntEnum
from typing import Final

from companion.config.actuators import Thrusters
from companion.control.allocation import motor_pwm
from companion.core.errors import SilentOutputsError
from companion.core.state import STOPPED, MotorCommand, MotorStates
from companion.hal.interfaces import Hardware

logger = logging.getLogger(__name__)

# An operator who joins hears of a motor that does not stop as soon as of a link that failed (FS_TIMEOUT)
STUCK_AGAIN_S: Final = 5.0
DISARM_LEVEL = 10.0
GIVE_UP_LEVEL = 50.0  # one second of nothing but faults
_FORGOTTEN_A_TICK = 0.02  # a good second makes good for one fault
_MOST_LOGGED = 20


class MotorOutput:
    """command: the latest one written. stuck: why the motors do not stop; empty while they do."""

    def __init__(self, hardware: Hardware) -> None:
        self.command: MotorCommand = STOPPED
        self.stuck = ""
        self._stuck_due_s = -math.inf
        self._hardware = hardware
        self._trips = 0  # of the cutoff, as far as the operator knows

    def write(self, command: MotorCommand, motors: MotorStates, setting: Thrusters) -> None:
        """Drive the motors and set the rudder."""
        self.command = command
        self._hardware.motors.write(*motor_pwm(command, motors, setting))
        if self._hardware.rudder is not None:
            self._hardware.rudder.write(command.rudder)
        self.stuck = ""

    def stop(self) -> None:
        """Motors off, at once, then the rudder amidships. Raises what the drivers raise."""
        self.command = STOPPED
        self._hardware.motors.stop()
        if self._hardware.rudder is not None:
            self._hardware.rudder.write(0.0)

    def stop_after_fault(self) -> str:
        """Stop; returns what has become of the motors, in words. Sets `stuck`."""
        self.command = STOPPED
        was_stuck, self.stuck, outcome = bool(self.stuck), "", "motors off"
        try:
            self._hardware.motors.stop()
        except Exception as error:
            if not (isinstance(error, SilentOutputsError) and error.are_off):
                self.stuck, outcome = str(error) or type(error).__name__, f"motors do not stop: {error}"
                if not was_stuck:
                    logger.exception("the motors do not stop")
        if self._hardware.rudder is not None:
            with contextlib.suppress(Exception):
                self._hardware.rudder.write(0.0)
        return outcome

    def stuck_text(self, now_s: float) -> str:
        """A message, every STUCK_AGAIN_S while the motors do not stop; empty otherwise."""
        if not self.stuck or now_s < self._stuck_due_s:
            return ""
        self._stuck_due_s = now_s + STUCK_AGAIN_S
        return f"Motors do not stop: switch the boat off ({self.stuck})"

    def trip_text(self, timeout_s: float) -> str:
        """A message once the cutoff has stopped the motors of a stalled program; empty otherwise."""
        cutoff = self._hardware.cutoff
        if cutoff is None or cutoff.trips == self._trips:
            return ""
        self._trips = cutoff.trips
        return f"Program stalled: motors cut off after {timeout_s:g} s"


class Fall(IntEnum):
    """How far it has come."""

    HOLD = 0
    DISARM = 1
    GIVE_UP = 2


class SafetyNet:
    """What becomes of a fault of ours in the boat's tick.

    The motors are off at once, whatever it is. A first fault leaves an armed boat on HOLD, where hardly
    anything is computed and from where the operator may go on; faults that do not end disarm it; and if even
    then every tick fails, the program ends, to be started anew. Not so if a part with outputs is silent,
    which no start cures: the boat keeps its links and says so.

    faults: counted in all; level: those that have not been made good for.
    """

    def __init__(self) -> None:
        self.faults = 0
        self.level = 0.0

    def passed(self) -> None:
        """A tick went well."""
        self.level = max(self.level - _FORGOTTEN_A_TICK, 0.0)

    def caught(self, error: Exception) -> Fall:
        """A tick went wrong."""
        self.faults += 1
        limit = DISARM_LEVEL if isinstance(error, SilentOutputsError) else GIVE_UP_LEVEL
        self.level = max(self.level, min(self.level + 1.0, limit))
        if self.faults <= _MOST_LOGGED:
            logger.error("fault %d in the boat's tick, motors off", self.faults, exc_info=error)
        if self.level >= GIVE_UP_LEVEL:
            return Fall.GIVE_UP
        return Fall.DISARM if self.level >= DISARM_LEVEL else Fall.HOLD
