"""Gusty wind at the hull: a mean, and turbulence along it and across it.

Each part of the turbulence is a first-order Gauss-Markov process, the form that the Dryden spectrum has along
the wind; across it is weaker by LATERAL. (The spectrum's shape follows T. I. Fossen, *Handbook of Marine
Craft Hydrodynamics and Motion Control*, 2nd edition, Wiley 2021, chapter 10.1, where a slowly varying mean
and white noise through a low pass stand for the gusts.) The scales are those of the lowest metre above
water: turbulence of 15 to 25 % of the mean, correlated for a few seconds.
"""

import math

from sitl.world.environment.settings import Environment
from sitl.world.sampling import TIME_SLACK_S, generator

RATE_HZ = 10.0  # of the gusts; the force in between follows the boat's own motion
PEAK_FACTOR = 3.3  # the highest of ten minutes lies that many standard deviations above the mean
LATERAL = 0.8  # deviation across the wind, of that along it: 1.9 to 2.4 in the neutral surface layer


class Wind:
    """The air's velocity over ground, where it blows *to*: north_m_s, east_m_s. Still air has is_calm."""

    def __init__(self, environment: Environment, seed: int) -> None:
        """Start with gusts in their steady state."""
        self._random = generator(seed, "wind")
        self._keep = math.exp(-1.0 / (RATE_HZ * environment.gust_s))
        self._drive = math.sqrt(1.0 - self._keep * self._keep)
        self._along, self._across = self._random.gauss(0.0, 1.0), self._random.gauss(0.0, 1.0)
        self._next = 0
        self.set_wind(environment.wind_m_s, math.radians(environment.wind_from_deg), environment.gust_m_s)

    def set_wind(self, mean_m_s: float, from_rad: float, gust_m_s: float = 0.0) -> None:
        """Set the wind: mean, direction it comes from (clockwise from north) and gust peaks.

        Peaks below the mean are no gusts at all.
        """
        self._mean_m_s, self._from_rad = mean_m_s, from_rad
        self._deviation_m_s = max(0.0, gust_m_s - mean_m_s) / PEAK_FACTOR
        self.is_calm = mean_m_s == 0.0 and self._deviation_m_s == 0.0
        self._point()

    def step(self, now_s: float) -> None:
        """Advance the gusts to now_s, when due."""
        if now_s + TIME_SLACK_S < self._next / RATE_HZ:
            return
        self._next = math.floor(RATE_HZ * (now_s + TIME_SLACK_S)) + 1
        if self._deviation_m_s > 0.0:
            gauss, keep, drive = self._random.gauss, self._keep, self._drive
            self._along = keep * self._along + drive * gauss(0.0, 1.0)
            self._across = keep * self._across + drive * gauss(0.0, 1.0)
            self._point()

    def _point(self) -> None:
        along = self._mean_m_s + self._deviation_m_s * self._along
        across = LATERAL * self._deviation_m_s * self._across
        cos, sin = math.cos(self._from_rad), math.sin(self._from_rad)
        self.north_m_s = -along * cos + across * sin
        self.east_m_s = -along * sin - across * cos
