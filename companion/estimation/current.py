"""The set of the water, with what thrust and compass are worth: a Kalman filter of four states.

A boat's velocity over ground is its velocity through the water plus the set c. The velocity through the water
W is known from thrust and compass up to a gain and a turn, one complex factor g = a + ib near 1:

    V = g W + c        north + i east

On one course g and c cannot be told apart, and the doubts in each share what is left over; every other
course tells more (Y. Bar-Shalom, X. R. Li, T. Kirubarajan, *Estimation with Applications to Tracking and
Navigation*, 2001: section 3.4, recursive least squares; section 5.2, the Kalman filter, here with random
walks). The argument of g is the compass's offset, with the hull's own crabwise habit in it.
"""

import cmath
from typing import Final

CURRENT_SHARE: Final = 0.5  # one standard deviation beforehand, of cruise speed
CURRENT_WALK: Final = 0.006  # of cruise speed, per √s: tides and gusts
GAIN_DOUBT: Final = 0.2
GAIN_WALK: Final = 0.002  # per √s: the pack runs down
GAIN_SPREAD: Final = 0.1  # from one speed to another, a cruise speed apart
_SPEED_STEP: Final = 0.1  # in shares of cruise speed
TURN_WALK: Final = 0.0005
IDLE_SHARE: Final = 0.15  # what a boat at rest has seen of the set may be no more than its mooring
RESTORE_SHARE: Final = 0.03  # what has changed of the set since that which is recalled was true
_GATE: Final = 18.0  # chi-square of two, 99.99 %
_DOUBTS: Final = 25  # so many surprises in a row, and what was learned is doubted
_MIN_GAIN: Final = 0.3
_MAX_GAIN: Final = 3.0


class CurrentFilter:
    """current_m_s is c and gain is g, of the text above; turn_rad: what the heading has to be turned by."""

    __slots__ = (
        "_cruise_m_s",
        "_outliers",
        "_p00",
        "_p01",
        "_p02",
        "_p03",
        "_p11",
        "_p12",
        "_p13",
        "_p22",
        "_p23",
        "_p33",
        "_speed_m_s",
        "current_m_s",
        "gain",
        "turn_rad",
    )  # fmt: skip

    def __init__(self, cruise_m_s: float, turn_doubt_rad: float) -> None:
        """turn_doubt_rad: one standard deviation of the compass's offset."""
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
        """Velocity over ground, from velocity through the water."""
        return self.gain * through_water + self.current_m_s

    def variance(self, through_water: complex) -> float:
        """Of that velocity, per axis, in m²/s²."""
        n, e = through_water.real, through_water.imag
        return (
            0.5 * (self._p00 + self._p11 + (self._p22 + self._p33) * (n * n + e * e))
            + n * (self._p02 + self._p13)
            + e * (self._p12 - self._p03)
        )

    def current_variance(self) -> float:
        """Of the set, per axis, in m²/s²."""
        return 0.5 * (self._p00 + self._p11)

    def rotate(self, turn_rad: float, doubt_rad: float) -> None:
        """The heading is off by so much more, clockwise; how sure that is."""
        self.gain *= cmath.rect(1.0, turn_rad)
        self.turn_rad = cmath.phase(self.gain)
        self._p33 += doubt_rad * doubt_rad

    def restore(self, current_m_s: complex, gain: complex) -> None:
        """What was learned since these were right was wrong."""
        self.current_m_s, self.gain = current_m_s, gain
        self.turn_rad = cmath.phase(gain)
        more = (RESTORE_SHARE * self._cruise_m_s) ** 2
        self._p00 += more
        self._p11 += more

    def update(self, over_ground: complex, through_water: complex, variance: float, dt_s: float) -> complex:
        """Learn from a velocity over ground and through the water, dt_s after the last one.

        variance: of their difference, per axis. Returns by how much `velocity_m_s` has changed for this
        velocity through the water.
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
        if step > _SPEED_STEP:  # drag and thrust have not quite the shape that the model gives them
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
        """What was learned does not hold any more: the tide has turned, or a propeller is foul."""
        more = (0.5 * CURRENT_SHARE * self._cruise_m_s) ** 2
        self._p00 += more
        self._p11 += more
        self._p22 += (0.5 * GAIN_DOUBT) ** 2

    def _learn(self, h0: float, h1: float, h2: float, h3: float, innovation: float, variance: float) -> None:
        """One scalar update with the row (h0 h1 h2 h3)."""
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
