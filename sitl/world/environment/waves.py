"""Waves on deep water: how they carry, turn and lift a small hull.

The sea is a sum of COMPONENTS regular waves of equal energy whose frequencies follow the modified
Pierson-Moskowitz spectrum (T. I. Fossen, *Handbook of Marine Craft Hydrodynamics and Motion Control*, 2nd
edition, Wiley 2021, chapter 10.2): the share of energy below ω is exp(−1.25 (ω_p/ω)⁴), so the i-th
component's frequency has a closed form. Each has k = ω²/g, a random phase, and comes from up to SPREAD_RAD
either side.

A hull much shorter than the wave moves with the water: in the long-wave limit Froude-Krylov and added-mass
forces give it just the water's acceleration, and it makes no way through the water. So the orbital velocity
at the surface, averaged over the hull's length, carries the hull like a current that it does not feel; its
variation along the hull turns it. It lies along the water's slope: its own periods of heave, roll and pitch
are below a second, shorter than the waves'. Averages over the length 2 h are those of a wave with k h = x
along the hull,

    mean: sin x / x ≈ 1 / (1 + x²/6)            slope: 3 (sin x − x cos x) / x³ ≈ 1 / (1 + x²/10)

What does not average out is the Stokes drift ω k a² at the surface.
"""

import math
from typing import NamedTuple

from sitl.world.environment.settings import Environment
from sitl.world.sampling import generator

COMPONENTS = 6
SPREAD_RAD = 0.4
GRAVITY_M_S2 = 9.81


class Component(NamedTuple):
    """One regular wave: amplitude, frequency, wave number, the unit vector it runs along, and its phase."""

    amplitude_m: float
    rate_rad_s: float
    number_per_m: float
    north: float
    east: float
    phase_rad: float


class Waves:
    """The sea around one hull, at the time of the last step.

    north_m_s, east_m_s: what the waves carry the hull by, Stokes drift included; drift_north_m_s,
    drift_east_m_s: that drift alone; yaw_rate_rad_s: how fast they turn it; heave_m: how high they lift it;
    roll_rad, pitch_rad: how far they lean it to starboard and raise its bow; stern_m: how much higher the
    water stands at the stern than the hull's own waterline there.
    """

    def __init__(self, environment: Environment, length_m: float, seed: int) -> None:
        """length_m: the hull's."""
        self.height_m = environment.wave_height_m
        self.is_calm = self.height_m == 0.0
        self._half_m = 0.5 * length_m
        self._components = () if self.is_calm else _components(environment, seed)
        drifts = [
            (one.rate_rad_s * one.number_per_m * one.amplitude_m**2, one.north, one.east)
            for one in self._components
        ]
        self.drift_north_m_s = math.fsum(drift * north for drift, north, _ in drifts)
        self.drift_east_m_s = math.fsum(drift * east for drift, _, east in drifts)
        self.north_m_s, self.east_m_s = self.drift_north_m_s, self.drift_east_m_s
        self.yaw_rate_rad_s = self.heave_m = self.stern_m = 0.0
        self.roll_rad = self.pitch_rad = 0.0

    def surface(self, north_m: float, east_m: float, time_s: float) -> tuple[float, float, float]:
        """Height of the water at a place, and its slopes northward and eastward."""
        height_m = slope_north = slope_east = 0.0
        for amplitude, rate, number, north, east, phase in self._components:
            angle = number * (north * north_m + east * east_m) - rate * time_s + phase
            height_m += amplitude * math.cos(angle)
            slope = -amplitude * number * math.sin(angle)
            slope_north += slope * north
            slope_east += slope * east
        return height_m, slope_north, slope_east

    def step(self, time_s: float, north_m: float, east_m: float, cos: float, sin: float) -> None:
        """Look at the sea at a time, a place and a heading, given by its cosine and sine."""
        north_m_s, east_m_s = self.drift_north_m_s, self.drift_east_m_s
        yaw = heave = stern = roll = pitch = 0.0
        for amplitude, rate, number, north, east, phase in self._components:
            angle = number * (north * north_m + east * east_m) - rate * time_s + phase
            up, slope = amplitude * math.cos(angle), amplitude * math.sin(angle)
            along, aside = north * cos + east * sin, east * cos - north * sin  # of the wave's way
            x = number * self._half_m * along
            square = x * x
            mean, tilt = 1.0 / (1.0 + square / 6.0), 1.0 / (1.0 + square / 10.0)
            carried = rate * up * mean
            north_m_s += carried * north
            east_m_s += carried * east
            turned = slope * number * tilt
            yaw -= rate * turned * along * aside
            pitch -= turned * along
            roll += turned * aside
            heave += up * mean
            # At the stern the water stands at cos(angle − x); the hull's line there is mean and tilt.
            stern += up * (1.0 / (1.0 + 0.5 * square) - mean) + slope * x * (mean - tilt)
        self.north_m_s, self.east_m_s = north_m_s, east_m_s
        self.yaw_rate_rad_s, self.heave_m, self.stern_m = yaw, heave, stern
        self.roll_rad, self.pitch_rad = roll, pitch


def _components(environment: Environment, seed: int) -> tuple[Component, ...]:
    random = generator(seed, "waves")
    peak_rad_s = 2.0 * math.pi / environment.wave_period_s
    # The significant height is four standard deviations; one wave's share of the variance is amplitude² / 2.
    amplitude_m = 0.25 * environment.wave_height_m * math.sqrt(2.0 / COMPONENTS)
    to_rad = math.radians(environment.wave_from_deg) + math.pi
    out = []
    for i in range(COMPONENTS):
        share = (i + random.uniform(0.2, 0.8)) / COMPONENTS
        rate = peak_rad_s * (1.25 / -math.log(share)) ** 0.25
        course = to_rad + random.uniform(-SPREAD_RAD, SPREAD_RAD)
        phase = random.uniform(0.0, 2.0 * math.pi)
        number = rate * rate / GRAVITY_M_S2
        out.append(Component(amplitude_m, rate, number, math.cos(course), math.sin(course), phase))
    return tuple(out)
