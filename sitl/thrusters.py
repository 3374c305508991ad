"""Two fixed thrusters side by side, each a brushed DC motor behind a PWM bridge.

From command to thrust, per side:

1. Below the deadband the bridge's drop and the motor's friction hold the shaft; above it the rest of the
   command's range spans all of the drive d.
2. The armature's voltage is shared between back-EMF and resistance. With the propeller's torque ∝ n²,
   d = (1 − s) n + s n² in shares of full scale, s being the resistance's share at full drive. The shaft
   speed n follows the root of that with a first-order lag.
3. Thrust = n |n| × the bollard thrust: a fixed-pitch propeller's thrust grows with the square of its speed
   (Fossen 2021, chapter 9, T ∝ n|n|; the loss with advance speed is left in the hull's damping). Astern it
   is weaker. So thrust is less than quadratic in the command: 0.6 of drive gives 0.46 of the thrust.

Commands are shares of full drive, −1..1; forces in N, ahead positive; moments in N m, clockwise positive.
"""

import math
from typing import Annotated

from msgspec import Meta

from companion.section import NonNegative, Positive, Section, Share


class ThrusterParameters(Section, frozen=True):
    """One pair of equal thrusters.

    apart_m is the distance between the two shafts. full_current_a is one motor's current at full drive;
    with its torque it grows with the square of the shaft speed.
    """

    max_thrust_n: Positive
    apart_m: Positive
    deadband: Annotated[float, Meta(ge=0.0, lt=1.0)] = 0.04
    lag_s: Positive = 0.15
    astern_share: Share = 0.65
    resistance_share: Share = 0.45
    full_current_a: NonNegative = 2.0


class Thruster:
    """One motor with its propeller. shaft is its speed as a share of full speed ahead, −1..1.

    gain multiplies the command (0 is a dead motor, −1 a reversed one); weed, 0..1, holds the propeller.
    """

    __slots__ = ("_blend", "_dt_s", "_parameters", "gain", "shaft", "thrust_n", "weed")

    def __init__(self, parameters: ThrusterParameters) -> None:
        """Start at rest."""
        self._parameters = parameters
        self._dt_s = self._blend = 0.0
        self.shaft = self.thrust_n = 0.0
        self.gain, self.weed = 1.0, 0.0

    def step(self, command: float, dt_s: float) -> None:
        """Hold a command for dt_s."""
        if dt_s != self._dt_s:
            self._dt_s, self._blend = dt_s, -math.expm1(-dt_s / self._parameters.lag_s)
        if command == 0.0 and abs(self.shaft) < 1e-9:  # a stopped motor costs nothing, and must not underflow
            self.shaft = self.thrust_n = 0.0
            return
        free = 1.0 - self.weed
        steady = steady_shaft(self._parameters, command * self.gain) * free
        self.shaft += self._blend * (steady - self.shaft)
        self.thrust_n = self._parameters.max_thrust_n * free * self.shaft * abs(self.shaft)
        if self.shaft < 0.0:
            self.thrust_n *= self._parameters.astern_share

    def current_a(self, command: float) -> float:
        """What the motor draws from the pack: the armature's current, chopped to the command's duty."""
        return self._parameters.full_current_a * self.shaft * self.shaft * abs(command)


def steady_shaft(parameters: ThrusterParameters, command: float) -> float:
    """The shaft speed that a constant command leads to, as a share of full speed."""
    size = abs(command)
    if size <= parameters.deadband:
        return 0.0
    drive = (min(size, 1.0) - parameters.deadband) / (1.0 - parameters.deadband)
    share = parameters.resistance_share
    linear = 1.0 - share
    shaft = 2.0 * drive / (linear + math.sqrt(linear * linear + 4.0 * share * drive))
    return shaft if command > 0.0 else -shaft


class Thrusters:
    """The pair."""

    __slots__ = ("_arm_m", "left", "right")

    def __init__(self, parameters: ThrusterParameters) -> None:
        """Start at rest."""
        self._arm_m = 0.5 * parameters.apart_m
        self.left = Thruster(parameters)
        self.right = Thruster(parameters)

    def step(self, left: float, right: float, dt_s: float) -> tuple[float, float]:
        """Hold two commands for dt_s; the force ahead and the clockwise moment on the hull."""
        self.left.step(left, dt_s)
        self.right.step(right, dt_s)
        port, starboard = self.left.thrust_n, self.right.thrust_n
        return port + starboard, (port - starboard) * self._arm_m

    def current_a(self, left: float, right: float) -> float:
        """What both motors draw from the pack."""
        return self.left.current_a(left) + self.right.current_a(right)
