"""Heading, roll and pitch from a gyro, an accelerometer and a magnetometer.

A complementary filter after R. Mahony, T. Hamel, J.-M. Pflimlin, *Nonlinear Complementary Filters on the
Special Orthogonal Group*, IEEE Transactions on Automatic Control 53(5), 2008, in its direct form on two
vectors. The gyro turns the estimate; the accelerometer corrects the direction of gravity and the
tilt-compensated magnetometer the heading, each with a proportional and an integral part. The integral parts
are the gyro's bias.

A boat's own acceleration tilts the apparent gravity: 0.8 m/s² in a turn are 4.7°, which a dip of 66° turns
into 10° of heading. So gravity is followed slowly, and hardly at all in turns, whose centripetal acceleration
lasts as long as they do.
"""

import math
from typing import Final, NamedTuple

from companion.core.units import clamp, wrap_pi
from companion.core.vectors import ZERO, Vector, cross, dot, length, plus, unit

GRAVITY_M_S2: Final = 9.80665
GRAVITY_TIME_S: Final = 5.0  # a small boat accelerates for two or three seconds at a time
HEADING_TIME_S: Final = 1.0  # the magnetometer's noise of 1° becomes 0.1° at 50 Hz
# Averaging times of the bias. Four times that of the direction is critically damped; the heading's is longer,
# as the deviation changes in every turn
_LEVEL_BIAS_S: Final = 4.0 * GRAVITY_TIME_S
_YAW_BIAS_S: Final = 60.0
# At first all is fast, to learn a bias of 20 °/s
SETTLING_S: Final = 10.0
_FIRST_GRAVITY_S: Final = 1.0
_FIRST_BIAS_S: Final = 4.0 * _FIRST_GRAVITY_S
_TURNING_RAD_S: Final = 0.3  # from this yaw rate on gravity is not corrected
_UNEVEN: Final = 0.1  # share of gravity by which the acceleration's length may differ: waves, shocks
_LONGEST_S: Final = 0.5  # a longer gap between two samples starts anew
_BIAS_RAD_S: Final = 0.5  # MPU-6050: ±20 °/s (PS-MPU-6000A-00 3.4, section 6.1)


class Attitude(NamedTuple):
    """Heading from magnetic north, clockwise; yaw rate about the vertical; roll and pitch."""

    heading_rad: float
    yaw_rate_rad_s: float
    roll_rad: float
    pitch_rad: float


def roll_pitch(down: Vector) -> tuple[float, float]:
    """Roll (positive to starboard) and pitch (bow up) from the unit vector down in body axes."""
    return math.atan2(down[1], down[2]), math.asin(clamp(-down[0], -1.0, 1.0))


def down_axis(roll_rad: float, pitch_rad: float) -> Vector:
    """The unit vector down in body axes."""
    cos = math.cos(pitch_rad)
    return -math.sin(pitch_rad), cos * math.sin(roll_rad), cos * math.cos(roll_rad)


def level_field(field: Vector, down: Vector) -> Vector | None:
    """The field in level axes that point where the bow points: ahead, to starboard, down.

    None if the bow points straight up or down.
    """
    ahead = unit(plus((1.0, 0.0, 0.0), down, -down[0]))
    if ahead is None:
        return None
    return dot(field, ahead), dot(field, cross(down, ahead)), dot(field, down)


def magnetic_heading(field: Vector, down: Vector) -> float | None:
    """The tilt-compensated heading; None where the field has no horizontal part."""
    level = level_field(field, down)
    if level is None or not math.hypot(level[0], level[1]) > 0.0:
        return None
    return math.atan2(-level[1], level[0])


class AttitudeFilter:
    """Call `turn` with each sample of gyro and accelerometer, and `point` with each of the magnetometer."""

    def __init__(self) -> None:
        self.down: Vector = (0.0, 0.0, 1.0)
        self.heading_rad: float | None = None  # from magnetic north
        self.yaw_rate_rad_s = 0.0  # without the bias
        self.bias: Vector = ZERO  # of the gyro, rad/s in body axes
        self._time_s = math.nan
        self._age_s = 0.0
        self._pointed_s = math.nan

    @property
    def is_settling(self) -> bool:
        """Whether the bias is still being learned quickly."""
        return self._age_s < SETTLING_S

    @property
    def attitude(self) -> Attitude | None:
        """The present estimate, None before the first field."""
        if self.heading_rad is None:
            return None
        return Attitude(self.heading_rad, self.yaw_rate_rad_s, *roll_pitch(self.down))

    def turn(self, rate: Vector, force: Vector, time_s: float) -> None:
        """Advance to time_s. rate: rad/s; force: specific force in m/s², as an accelerometer reads it, so
        (0, 0, −g) at rest; both in body axes.
        """
        dt_s, self._time_s = time_s - self._time_s, time_s
        apparent = unit((-force[0], -force[1], -force[2]))
        if not 0.0 < dt_s <= _LONGEST_S:
            self.down, self.heading_rad, self._age_s = apparent or self.down, None, 0.0
            return
        self._age_s += dt_s
        rate = plus(rate, self.bias, -1.0)
        self.yaw_rate_rad_s = dot(rate, self.down)
        # A direction that is fixed outside turns against the body
        down = plus(self.down, cross(self.down, rate), dt_s)
        trust = self._trust(length(force))
        if apparent is not None and trust > 0.0:
            error = cross(down, apparent)  # the rotation by which the estimate is ahead
            gain = trust / (_FIRST_GRAVITY_S if self.is_settling else GRAVITY_TIME_S)
            down = plus(down, cross(error, down), gain * dt_s)
            self._learn(error, gain * dt_s, _LEVEL_BIAS_S)
        self.down = unit(down) or self.down
        if self.heading_rad is not None:
            self.heading_rad = wrap_pi(self.heading_rad + self.yaw_rate_rad_s * dt_s)

    def point(self, field: Vector, time_s: float, *, is_calibrated: bool = True) -> None:
        """Correct the heading by a field in body axes. Without a calibration for iron it does not turn as the
        boat does, and only the first seconds, at rest, tell the gyro's bias.
        """
        measured_rad = magnetic_heading(field, self.down)
        dt_s, self._pointed_s = time_s - self._pointed_s, time_s
        if measured_rad is None:
            return
        if self.heading_rad is None or not 0.0 < dt_s <= _LONGEST_S:
            self.heading_rad = measured_rad
            return
        error_rad = wrap_pi(measured_rad - self.heading_rad)
        gain = 1.0 / HEADING_TIME_S
        self.heading_rad = wrap_pi(self.heading_rad + error_rad * min(gain * dt_s, 1.0))
        if not is_calibrated and not self.is_settling:
            return
        down = self.down
        ahead = (-error_rad * down[0], -error_rad * down[1], -error_rad * down[2])
        self._learn(ahead, gain * dt_s, _YAW_BIAS_S)

    def _trust(self, force_m_s2: float) -> float:
        """Weight of the accelerometer, 0..1: not in a turn, nor while the boat is shaken."""
        uneven = abs(force_m_s2 / GRAVITY_M_S2 - 1.0)
        if uneven >= _UNEVEN:
            return 0.0
        if self.is_settling:
            return 1.0  # the gyro's bias looks like a turn
        return max(0.0, 1.0 - abs(self.yaw_rate_rad_s) / _TURNING_RAD_S)

    def _learn(self, error: Vector, share: float, time_s: float) -> None:
        """Integrate the rotation by which the estimate is ahead, in rad, into the bias."""
        share /= _FIRST_BIAS_S if self.is_settling else time_s
        bias = plus(self.bias, error, share)
        self.bias = (
            clamp(bias[0], -_BIAS_RAD_S, _BIAS_RAD_S),
            clamp(bias[1], -_BIAS_RAD_S, _BIAS_RAD_S),
            clamp(bias[2], -_BIAS_RAD_S, _BIAS_RAD_S),
        )
