"""Numbers as 32-bit floats, which MAVLink carries, and as people write them."""

import struct
from typing import Final

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
