"""The field at a magnetometer aboard, in body axes, of the same iron as the angles of `CompassSettings`.

To first order in A, a deviation of A sin(ψ − α) is that of a hard iron field of −A cos α ahead and A sin α to
starboard, and one of A sin 2(ψ − α) that of a soft iron matrix with −A cos 2α and A cos 2α added to its
diagonal and A sin 2α beside it, as shares of the horizontal field.
"""

import math
from collections.abc import Callable

from companion.core.vectors import Vector
from sitl.world.sensors.settings import CompassSettings


class BodyField:
    """The field for a heading and a motor current. noise: of standard deviation 1."""

    def __init__(self, settings: CompassSettings, noise: Callable[[], float]) -> None:
        self._noise = noise
        self._horizontal_mg = settings.magnetometer_mg
        self._noise_mg = self._horizontal_mg * math.radians(settings.noise_deg)
        self._down_mg = self._horizontal_mg * math.tan(math.radians(settings.dip_deg))
        self._declination_rad = math.radians(settings.declination_deg)
        self._hard = _hard(settings.hard_iron_deg, settings.hard_iron_at_deg)
        self._motor = _hard(settings.motor_deg_per_a, settings.motor_at_deg)
        soft_rad, at_rad = math.radians(settings.soft_iron_deg), math.radians(settings.soft_iron_at_deg)
        self._soft = -soft_rad * math.cos(2.0 * at_rad), soft_rad * math.sin(2.0 * at_rad)

    def at(self, heading_rad: float, motor_current_a: float) -> Vector:
        """In mG; heading_rad from true north."""
        magnetic_rad = heading_rad - self._declination_rad
        cos, sin = math.cos(magnetic_rad), math.sin(magnetic_rad)
        p, q = self._soft
        ahead = (1.0 + p) * cos - q * sin + self._hard[0] + motor_current_a * self._motor[0]
        aside = q * cos - (1.0 - p) * sin + self._hard[1] + motor_current_a * self._motor[1]
        return (
            self._horizontal_mg * ahead + self._noise_mg * self._noise(),
            self._horizontal_mg * aside + self._noise_mg * self._noise(),
            self._down_mg + self._noise_mg * self._noise(),
        )


def _hard(size_deg: float, at_deg: float) -> tuple[float, float]:
    size, at_rad = math.radians(size_deg), math.radians(at_deg)
    return -size * math.cos(at_rad), size * math.sin(at_rad)
