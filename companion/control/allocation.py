"""Thrust allocation: from surge and yaw effort to the command of each motor, by the state of the two motors.

With u = (left, right) the thrust of the two sides and τ = (surge, yaw) the effort, all in shares of full
drive, yaw positive to starboard (T. I. Fossen, *Handbook of Marine Craft Hydrodynamics and Motion Control*,
2nd ed. 2021, chapter 11):

    τ = B u    B = ½ [1  1]    u = B⁺ τ    B⁺ = [1  1]
                     [1 −1]                     [1 −1]

A failed motor's column of B is zero. The pseudo-inverse then gives that motor no thrust, and leaves the row
of the other one as it is.

A motor command is the linearised thrust. With s the share of thrust, d the dead band, g the gain of the side
and a the asymmetry (1 ahead), a motor gets

    d + (1 − d) g min(a |s|, 1)        with the sign of s; zero for zero

A reversed motor gets the opposite sign. Its asymmetry stays that of the thrust, which is the propeller's; its
dead band is that of the command, which is the driver's and the motor's. Below FAINT the dead band is reduced
in proportion, so that a share which oscillates about zero does not make the motor jump from side to side.
"""

from typing import Final

from companion.config.thrusters import Thrusters
from companion.core.state import HEALTHY_MOTORS, MotorCommand, MotorState, MotorStates, Thrust
from companion.core.units import clamp

FAINT: Final = 0.01


def allocate(surge: float, yaw: float, motors: MotorStates = HEALTHY_MOTORS) -> Thrust:
    """Thrust per side for an effort.

    Where a side would saturate, surge is reduced, so that the boat keeps the whole yaw moment. NaN passes
    through: the gate stops the motors.
    """
    yaw = clamp(yaw, -1.0, 1.0)
    room = 1.0 - abs(yaw)
    surge = clamp(surge, -room, room)
    return Thrust(
        0.0 if motors.left is MotorState.FAILED else surge + yaw,
        0.0 if motors.right is MotorState.FAILED else surge - yaw,
    )


def motor_pwm(command: MotorCommand, motors: MotorStates, setting: Thrusters) -> tuple[float, float]:
    """The PWM share of each motor, −1..1, for the thrust that the gate has passed.

    A failed motor gets its share too: the motor check tries it.
    """
    more, turned = setting.asymmetry, MotorState.REVERSED
    ahead, astern, gain = setting.left_ahead, setting.left_astern, setting.left_gain
    left = to_pwm(command.left, ahead, astern, gain, more, is_reversed=motors.left is turned)
    ahead, astern, gain = setting.right_ahead, setting.right_astern, setting.right_gain
    right = to_pwm(command.right, ahead, astern, gain, more, is_reversed=motors.right is turned)
    return left, right


def to_pwm(
    share: float, ahead: float, astern: float, gain: float, asymmetry: float, *, is_reversed: bool = False
) -> float:
    """The PWM share of one motor for a share of thrust: see the text above. NaN becomes zero.

    ahead, astern: the dead bands of positive and negative commands.
    """
    if share > 0.0:
        size = min(share, 1.0)
    elif share < 0.0:
        size = min(-share * asymmetry, 1.0)
    else:
        return 0.0
    is_positive = (share > 0.0) is not is_reversed
    dead = ahead if is_positive else astern
    if size < FAINT:
        dead *= size / FAINT
    size = dead + (1.0 - dead) * gain * size
    return size if is_positive else -size


def from_pwm(pwm: float, dead_band: float, gain: float) -> float:
    """The share of thrust ahead for which a motor gets this PWM share: the inverse of `to_pwm`."""
    return max(pwm - dead_band, 0.0) / ((1.0 - dead_band) * gain)
