"""Thrust allocation: from surge and yaw effort to motors and rudder, by the layout and the motors' state.

Two motors: with u = (left, right) the thrust of the two sides and τ = (surge, yaw) the effort, all in shares
of full drive, yaw positive to starboard (T. I. Fossen, *Handbook of Marine Craft Hydrodynamics and Motion
Control*, 2nd ed. 2021, chapter 11):

    τ = B u    B = ½ [1  1]    u = B⁺ τ    B⁺ = [1  1]
                     [1 −1]                     [1 −1]

A failed motor's column of B is zero. The pseudo-inverse then gives that motor no thrust, and leaves the row
of the other one as it is.

A rudder: its yaw moment is e δ, with δ the share of full rudder and e the square of the water's speed at the
blade (the same, section 9.5), in shares of that at cruise:

    e = (1 − w) (u / u_c)² + w (s / s_c)²       ahead       w: the share of propeller wash at cruise
    e = −a (1 − w) (u / u_c)²                   astern      no wash; the moment has the opposite sign

u is the speed through the water, s the throttle. So δ = yaw / e, limited where the blade would stall. Below
the speed of steerage way e is too small for much moment. The throttle then rises to s_c √(|yaw| / w), up to
kick_throttle, which sends wash over the rudder (kick ahead), unless the boat is to stop or go astern.

Two motors and a rudder: the rudder takes the share e of the moment, up to all of it from cruise speed on, the
motors the rest. At rest the motors turn the boat.

A motor command is the linearised thrust. With s the share of thrust, d the dead band, g the gain of the side
and a the asymmetry (1 ahead), a motor gets

    d + (1 − d) g min(a |s|, 1)        with the sign of s; zero for zero

A reversed motor gets the opposite sign. Its asymmetry stays that of the thrust, which is the propeller's; its
dead band is that of the command, which is the driver's and the motor's. Below FAINT the dead band is reduced
in proportion, so that a share which oscillates about zero does not make the motor jump from side to side.
"""

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Final

from msgspec import Struct

from companion.config.actuators import DriveSetting, Thrusters
from companion.config.boat_config import BoatConfig
from companion.config.tuning import Speed
from companion.core.state import HEALTHY_MOTORS, MotorCommand, MotorState, MotorStates, Thrust
from companion.core.units import clamp

FAINT: Final = 0.01
_LEAST_EFFECT: Final = 0.05  # of the rudder: with less, its angle would jump about with noise


class Effort(Struct, frozen=True, gc=False):
    """What the loops ask for, in shares of full drive and full steering, and the speed through the water."""

    surge: float
    yaw: float
    water_m_s: float = 0.0


def allocate(effort: Effort, config: BoatConfig, motors: MotorStates = HEALTHY_MOTORS) -> Thrust:
    """Thrust and rudder for an effort, by the layout. NaN passes through: the gate stops the motors."""
    return _LAYOUTS[config.drive.layout](effort, config, motors)


def by_hand(throttle: float, steering: float, config: BoatConfig) -> Thrust:
    """Thrust and rudder for an operator's sticks: a rudder follows the stick."""
    drive = config.drive
    left = right = clamp(throttle, -1.0, 1.0)
    if drive.has_pair:
        pair = pair_thrust(throttle, steering)
        left, right = pair.left, pair.right
    return Thrust(left, right, clamp(steering, -1.0, 1.0) if drive.has_rudder else 0.0)


def rudder_effect(throttle: float, water_m_s: float, drive: DriveSetting, speed: Speed) -> float:
    """e above: the moment of full rudder relative to that at cruise, negative where its sign is opposite."""
    flow = (1.0 - drive.wash) * (water_m_s / speed.cruise_m_s) ** 2
    if water_m_s < 0.0:
        flow *= -drive.astern
    if throttle > 0.0:
        flow += drive.wash * (throttle / max(speed.cruise_throttle, 0.05)) ** 2
    return flow


def pair_thrust(surge: float, yaw: float, motors: MotorStates = HEALTHY_MOTORS) -> Thrust:
    """Thrust of two motors for an effort.

    Where a side would saturate, surge is reduced, so that the boat keeps the whole yaw moment.
    """
    yaw = clamp(yaw, -1.0, 1.0)
    room = 1.0 - abs(yaw)
    surge = clamp(surge, -room, room)
    return Thrust(
        0.0 if motors.left is MotorState.FAILED else surge + yaw,
        0.0 if motors.right is MotorState.FAILED else surge - yaw,
    )


def _differential(effort: Effort, config: BoatConfig, motors: MotorStates) -> Thrust:  # noqa: ARG001
    return pair_thrust(effort.surge, effort.yaw, motors)


def _rudder(effort: Effort, config: BoatConfig, motors: MotorStates) -> Thrust:
    throttle, water_m_s = clamp(effort.surge, -1.0, 1.0), effort.water_m_s
    drive = config.drive
    if throttle > 0.0 and drive.wash > 0.0 and 0.0 <= water_m_s < drive.steerage_m_s:
        kick = max(config.speed.cruise_throttle, 0.05) * math.sqrt(min(abs(effort.yaw), 1.0) / drive.wash)
        throttle = max(throttle, min(kick, drive.kick_throttle) * (1.0 - water_m_s / drive.steerage_m_s))
    if motors.left is MotorState.FAILED:
        throttle = 0.0
    return Thrust(
        throttle, throttle, _angle(effort.yaw, rudder_effect(throttle, water_m_s, drive, config.speed))
    )


def _pair_and_rudder(effort: Effort, config: BoatConfig, motors: MotorStates) -> Thrust:
    effect = rudder_effect(effort.surge, effort.water_m_s, config.drive, config.speed)
    taken = min(abs(effect), 1.0)
    pair = pair_thrust(effort.surge, (1.0 - taken) * effort.yaw, motors)
    return Thrust(pair.left, pair.right, _angle(taken * effort.yaw, effect))


def _angle(yaw: float, effect: float) -> float:
    """The share of full rudder for a moment."""
    if abs(effect) < _LEAST_EFFECT:
        effect = math.copysign(_LEAST_EFFECT, effect)
    return clamp(yaw / effect, -1.0, 1.0)


_LAYOUTS: Final[Mapping[str, Callable[[Effort, BoatConfig, MotorStates], Thrust]]] = MappingProxyType(
    {"differential": _differential, "rudder": _rudder, "differential_rudder": _pair_and_rudder}
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
