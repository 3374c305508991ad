"""The motor test: a disarmed boat turns one motor for some seconds, on the bench or at the jetty.

Its thrust passes the gate like any other. It ends after its time, or as soon as arming, mode or the active
failsafes change. The command service also ends it at any other command.
"""

import math
from enum import IntEnum

from companion.config.actuators import DIFFERENTIAL, DriveSetting
from companion.core.state import Thrust
from companion.core.units import clamp
from companion.core.vehicle_status import VehicleStatus

LONGEST_S = 30.0  # as in Rover
_NO_THRUST = Thrust(0.0, 0.0)


class TestedMotor(IntEnum):
    """The motors, with the numbers of Rover's motor test."""

    THROTTLE = 1  # all ahead
    STEERING = 2  # to starboard: the rudder, or both motors without one
    LEFT = 3
    RIGHT = 4


_SIDES = {
    TestedMotor.THROTTLE: Thrust(1.0, 1.0),
    TestedMotor.STEERING: Thrust(1.0, -1.0),
    TestedMotor.LEFT: Thrust(1.0, 0.0),
    TestedMotor.RIGHT: Thrust(0.0, 1.0),
}
_RUDDER = Thrust(0.0, 0.0, 1.0)


class MotorTest:
    """At most one test at a time; a new one replaces it. decided_s: time of the latest `thrust`."""

    def __init__(self) -> None:
        self.is_running = False
        self.decided_s = -math.inf
        self._thrust = _NO_THRUST
        self._until_s = 0.0
        self._began = _conditions(VehicleStatus())

    def start(
        self,
        motor: TestedMotor,
        share: float,
        duration_s: float,
        status: VehicleStatus,
        now_s: float,
        drive: DriveSetting = DIFFERENTIAL,
    ) -> str:
        """Turn a motor at a share of full drive, −1..1. Returns why not, empty when it turns."""
        if status.armed:
            return "disarm first"
        if status.is_restarting:
            return "the program is restarting"
        if motor in (TestedMotor.LEFT, TestedMotor.RIGHT) and not drive.has_pair:
            return "this boat has one motor: test throttle or steering"
        whole = _RUDDER if motor is TestedMotor.STEERING and drive.has_rudder else _SIDES[motor]
        share = clamp(share, -1.0, 1.0)
        self._thrust = Thrust(whole.left * share, whole.right * share, whole.rudder * share)
        self._until_s = now_s + min(duration_s, LONGEST_S)
        self._began = _conditions(status)
        self.is_running = True
        return ""

    def stop(self) -> None:
        self.is_running = False
        self._thrust = _NO_THRUST

    def thrust(self, status: VehicleStatus, now_s: float) -> Thrust:
        """The motors' thrust now; none once the test is over."""
        if self.is_running and not (now_s < self._until_s and _conditions(status) == self._began):
            self.stop()
        self.decided_s = now_s
        return self._thrust


def _conditions(status: VehicleStatus) -> tuple[object, ...]:
    return status.armed, status.mode, status.failsafes
