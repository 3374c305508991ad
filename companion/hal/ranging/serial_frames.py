"""Frames of rangers on serial lines: bytes to ranges. Malformed input is counted, never raised.

A02YYUW: DFRobot SEN0311, "UART output form". TFmini: Benewake SJ-PM-TFmini-S A00 and SJ-PM-TFmini Plus-T-01
A04, 5.3 and 5.4; SJ-PM-TFmini-T-01 A03 of the first TFmini.
"""

from collections.abc import Callable
from typing import Final, NamedTuple

from companion.core.errors import HardwareError


class FrameKind(NamedTuple):
    """A frame of `length` bytes begins with `header` and ends with the low byte of the sum of all others.

    period_s: longest time between two frames.
    """

    name: str
    baud: int
    header: bytes
    length: int
    period_s: float


A02YYUW: Final = FrameKind("A02YYUW", 9600, b"\xff", 4, 0.3)
TFMINI: Final = FrameKind("TFmini", 115200, b"\x59\x59", 9, 0.01)

_TOO_WEAK: Final = 0xFFFF
_SATURATED: Final = 0xFFFE
_DAZZLED: Final = 0xFFFC


class FrameParser:
    """Finds the frames in a byte stream. `malformed`: those with a wrong sum."""

    def __init__(self, kind: FrameKind) -> None:
        self._kind = kind
        self._held = b""
        self.malformed = 0

    def feed(self, data: bytes) -> list[bytes]:
        """The whole frames; a partial one is kept."""
        header, length = self._kind.header, self._kind.length
        held, frames = self._held + data, list[bytes]()
        while True:
            begin = held.find(header)
            if begin < 0:
                held = held[-(len(header) - 1) :] if len(header) > 1 else b""
                break
            held = held[begin:]
            if len(held) < length:
                break
            if sum(held[: length - 1]) & 0xFF == held[length - 1]:
                frames.append(held[:length])
                held = held[length:]
            else:
                self.malformed += 1
                held = held[1:]
        self._held = held
        return frames

    def forget(self) -> None:
        """Drop a partial frame."""
        self._held = b""


def a02yyuw_range_m(frame: bytes) -> float | None:
    """Range in metres; the part sends 0 where nothing echoes."""
    millimetres = int.from_bytes(frame[1:3], "big")
    return millimetres / 1000.0 if millimetres else None


def tfmini_range_m(frame: bytes, min_strength: int) -> float | None:
    """Range in metres, None where nothing reflects enough. A strong reflection at 0 touches the part: 1 cm.

    Raises:
        HardwareError: blinded by sunlight or a mirror: the range is unknown.
    """
    centimetres, strength = int.from_bytes(frame[2:4], "little"), int.from_bytes(frame[4:6], "little")
    if centimetres in (_SATURATED, _DAZZLED) or strength == 0xFFFF:
        raise HardwareError("TFmini: blinded by sunlight or a mirror")
    if centimetres == _TOO_WEAK or strength < min_strength:
        return None
    return max(centimetres, 1) / 100.0


Decoder = Callable[[bytes], float | None]
