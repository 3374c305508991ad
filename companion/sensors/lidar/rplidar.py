"""Requests and answers of Slamtec's RPLIDAR A1 (SLAMTEC LR001, interface protocol v2.8).

A request is A5 and its number. An answer begins with A5 5A, its length in 30 bits, 2 bits for one or many,
and its type. Of many, all but the first come without: a measurement has five bytes with a start bit, its
inverse, quality, a check bit, the angle in 1/64° clockwise from the front, and the range in 1/4 mm.
"""

import math
import struct
from collections.abc import Iterable
from typing import Final

from companion.core.status_text import Severity
from companion.sensors.framing import FrameReader
from companion.sensors.lidar.sectors import DOUBTFUL, NO_ECHO, Ray

BAUD: Final = 115_200
RAY_S: Final = 0.5e-3  # SLAMTEC LD108, A1M8: sample duration; the standard scan has 2,000 a second
SCAN, STOP, RESET, GET_HEALTH = b"\xa5\x20", b"\xa5\x25", b"\xa5\x40", b"\xa5\x52"
SPIN: Final = b"\xa5\xf0\x02\x94\x02\xc1"  # an A2's motor, 660 of 1023; an A1 ignores it
GOOD, WARNING, ERROR = range(3)
HEALTH: Final = {
    GOOD: (Severity.NOTICE, "good again"),
    WARNING: (Severity.WARNING, "warning"),
    ERROR: (Severity.ERROR, "hardware error"),
}

_ANSWER: Final = b"\xa5\x5a"
_HEADER: Final = 7
_LONGEST: Final = 64
_IS_HEALTH: Final = b"\xa5\x5a\x03\x00\x00\x00\x06"
_HEALTH: Final = struct.Struct("<7xBH")
_NODE: Final = struct.Struct("<BHH")
_SURE: Final = 4 * _NODE.size  # a node is one if three more follow: alone it has two bits to check
_Q6_RAD: Final = math.radians(1.0 / 64.0)


class RplidarReader(FrameReader):
    """Splits bytes into answers and, once a scan has begun, measurements."""

    _is_scanning = False

    def forget(self) -> None:
        """Wait for answers again."""
        super().forget()
        self._is_scanning = False

    def _size(self, held: bytes, at: int) -> int:
        if self._is_scanning:
            if len(held) < at + _SURE:
                return _SURE
            nodes = range(at, at + _SURE, _NODE.size)
            return _NODE.size * all((held[n] ^ held[n] >> 1) & held[n + 1] & 1 for n in nodes)
        if not _ANSWER.startswith(held[at : at + 2]):
            return 0
        if len(held) < at + _HEADER:
            return _HEADER
        word = int.from_bytes(held[at + 2 : at + 6], "little")
        self._is_scanning = bool(word >> 30)
        length = _HEADER + (0 if self._is_scanning else word)
        return length if length <= _LONGEST else 0

    def _is_whole(self, frame: bytes) -> bool:  # noqa: ARG002 (answers have no checksum)
        return True


def health_of(frame: bytes) -> tuple[int, int] | None:
    """Status and error code; None: another answer, or a measurement."""
    return _HEALTH.unpack(frame) if frame.startswith(_IS_HEALTH) and len(frame) == _HEALTH.size else None


def rays_of(frames: Iterable[bytes]) -> list[Ray]:
    """The rays of the measurements among the frames. A range of 0 is no echo."""
    rays: list[Ray] = []
    for flags, angle, range_q2 in _NODE.iter_unpack(
        b"".join(one for one in frames if len(one) == _NODE.size)
    ):
        range_m = NO_ECHO if range_q2 == 0 else DOUBTFUL if flags < 4 else range_q2 / 4000.0
        rays.append(((angle >> 1) * _Q6_RAD, range_m))
    return rays
