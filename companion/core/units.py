"""Unit conversions and angle arithmetic. SI and radians inside, degrees and scaled integers at the edges."""

import math
import struct
from typing import Final

TAU = 2.0 * math.pi
GPS_EPOCH_UNIX_S: Final = 315_964_800.0 - 18.0  # 1980-01-06, less the leap seconds until 2017, the last
KNOT_M_S: Final = 1852.0 / 3600.0
GPS_WEEK_S: Final = 604_800.0


def wrap_pi(angle_rad: float) -> float:
    """Wrap an angle into [−π, π)."""
    if -math.pi <= angle_rad < math.pi:
        return angle_rad
    return (angle_rad + math.pi) % TAU - math.pi


def wrap_two_pi(angle_rad: float) -> float:
    """Wrap an angle into [0, 2π)."""
    wrapped = angle_rad % TAU
    return wrapped if wrapped < TAU else 0.0  # −1e-17 % TAU rounds up to TAU itself


def clamp(value: float, low: float, high: float) -> float:
    """Limit value to [low, high]; NaN remains NaN."""
    return low if value < low else high if value > high else value


def deg_to_e7(angle_deg: float) -> int:
    """Degrees to MAVLink's 1e-7 degree integers, rounded to nearest."""
    return round(angle_deg * 1e7)


def e7_to_deg(angle_e7: int) -> float:
    """MAVLink's 1e-7 degree integers to degrees."""
    return angle_e7 / 1e7


LARGEST: Final = (2.0 - 2.0**-23) * 2.0**127


def as_float32(value: float) -> float:
    """The nearest 32-bit float; beyond the largest, the largest."""
    value = max(-LARGEST, min(value, LARGEST))
    result: float = struct.unpack("<f", struct.pack("<f", value))[0]
    return result


def shortest(value: float) -> str:
    """The shortest decimal with the same 32-bit float."""
    for digits in range(1, 10):
        short = float(f"{value:.{digits}g}")
        if as_float32(short) == as_float32(value):
            return repr(short).removesuffix(".0")
    return repr(value)
