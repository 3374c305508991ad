"""Yaw response to steering: replaces a gyro that is late, slow or missing.

Nomoto's first-order model (T. I. Fossen, *Handbook of Marine Craft Hydrodynamics and Motion Control*, 2nd ed.
2021, chapter 7) behind a motor lag, with thrust proportional to the square of the command:

    T ṙ + r = K (½ (s_left |s_left| − s_right |s_right|) + m) + r0

m is the rudder's moment, in shares of full steering. K and the bias r0 (wind, unequal motors) are estimated
from the gyro by a Kalman filter of two random walks (Y. Bar-Shalom, X. R. Li, T. Kirubarajan, *Estimation
with Applications to Tracking and Navigation*, 2001, section 5.2).
"""

from typing import Final

LENGTH: Final = 128  # entries of the ring, five seconds
_MOTOR_S: Final = 0.15
_HULL_S: Final = 0.8
_GAIN_RAD_S: Final = 0.6  # initial K
_GAIN_WALK: Final = 0.02  # of K: rad/s per √s,
_TRIM_WALK: Final = 0.03  # and of r0: wind and speed change
_MISFIT: Final = 0.01  # (rad/s)² s: a model error of 0.1 rad/s for about a second
_MAX_GAIN_RAD_S: Final = 3.0
_MAX_TRIM_RAD_S: Final = 0.3


class YawRateModel:
    """rate_rad_s is the yaw rate at time_s, turned_rad the angle turned since boot, both clockwise.

    turning: the rate for K = 1 without r0.
    """

    def __init__(self) -> None:
        self.time_s = self.rate_rad_s = self.turned_rad = 0.0
        self._gain_rad_s, self._trim_rad_s = _GAIN_RAD_S, 0.0
        self._left = self._right = self._rudder = 0.0  # at shafts and blade
        self.turning = 0.0
        self._p00, self._p01, self._p11 = _GAIN_RAD_S**2, 0.0, 0.04
        self._times_s = [-1.0] * LENGTH
        self._turnings = [0.0] * LENGTH
        self._turned = [0.0] * LENGTH
        self._next = 0

    def advance(self, time_s: float, left: float, right: float, rudder: float = 0.0) -> None:
        """Advance to time_s with these commands, −1..1 per side. rudder: m above."""
        dt = time_s - self.time_s
        self.time_s = time_s
        dt = min(dt, _MOTOR_S)  # the motion during a stall of the loop is unknown
        share = dt / _MOTOR_S
        left = self._left = self._left + share * (left - self._left)
        right = self._right = self._right + share * (right - self._right)
        rudder = self._rudder = self._rudder + share * (rudder - self._rudder)
        asked = 0.5 * (left * abs(left) - right * abs(right)) + rudder
        turning = self.turning = self.turning + dt / _HULL_S * (asked - self.turning)
        rate = self.rate_rad_s = self._gain_rad_s * turning + self._trim_rad_s
        turned = self.turned_rad = self.turned_rad + rate * dt
        slot = self._next
        self._times_s[slot], self._turnings[slot], self._turned[slot] = time_s, turning, turned
        self._next = slot + 1 if slot + 1 < LENGTH else 0

    def rate_of(self, turning: float) -> float:
        """Rate in rad/s for a value of `turning`."""
        return self._gain_rad_s * turning + self._trim_rad_s

    def learn(self, rate_rad_s: float, turning: float, dt_s: float) -> None:
        """Update K and r0 from a measured rate at `turning`, dt_s after the last update."""
        self._p00 += _GAIN_WALK * _GAIN_WALK * dt_s
        self._p11 += _TRIM_WALK * _TRIM_WALK * dt_s
        k0 = self._p00 * turning + self._p01
        k1 = self._p01 * turning + self._p11
        share = 1.0 / (k0 * turning + k1 + _MISFIT / max(dt_s, 0.02))
        innovation = share * (rate_rad_s - self._gain_rad_s * turning - self._trim_rad_s)
        self._gain_rad_s = min(max(self._gain_rad_s + k0 * innovation, 0.0), _MAX_GAIN_RAD_S)
        self.adjust_bias(k1 * innovation)
        self._p00 -= k0 * k0 * share
        self._p01 -= k0 * k1 * share
        self._p11 -= k1 * k1 * share

    def adjust_bias(self, rate_rad_s: float) -> None:
        """Add to r0."""
        trim = self._trim_rad_s + rate_rad_s
        self._trim_rad_s = min(max(trim, -_MAX_TRIM_RAD_S), _MAX_TRIM_RAD_S)

    def at(self, time_s: float) -> tuple[float, float]:
        """turned_rad and turning at an earlier time; before the start of the ring, its oldest entry."""
        slot = self._next
        for _ in range(LENGTH):
            before = slot - 1 if slot else LENGTH - 1
            if self._times_s[before] < 0.0:
                break
            slot = before
            if self._times_s[slot] <= time_s:
                turning = self._turnings[slot]
                return self._turned[slot] + self.rate_of(turning) * (time_s - self._times_s[slot]), turning
        if slot == self._next:
            return self.turned_rad, self.turning
        return self._turned[slot], self._turnings[slot]
