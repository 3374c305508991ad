"""The motor test: a disarmed boat turns one motor for a moment, on the bench or at the jetty.

It goes through the gate like every other command, and ends by itself: after its time, or as soon as anything
at all changes (arming, mode, a failsafe). Whoever gives another command stops it too.
"""

import math
from enum import IntEnum

from companion.core.state import Thrust
from companion.core.units import clamp
from companion.vehicle.vehicle import Vehicle

LONGEST_S = 30.0  # as in Rover
_NO_THRUST = Thrust(0.0, 0.0)


class TestedMotor(IntEnum):
    """Rover's numbers."""

    THROTTLE = 1  # both ahead
    STEERING = 2  # a turn on the spot, to starboard
    LEFT = 3
    RIGHT = 4


_SIDES = {
    TestedMotor.THROTTLE: (1.0, 1.0),
    TestedMotor.STEERING: (1.0, -1.0),
    TestedMotor.LEFT: (1.0, 0.0),
    TestedMotor.RIGHT: (0.0, 1.0),
}


class MotorTest:
    """At most one test at a time; a new one takes the place of the old."""

    __slots__ = ("_began", "_thrust", "_until_s", "_vehicle", "decided_s", "is_running")

    def __init__(self, vehicle: Vehicle) -> None:
        self.is_running = False
        self.decided_s = -math.inf  # when it was last decided that the test goes on
        self._vehicle = vehicle
        self._thrust = _NO_THRUST
        self._until_s = 0.0
        self._began = self._situation()

    def start(self, motor: TestedMotor, share: float, duration_s: float, now_s: float) -> str:
        """Turn a motor at a share of full drive, −1..1. Returns why not, empty when it turns."""
        if self._vehicle.armed:
            return "disarm first"
        if self._vehicle.is_restarting:
            return "the program is restarting"
        left, right = _SIDES[motor]
        share = clamp(share, -1.0, 1.0)
        self._thrust = Thrust(left * share, right * share)
        self._until_s = now_s + min(duration_s, LONGEST_S)
        self._began = self._situation()
        self.is_running = True
        return ""

    def stop(self) -> None:
        """End it now."""
        self.is_running = False
        self._thrust = _NO_THRUST

    def thrust(self, now_s: float) -> Thrust:
        """What the motors should do now; nothing once the test is over."""
        if self.is_running and not (now_s < self._until_s and self._situation() == self._began):
            self.stop()
        self.decided_s = now_s
        return self._thrust

    def _situation(self) -> tuple[object, ...]:
        vehicle = self._vehicle
        return vehicle.armed, vehicle.mode, vehicle.failsafes.active
