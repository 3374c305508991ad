"""Yaw: how steering turns the hull, and how waves do.

Nomoto's first-order model (T. I. Fossen, *Handbook of Marine Craft Hydrodynamics and Motion Control*, 2nd ed.
2021, chapter 7) behind a motor lag, thrust proportional to the square of the command:

    T_r ω̇ + ω = ½ (s_left |s_left| − s_right |s_right|) + m        r = K ω + ρ

m is the rudder's moment, in shares of full steering. ρ, the rest of the rate, and K, initially
`handling.turn_rate_rad_s`, are random walks. First-order waves turn the hull to and fro as well, by ψ_w with
the rate r_w, faster than steering can answer. They are a lightly damped oscillator at the encounter frequency
ω_e (the same, chapter 13: wave filtering):

    ψ̈_w + 2 λ ω_e ψ̇_w + ω_e² ψ_w = noise        gyro = r + r_w

A Kalman filter corrects ρ, K, r_w and ψ_w by every reading of the gyro. The rate r therefore follows a
steering command at once by the model, without the gyro's noise and the waves.
"""

import math
from typing import Final

from companion.core.units import clamp
from companion.estimation.hull_model import GAIN, GAIN_WALK

_REST_WALK: Final = 0.008  # of ρ, rad/s per √s: NIS of the gyro: 0.98 in gusts of 8 m/s, 0.84 in calm,
# more in waves, which lift propellers out of the water: shares of r_w per √s, chosen on zigzags of seeds
# 1302 and 1305. With less the boat answers its own swings too late.
_WAVE_WALK: Final = 0.15
_GYRO_RAD_S: Final = 0.006  # white noise of a MEMS gyro (BNO055 data sheet: 0.3°/s in 50 Hz)
_DAMPING: Final = 0.26  # λ of a Pierson-Moskowitz sea (Fossen, section 10.2)
_SLOW_RAD_S: Final = 0.7  # what turns the hull more slowly are gusts, or errors of K,
_FAST_RAD_S: Final = 8.0  # and faster, noise
_MEMORY_S: Final = 8.0  # of the spectrum: two waves or more
_STRAIGHT: Final = 0.05  # of full steering, mean of a second: beyond, the rest is the model's error
# Yaw acceleration in calm water: 0.03 on zigzags, 0.05 in gusts of 10 m/s. Waves of 0.05 m give 0.08
_CALM_RAD_S2: Final = 0.06
_BANDWIDTH_RAD_S: Final = 1.6  # of the heading loop (config.tuning.Heading), which answers what is slower
_MISFIT: Final = 0.5  # of what steering gives, on a hull that is not the model: its own swings are no waves


class WaveSpectrum:
    """Mean frequency and size of the waves in the measured yaw rate, on straight courses.

    A state variable filter gives the band's rate and acceleration; the ratio of their variances is the square
    of the frequency (D. J. W. Belleter, R. Galeazzi, T. I. Fossen, *Experimental verification of a global
    exponential stable nonlinear wave encounter frequency estimator*, Ocean Engineering 97, 2015).

    share: 0 in calm water, 1 in waves. variance: of r_w. encounter_rad_s: ω_e.
    """

    __slots__ = (
        "_accel", "_band", "_calm", "_rates", "_slow", "_squares", "_turning",
        "encounter_rad_s", "share", "variance",
    )  # fmt: skip

    def __init__(self) -> None:
        self.share = self.variance = self.encounter_rad_s = 0.0
        self._slow = self._band = self._accel = self._turning = 0.0
        self._rates = self._squares = self._calm = 0.0  # variances of rate, acceleration, and in calm water

    def update(self, rate_rad_s: float, turning: float, accel_rad_s2: float, dt_s: float) -> None:
        """Take the rate that steering does not explain, what is steered, and the acceleration of that."""
        self._turning += dt_s * (turning - self._turning)
        self._slow += dt_s * _SLOW_RAD_S * (rate_rad_s - self._slow)
        step = dt_s * _FAST_RAD_S
        self._accel += step * _FAST_RAD_S * (rate_rad_s - self._slow - self._band)
        self._accel /= (1.0 + step) * (1.0 + step)  # implicit: any step is stable
        self._band += dt_s * self._accel
        if abs(self._turning) < _STRAIGHT:
            weight = dt_s / _MEMORY_S
            self._rates += weight * (self._band * self._band - self._rates)
            self._squares += weight * (self._accel * self._accel - self._squares)
            calm = _CALM_RAD_S2 * _CALM_RAD_S2 + _MISFIT * _MISFIT * accel_rad_s2 * accel_rad_s2
            self._calm += weight * (calm - self._calm)
            self.encounter_rad_s = omega = math.sqrt(self._squares / max(self._rates, 1e-9))
            above = clamp(omega / _BANDWIDTH_RAD_S - 1.0, 0.0, 1.0)
            self.share = above * max(1.0 - self._calm / max(self._squares, 1e-9), 0.0)
            self.variance = self.share * self._rates


class YawModel:
    """rate_rad_s is r, turning is ω, rest_rad_s is ρ, gain_rad_s is K, wave_rad is ψ_w and
    wave_rad_s r_w.

    nominal_rad_s: initial K. innovation_rad_s, variance: of the gyro.
    """

    def __init__(self, gain_rad_s: float, turn_time_s: float = 0.8, motor_time_s: float = 0.15) -> None:
        """gain_rad_s: initial K; turn_time_s: T_r; motor_time_s: lag of the motors."""
        self._turn_s, self._motor_s = turn_time_s, motor_time_s
        self._gain_variance, self._gain_walk = (GAIN * gain_rad_s) ** 2, (GAIN_WALK * gain_rad_s) ** 2
        self.gain_rad_s = self.nominal_rad_s = gain_rad_s
        self.rate_rad_s = self.turning = self.rest_rad_s = 0.0
        self.innovation_rad_s, self.variance = 0.0, 1.0
        self._effort = self._rest_variance = self._rest_gain = 0.0  # the last: covariance of ρ and K
        self._is_measured = False  # since the last step
        self.waves = WaveSpectrum()
        self._forget_waves()

    def _forget_waves(self) -> None:
        self.wave_rad = self.wave_rad_s = 0.0
        # variances of r_w and ψ_w, and covariances: of r_w with ψ_w, of ρ with both, of K with both
        self._rates = self._angles = self._rate_angle = 0.0
        self._rest_rate = self._rest_angle = self._gain_rate = self._gain_angle = 0.0

    def advance(self, left: float, right: float, rudder: float, dt_s: float) -> None:
        """Advance by dt_s with these commands, −1..1 per side. rudder: m above."""
        dt_s = min(dt_s, self._motor_s)
        share = min(dt_s / self._turn_s, 1.0)
        asked = 0.5 * (left * abs(left) - right * abs(right)) + rudder
        self._effort += dt_s / self._motor_s * (asked - self._effort)
        self.turning += share * (self._effort - self.turning)
        if not self._is_measured:
            self.rest_rad_s -= share * self.rest_rad_s
        else:
            unexplained = self.innovation_rad_s + self.rest_rad_s + self.wave_rad_s
            accel_rad_s2 = self.gain_rad_s * (self._effort - self.turning) / self._turn_s
            self.waves.update(unexplained, self.turning, accel_rad_s2, dt_s)
        self._is_measured = False
        self._rest_variance += _REST_WALK * _REST_WALK * dt_s
        self._gain_variance += self._gain_walk * dt_s
        self.rate_rad_s = self.gain_rad_s * self.turning + self.rest_rad_s
        if self.waves.variance > 0.0:
            self._advance_waves(dt_s)
        elif self._rates > 0.0:
            self._forget_waves()

    def _advance_waves(self, dt_s: float) -> None:
        waves = self.waves
        omega, variance = waves.encounter_rad_s, waves.variance
        keep, back = 1.0 - 2.0 * _DAMPING * omega * dt_s, -omega * omega * dt_s
        self.wave_rad_s = keep * self.wave_rad_s + back * self.wave_rad
        self.wave_rad += dt_s * self.wave_rad_s
        mixed = keep * self._rate_angle + back * self._angles
        self._rates = keep * (keep * self._rates + back * self._rate_angle) + back * mixed
        self._rates += 4.0 * _DAMPING * omega * variance * dt_s
        self._rest_variance += _WAVE_WALK * _WAVE_WALK * variance * dt_s
        self._rate_angle = mixed + dt_s * self._rates
        self._angles += dt_s * (mixed + self._rate_angle)
        self._rest_rate = keep * self._rest_rate + back * self._rest_angle
        self._rest_angle += dt_s * self._rest_rate
        self._gain_rate = keep * self._gain_rate + back * self._gain_angle
        self._gain_angle += dt_s * self._gain_rate

    def update(self, rate_rad_s: float, *, learns: bool = True) -> None:
        """Correct the rate by a gyro's, its bias subtracted, and K unless that is taken for known."""
        self._is_measured = True
        innovation = self.innovation_rad_s = rate_rad_s - self.rate_rad_s - self.wave_rad_s
        turning = self.turning
        unknown = turning
        if not learns:
            unknown = self._rest_gain = self._gain_rate = self._gain_angle = 0.0
        rest = self._rest_variance + unknown * self._rest_gain + self._rest_rate
        gain = self._rest_gain + unknown * self._gain_variance + self._gain_rate
        rate = self._rest_rate + unknown * self._gain_rate + self._rates
        variance = self.variance = rest + unknown * gain + rate + _GYRO_RAD_S * _GYRO_RAD_S
        self._rest_variance -= rest * rest / variance
        self._rest_gain -= rest * gain / variance
        self._gain_variance -= gain * gain / variance
        self.rest_rad_s += rest * innovation / variance
        self.gain_rad_s += gain * innovation / variance
        self.rate_rad_s = self.gain_rad_s * turning + self.rest_rad_s
        if self._rates > 0.0:
            angle = self._rest_angle + unknown * self._gain_angle + self._rate_angle
            self._rates -= rate * rate / variance
            self._angles -= angle * angle / variance
            self._rate_angle -= rate * angle / variance
            self._rest_rate -= rest * rate / variance
            self._rest_angle -= rest * angle / variance
            self._gain_rate -= gain * rate / variance
            self._gain_angle -= gain * angle / variance
            self.wave_rad_s += rate * innovation / variance
            self.wave_rad += angle * innovation / variance
