"""Kalman filter of four states: the water current, and the scale and rotation of the modelled thrust.

The velocity over ground is the velocity through the water plus the current c. The velocity through the water
W follows from thrust and compass up to a complex factor g = a + ib near 1:

    V = g W + c        north + i east

On a single course g and c are not separable: the innovation is shared in proportion to their variances. Each
further course adds information (Y. Bar-Shalom, X. R. Li, T. Kirubarajan, *Estimation with Applications to
Tracking and Navigation*, 2001: section 3.4, recursive least squares; section 5.2, the Kalman filter, here
with random walks). The argument of g is the compass offset plus the mean sideslip of the hull.
"""

import cmath
from typing import Final

CURRENT_SHARE: Final = 0.5  # initial standard deviation, of cruise speed
CURRENT_WALK: Final = 0.006  # of cruise speed, per √s: tides and gusts
GAIN_DOUBT: Final = 0.2
GAIN_WALK: Final = 0.002  # per √s: battery voltage falls
GAIN_SPREAD: Final = 0.1  # of gain, between two speeds one cruise speed apart
_SPEED_STEP: Final = 0.1  # of cruise speed
TURN_WALK: Final = 0.0005
IDLE_SHARE: Final = 0.15  # of cruise speed: at rest, the observed current may be the effect of a mooring
RESTORE_SHARE: Final = 0.03  # of cruise speed: change of the current since the restored estimate was valid
_GATE: Final = 18.0  # chi-square with two degrees of freedom, 99.99 %
_DOUBTS: Final = 25  # consecutive outliers after which the covariance is increased
_MIN_GAIN: Final = 0.3
_MAX_GAIN: Final = 3.0


class CurrentFilter:
    """current_m_s is c and gain is g of the module's equation; turn_rad is the heading correction."""

    def __init__(self, cruise_m_s: float, turn_doubt_rad: float) -> None:
        """turn_doubt_rad: standard deviation of the compass offset."""
        self._cruise_m_s = cruise_m_s
        self._speed_m_s = 0.0
        self._outliers = 0
        self.current_m_s = 0j
        self.gain = 1 + 0j
        self.turn_rad = 0.0
        self._p00 = self._p11 = (CURRENT_SHARE * cruise_m_s) ** 2
        self._p22, self._p33 = GAIN_DOUBT**2, turn_doubt_rad**2
        self._p01 = self._p02 = self._p03 = self._p12 = self._p13 = self._p23 = 0.0

    def velocity_m_s(self, through_water: complex) -> complex:
        """Velocity over ground for a velocity through the water."""
        return self.gain * through_water + self.current_m_s

    def variance(self, through_water: complex) -> float:
        """Variance of `velocity_m_s`, per axis, in m²/s²."""
        n, e = through_water.real, through_water.imag
        return (
            0.5 * (self._p00 + self._p11 + (self._p22 + self._p33) * (n * n + e * e))
            + n * (self._p02 + self._p13)
            + e * (self._p12 - self._p03)
        )

    def current_variance(self) -> float:
        """Variance of the current, per axis, in m²/s²."""
        return 0.5 * (self._p00 + self._p11)

    def rotate(self, turn_rad: float, doubt_rad: float) -> None:
        """Rotate the heading correction by turn_rad, clockwise; doubt_rad is its standard deviation."""
        self.gain *= cmath.rect(1.0, turn_rad)
        self.turn_rad = cmath.phase(self.gain)
        self._p33 += doubt_rad * doubt_rad

    def restore(self, current_m_s: complex, gain: complex) -> None:
        """Return to an earlier estimate, after learning from faulty data."""
        self.current_m_s, self.gain = current_m_s, gain
        self.turn_rad = cmath.phase(gain)
        more = (RESTORE_SHARE * self._cruise_m_s) ** 2
        self._p00 += more
        self._p11 += more

    def update(self, over_ground: complex, through_water: complex, variance: float, dt_s: float) -> complex:
        """Update from a velocity over ground and one through the water, dt_s after the last update.

        variance: of their difference, per axis. Returns the change of `velocity_m_s` for this velocity
        through the water.
        """
        cruise = self._cruise_m_s
        walk = (CURRENT_WALK * cruise) ** 2 * dt_s
        self._p00 += walk
        self._p11 += walk
        self._p22 += GAIN_WALK**2 * dt_s
        self._p33 += TURN_WALK**2 * dt_s
        n, e = through_water.real, through_water.imag
        speed_m_s = abs(through_water)
        step = abs(speed_m_s - self._speed_m_s) / cruise
        if step > _SPEED_STEP:  # the model's drag and thrust curves are approximate
            self._speed_m_s = speed_m_s
            self._p22 += GAIN_SPREAD**2 * step
        if speed_m_s < 0.1 * cruise:
            least = (IDLE_SHARE * cruise) ** 2
            self._p00, self._p11 = max(self._p00, least), max(self._p11, least)
        before = self.gain * through_water + self.current_m_s
        innovation = over_ground - before
        if abs(innovation) ** 2 > _GATE * (self.variance(through_water) + variance):
            self._outliers += 1
            if self._outliers < _DOUBTS:
                return 0j
            self._doubt()
        self._outliers = 0
        self._learn(1.0, 0.0, n, -e, innovation.real, variance)
        innovation = over_ground - (self.gain * through_water + self.current_m_s)
        self._learn(0.0, 1.0, e, n, innovation.imag, variance)
        size = abs(self.gain)
        if not _MIN_GAIN <= size <= _MAX_GAIN:
            self.gain *= min(max(size, _MIN_GAIN), _MAX_GAIN) / size if size > 0.0 else 1.0
        self.turn_rad = cmath.phase(self.gain)
        return self.gain * through_water + self.current_m_s - before

    def _doubt(self) -> None:
        """Increase the covariance: the current or the thrust has changed."""
        more = (0.5 * CURRENT_SHARE * self._cruise_m_s) ** 2
        self._p00 += more
        self._p11 += more
        self._p22 += (0.5 * GAIN_DOUBT) ** 2

    def _learn(self, h0: float, h1: float, h2: float, h3: float, innovation: float, variance: float) -> None:
        """Scalar update with the row (h0 h1 h2 h3)."""
        k0 = self._p00 * h0 + self._p01 * h1 + self._p02 * h2 + self._p03 * h3
        k1 = self._p01 * h0 + self._p11 * h1 + self._p12 * h2 + self._p13 * h3
        k2 = self._p02 * h0 + self._p12 * h1 + self._p22 * h2 + self._p23 * h3
        k3 = self._p03 * h0 + self._p13 * h1 + self._p23 * h2 + self._p33 * h3
        share = 1.0 / (h0 * k0 + h1 * k1 + h2 * k2 + h3 * k3 + variance)
        step = innovation * share
        self.current_m_s += complex(k0 * step, k1 * step)
        self.gain += complex(k2 * step, k3 * step)
        self._p00 -= k0 * k0 * share
        self._p01 -= k0 * k1 * share
        self._p02 -= k0 * k2 * share
        self._p03 -= k0 * k3 * share
        self._p11 -= k1 * k1 * share
        self._p12 -= k1 * k2 * share
        self._p13 -= k1 * k3 * share
        self._p22 -= k2 * k2 * share
        self._p23 -= k2 * k3 * share
        self._p33 -= k3 * k3 * share
