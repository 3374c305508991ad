"""Yaw: how steering turns the hull, and how waves do.

Nomoto's first-order model (T. I. Fossen, *Handbook of Marine Craft Hydrodynamics and Motion Control*, 2nd ed.
2021, chapter 7) behind a motor lag, thrust proportional to the square of the command:

    T_r ω̇ + ω = ½ (s_left |s_left| − s_right |s_right|) + m        r = K ω + ρ

m is the rudder's moment, in shares of full steering; ρ, the rest of the rate, is a random walk. K / T_r, the
acceleration by full steering, and 1 / T_r, what the hull itself damps, are learned by recursive least squares
(K. J. Åström, B. Wittenmark, *Adaptive Control*, 2nd ed. 1995, section 2.2) from the measured rate, filtered
about the bandwidth of the heading loop: what is slower is wind. First-order waves turn the hull to and fro as
well, by ψ_w with the rate r_w, faster than steering can answer. They are a lightly damped oscillator at the
encounter frequency ω_e (the same, chapter 13: wave filtering):

    ψ̈_w + 2 λ ω_e ψ̇_w + ω_e² ψ_w = noise        gyro = r + r_w

A Kalman filter corrects ρ, r_w and ψ_w by every reading of the gyro. The rate r therefore follows a
steering command at once by the model, without the gyro's noise and the waves.
"""

import math
from typing import Final

from companion.core.units import clamp

_REST_WALK: Final = 0.014  # of ρ, rad/s per √s: NIS of the gyro: 1.1 on the known hull, 1.0 to 2.8 on others,
# more in waves, which lift propellers out of the water: shares of r_w per √s, chosen on zigzags of seeds
# 1302 and 1305. With less the boat answers its own swings too late.
_WAVE_WALK: Final = 0.15
_GYRO_RAD_S: Final = 0.006  # white noise of a MEMS gyro (BNO055 data sheet: 0.3°/s in 50 Hz)
_DAMPING: Final = 0.26  # λ of a Pierson-Moskowitz sea (Fossen, section 10.2)
_SLOW_RAD_S: Final = 0.7  # what turns the hull more slowly are gusts, or errors of K,
_FAST_RAD_S: Final = 8.0  # and faster, noise
_SINGULAR: Final = 1e-3  # below, steering and rate do not tell b from a
_MEMORY_S: Final = 8.0  # of the spectrum: two waves or more
_STRAIGHT: Final = 0.05  # of full steering, mean of a second: beyond, the rest is the model's error
_CALM_RAD_S2: Final = 0.03  # the gyro's noise alone gives 0.013
_BANDWIDTH_RAD_S: Final = 1.6  # of the heading loop (config.tuning.Heading), which answers what is slower
_MISFIT: Final = 0.5  # of what steering gives, while the hull is not learned: its own swings are no waves


# Of what is learned of the hull: ∫φ² dt of the filtered steering φ. A corner gives some 0.05
_MEMORY: Final = 0.5
_PRIOR: Final = 0.02  # what the configured figures count
_STEADY_RAD_S: Final = 0.3  # wind changes more slowly
_MOST: Final = 2.0  # by what K / T_r is off: 30 % in each of thrust and inertia make 1.9


class HullFit:
    """accel_rad_s2: K / T_r; damping_per_s: 1 / T_r, initially as given.

    With L = 1 / (s + ω_b), ω_b the bandwidth, ṙ = b e − a r is s L r = b L e − a L r.
    """

    __slots__ = (
        "_ee", "_er", "_ey", "_nominal", "_rate", "_rr", "_ry", "_slow", "_steering",
        "accel_rad_s2", "damping_per_s",
    )  # fmt: skip

    def __init__(self, accel_rad_s2: float, damping_per_s: float) -> None:
        self.accel_rad_s2, self.damping_per_s = self._nominal = accel_rad_s2, damping_per_s
        self._rate = self._steering = 0.0  # by L
        self._slow = (0.0, 0.0, 0.0)
        self._ee = self._rr = _PRIOR
        self._er, self._ey, self._ry = 0.0, _PRIOR * accel_rad_s2, -_PRIOR * damping_per_s

    @property
    def misfit(self) -> float:
        """The share of what steering gives that may be wrong: the standard deviation of K / T_r."""
        return _MISFIT * math.sqrt(_PRIOR / max(self._ee, _PRIOR))

    def update(self, rate_rad_s: float, effort: float, dt_s: float, *, learns: bool) -> None:
        """Take a measured rate and the steering, −1..1, behind the motors' lag."""
        self._rate += dt_s * (rate_rad_s - _BANDWIDTH_RAD_S * self._rate)
        self._steering += dt_s * (effort - _BANDWIDTH_RAD_S * self._steering)
        faster = rate_rad_s - _BANDWIDTH_RAD_S * self._rate
        slow_y, slow_e, slow_r = self._slow
        y, e, r = faster - slow_y, self._steering - slow_e, self._rate - slow_r
        low = dt_s * _STEADY_RAD_S
        self._slow = slow_y + low * y, slow_e + low * e, slow_r + low * r
        if not learns:
            return
        keep = 1.0 - dt_s * e * e / _MEMORY
        self._ee, self._er = keep * self._ee + dt_s * e * e, keep * self._er + dt_s * e * r
        self._rr, self._ey = keep * self._rr + dt_s * r * r, keep * self._ey + dt_s * e * y
        self._ry = keep * self._ry + dt_s * r * y
        accel, damping = self._nominal
        size = self._ee * self._rr - self._er * self._er
        if size > _SINGULAR * self._ee * self._rr:
            b = (self._rr * self._ey - self._er * self._ry) / size
            a = (self._er * self._ey - self._ee * self._ry) / size
            self.accel_rad_s2 = clamp(b, accel / _MOST, _MOST * accel)
            self.damping_per_s = clamp(a, 0.0, _MOST * damping)


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

    def update(self, rate_rad_s: float, turning: float, doubt_rad_s2: float, dt_s: float) -> None:
        """Take the rate that steering does not explain, what is steered, and the doubt in rad/s²."""
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
            calm = _CALM_RAD_S2 * _CALM_RAD_S2 + doubt_rad_s2 * doubt_rad_s2
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

    def __init__(self, accel_rad_s2: float, turn_time_s: float = 1.5, motor_time_s: float = 0.15) -> None:
        """accel_rad_s2: initial K / T_r; turn_time_s: T_r; motor_time_s: lag of the motors."""
        self._turn_s, self._motor_s = turn_time_s, motor_time_s
        self.gain_rad_s = self.nominal_rad_s = accel_rad_s2 * turn_time_s
        self.hull = HullFit(accel_rad_s2, 1.0 / turn_time_s)
        self.rate_rad_s = self.turning = self.rest_rad_s = 0.0
        self.innovation_rad_s, self.variance = 0.0, 1.0
        self._effort = self._rest_variance = 0.0
        self._measured: float | None = None  # since the last step
        self._learns = True
        self.waves = WaveSpectrum()
        self._forget_waves()

    def _forget_waves(self) -> None:
        self.wave_rad = self.wave_rad_s = 0.0
        # variances of r_w and ψ_w, and covariances: of r_w with ψ_w, of ρ with both
        self._rates = self._angles = self._rate_angle = 0.0
        self._rest_rate = self._rest_angle = 0.0

    def advance(self, left: float, right: float, rudder: float, dt_s: float) -> None:
        """Advance by dt_s with these commands, −1..1 per side. rudder: m above."""
        dt_s = min(dt_s, self._motor_s)
        share = min(dt_s / self._turn_s, 1.0)
        asked = 0.5 * (left * abs(left) - right * abs(right)) + rudder
        self._effort += dt_s / self._motor_s * (asked - self._effort)
        self.turning += share * (self._effort - self.turning)
        if self._measured is None:
            self.rest_rad_s -= share * self.rest_rad_s
        else:
            learns = self._learns and self.waves.share == 0.0  # a rate with waves biases the fit
            self.hull.update(self._measured, self._effort, dt_s, learns=learns)
            self.gain_rad_s = self.hull.accel_rad_s2 * self._turn_s
            unexplained = self.innovation_rad_s + self.rest_rad_s + self.wave_rad_s
            accel_rad_s2 = self.gain_rad_s * (self._effort - self.turning) / self._turn_s
            self.waves.update(unexplained, self.turning, self.hull.misfit * accel_rad_s2, dt_s)
        self._measured = None
        self._rest_variance += _REST_WALK * _REST_WALK * dt_s
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

    def update(self, rate_rad_s: float, *, learns: bool = True) -> None:
        """Correct the rate by a gyro's, its bias subtracted, and K unless that is taken for known."""
        self._measured, self._learns = rate_rad_s, learns
        innovation = self.innovation_rad_s = rate_rad_s - self.rate_rad_s - self.wave_rad_s
        rest, rate = self._rest_variance + self._rest_rate, self._rest_rate + self._rates
        variance = self.variance = rest + rate + _GYRO_RAD_S * _GYRO_RAD_S
        self._rest_variance -= rest * rest / variance
        self.rest_rad_s += rest * innovation / variance
        self.rate_rad_s = self.gain_rad_s * self.turning + self.rest_rad_s
        if self._rates > 0.0:
            angle = self._rest_angle + self._rate_angle
            self._rates -= rate * rate / variance
            self._angles -= angle * angle / variance
            self._rate_angle -= rate * angle / variance
            self._rest_rate -= rest * rate / variance
            self._rest_angle -= rest * angle / variance
            self.wave_rad_s += rate * innovation / variance
            self.wave_rad += angle * innovation / variance
