"""Process model: how thrust and steering move the hull through the water.

Surge and sway. Drag and thrust balance at cruise speed: `cruise_throttle` holds `cruise_m_s`. With x the
speed and s a motor command in those units, and X(x) = l x + (1 − l) x|x| for both drag and thrust (linear
and quadratic damping, T. I. Fossen, *Handbook of Marine Craft Hydrodynamics and Motion Control*, 2nd ed.
2021, section 6.4),

    u̇ = U (g ½ (X(s_left) + X(s_right)) − X(u/U)) / (X'(1) T) + 1.5 v r        U: cruise speed
    v̇ = −½ u r − v / T_v        T: time constant at U; g: thrust gain, 1 nominally

The last terms of the first line and the first of the second are the Coriolis forces of the hull and its
added mass (section 6.5), with a lateral added mass of half the hull's mass: in a turn the hull slips
outward and slows down.

Yaw. Nomoto's first-order model (chapter 7) behind a motor lag, thrust proportional to the square of the
command:

    T ṙ + r = K (½ (s_left |s_left| − s_right |s_right|) + m) + r₀ + ρ

m is the rudder's moment, in shares of full steering. K and the trim moment r₀ (wind, unequal motors) are
estimated from the measured rate by a Kalman filter of two random walks (Y. Bar-Shalom, X. R. Li, T.
Kirubarajan, *Estimation with Applications to Tracking and Navigation*, 2001, section 5.2). ρ, the rest of
the rate, is a first-order Gauss-Markov process that the gyro corrects every tick. The rate therefore
follows a steering command at once by the model, and the gyro's noise is filtered.
"""

import math
from typing import Final

_LINEAR: Final = 0.4
_QUADRATIC: Final = 1.0 - _LINEAR
_STEEPNESS: Final = 2.0 - _LINEAR  # X'(1)
_SLIP: Final = 0.5
_SLOWED: Final = 1.5
_SWAY_SHARE: Final = 0.2  # T_v / T
_ASTERN: Final = 0.65  # of the thrust ahead: propellers are less efficient astern
_MAX_SHARE: Final = 4.0  # of cruise speed
_MAX_STEP_S: Final = 0.1  # the motion during a stall of the loop is unknown

_MOTOR_S: Final = 0.15
_HULL_S: Final = 0.8
_GAIN_RAD_S: Final = 0.6  # initial K
_GAIN_WALK: Final = 0.02  # of K: rad/s per √s,
_TRIM_WALK: Final = 0.03  # and of r₀: wind and speed change
_MISFIT: Final = 0.01  # (rad/s)² s: a model error of 0.1 rad/s for about a second
_MAX_GAIN_RAD_S: Final = 3.0
_MAX_TRIM_RAD_S: Final = 0.3
_REST_S: Final = 1.0  # time constant of ρ without a gyro
_REST_WALK: Final = 0.01  # of ρ, rad/s per √s,
_REST_SHARE: Final = 0.1  # and of K, between two values of the steering one full scale apart
_GYRO_RAD_S: Final = 0.006  # white noise of a MEMS gyro (BNO055 data sheet: 0.3°/s in 50 Hz)


class SurgeModel:
    """sway_m_s is v above. slope: ∂u̇/∂u; per_gain: ∂u̇/∂g; accel_m_s2: u̇; all of the last step."""

    def __init__(self, cruise_m_s: float, cruise_throttle: float, surge_time_s: float) -> None:
        """cruise_throttle = 0 disables the model."""
        self._cruise_m_s, self._throttle, self._time_s = cruise_m_s, cruise_throttle, surge_time_s
        self._scale = cruise_m_s / (_STEEPNESS * surge_time_s)
        self.sway_m_s = self.accel_m_s2 = self.per_gain = 0.0
        self.slope = -_LINEAR / (_STEEPNESS * surge_time_s)

    def advance(
        self, surge_m_s: float, yaw_rate_rad_s: float, left: float, right: float, gain: float, dt_s: float
    ) -> float:
        """Surge after dt_s with the commands left and right, −1..1."""
        if not self._throttle > 0.0:
            self.sway_m_s = self.accel_m_s2 = self.per_gain = 0.0
            return surge_m_s * math.exp(-dt_s / self._time_s)
        u, v, scale = surge_m_s, self.sway_m_s, self._scale
        dt_s = min(dt_s, _MAX_STEP_S, self._time_s)
        a, b, x = left / self._throttle, right / self._throttle, u / self._cruise_m_s
        ahead = a * (_LINEAR + _QUADRATIC * a) if a >= 0.0 else _ASTERN * a * (_LINEAR - _QUADRATIC * a)
        ahead += b * (_LINEAR + _QUADRATIC * b) if b >= 0.0 else _ASTERN * b * (_LINEAR - _QUADRATIC * b)
        size = x if x >= 0.0 else -x
        self.per_gain = per_gain = 0.5 * scale * ahead
        self.slope = -(_LINEAR + 2.0 * _QUADRATIC * size) / (_STEEPNESS * self._time_s)
        accel = gain * per_gain - scale * x * (_LINEAR + _QUADRATIC * size) + _SLOWED * v * yaw_rate_rad_s
        self.accel_m_s2 = accel
        limit = _MAX_SHARE * self._cruise_m_s
        slid = (v - dt_s * _SLIP * u * yaw_rate_rad_s) / (1.0 + dt_s / (_SWAY_SHARE * self._time_s))
        self.sway_m_s = limit if slid > limit else -limit if slid < -limit else slid
        u += dt_s * accel
        return limit if u > limit else -limit if u < -limit else u


class YawModel:
    """rate_rad_s is r; turning: the rate for K = 1 without r₀ and ρ; innovation_rad_s, variance: of gyro."""

    def __init__(self) -> None:
        self.rate_rad_s = self.turning = self.rest_rad_s = 0.0
        self.gain_rad_s, self.trim_rad_s = _GAIN_RAD_S, 0.0
        self.innovation_rad_s, self.variance = 0.0, 1.0
        self.left = self.right = self._rudder = 0.0  # at shafts and blade
        self._p00, self._p01, self._p11 = _GAIN_RAD_S**2, 0.0, 0.04
        self._rest_variance = 0.01
        self._is_measured = False  # since the last step

    def advance(self, left: float, right: float, rudder: float, dt_s: float) -> None:
        """Advance by dt_s with these commands, −1..1 per side. rudder: m above."""
        dt_s = min(dt_s, _MOTOR_S)
        share = dt_s / _MOTOR_S
        left = self.left = self.left + share * (left - self.left)
        right = self.right = self.right + share * (right - self.right)
        rudder = self._rudder = self._rudder + share * (rudder - self._rudder)
        asked = 0.5 * (left * abs(left) - right * abs(right)) + rudder
        step = dt_s / _HULL_S * (asked - self.turning)
        self.turning += step
        if self._is_measured:
            self._is_measured = False
        else:
            keep = 1.0 - dt_s / _REST_S
            self.rest_rad_s *= keep
            self._rest_variance *= keep * keep
        self._rest_variance += _REST_WALK * _REST_WALK * dt_s
        self._rest_variance += (_REST_SHARE * self.gain_rad_s) ** 2 * abs(step)
        self.rate_rad_s = self.gain_rad_s * self.turning + self.trim_rad_s + self.rest_rad_s

    def update(self, rate_rad_s: float) -> None:
        """Correct the rate by a gyro's, its bias subtracted."""
        self._is_measured = True
        innovation = self.innovation_rad_s = rate_rad_s - self.rate_rad_s
        variance = self.variance = self._rest_variance + _GYRO_RAD_S * _GYRO_RAD_S
        gain = self._rest_variance / variance
        self.rest_rad_s += gain * innovation
        self.rate_rad_s += gain * innovation
        self._rest_variance *= 1.0 - gain

    def learn(self, rate_rad_s: float, dt_s: float) -> None:
        """Update K and r₀ from a measured rate, dt_s after the last update."""
        turning = self.turning
        self._p00 += _GAIN_WALK * _GAIN_WALK * dt_s
        self._p11 += _TRIM_WALK * _TRIM_WALK * dt_s
        k0 = self._p00 * turning + self._p01
        k1 = self._p01 * turning + self._p11
        share = 1.0 / (k0 * turning + k1 + _MISFIT / max(dt_s, 0.02))
        innovation = share * (rate_rad_s - self.gain_rad_s * turning - self.trim_rad_s)
        before = self.gain_rad_s * turning + self.trim_rad_s
        self.gain_rad_s = min(max(self.gain_rad_s + k0 * innovation, 0.0), _MAX_GAIN_RAD_S)
        self.add_trim(k1 * innovation)
        self.rest_rad_s -= self.gain_rad_s * turning + self.trim_rad_s - before  # the rate stays
        self._p00 -= k0 * k0 * share
        self._p01 -= k0 * k1 * share
        self._p11 -= k1 * k1 * share

    def add_trim(self, rate_rad_s: float) -> float:
        """Add to r₀; returns how much its limits have left of that."""
        before = self.trim_rad_s
        self.trim_rad_s = min(max(before + rate_rad_s, -_MAX_TRIM_RAD_S), _MAX_TRIM_RAD_S)
        return self.trim_rad_s - before
