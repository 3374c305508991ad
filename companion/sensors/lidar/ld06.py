"""Packets of LDROBOT's LD06, LD19 and STL-19P, which send by themselves (LD06 development manual v1.0).

54 2C, speed, angle of the first of 12 rays, each with range in mm and confidence, angle of the last ray, time
stamp, CRC-8; angles in 0.01° clockwise from the front, numbers of two bytes with the lower one first.
"""

import math
import struct
from collections.abc import Iterable
from typing import Final

from companion.sensors.framing import FrameReader
from companion.sensors.lidar.sectors import DOUBTFUL, NO_ECHO, Ray

BAUD: Final = 230_400
RAY_S: Final = 1.0 / 4500.0  # an STL-19P measures 5,000 times a second: 2 ms off in a chunk of 20 ms
_HEADER: Final = b"\x54\x2c"
_PACKET: Final = struct.Struct("<4xH36sH3x")
_RAY: Final = struct.Struct("<HB")
_HUNDREDTH_RAD: Final = math.radians(0.01)
_WEAKEST: Final = 20  # confidence: as ArduPilot's AP_Proximity_LD06


def _crc_table(polynomial: int) -> bytes:
    table = bytes(range(256))
    for _ in range(8):
        table = bytes((one << 1 ^ polynomial * (one >> 7)) & 0xFF for one in table)
    return table


_CRC: Final = _crc_table(0x4D)


class Ld06Reader(FrameReader):
    """Splits bytes into packets with a valid CRC."""

    def _size(self, held: bytes, at: int) -> int:
        return _PACKET.size if _HEADER.startswith(held[at : at + 2]) else 0

    def _is_whole(self, frame: bytes) -> bool:
        crc = 0
        for one in frame:
            crc = _CRC[crc ^ one]
        return crc == 0


def rays_of(packets: Iterable[bytes]) -> list[Ray]:
    """Their rays, 12 each. A range of 0 is no echo."""
    rays: list[Ray] = []
    for packet in packets:
        first, points, last = _PACKET.unpack(packet)
        angle_rad, step_rad = first * _HUNDREDTH_RAD, (last - first) % 36_000 / 11.0 * _HUNDREDTH_RAD
        for range_mm, confidence in _RAY.iter_unpack(points):
            range_m = NO_ECHO if range_mm == 0 else DOUBTFUL if confidence < _WEAKEST else range_mm / 1000.0
            rays.append((angle_rad, range_m))
            angle_rad += step_rad
    return rays
