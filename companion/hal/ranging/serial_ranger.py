"""Rangers on serial lines that send frames by themselves.

A02YYUW: DFRobot SEN0311, "UART output form". TFmini: Benewake SJ-PM-TFmini-S A00 and SJ-PM-TFmini Plus-T-01
A04, 5.3 and 5.4; SJ-PM-TFmini-T-01 A03 of the first TFmini.
"""

import select
import time
from collections.abc import Callable, Iterator
from typing import Final, NamedTuple

from companion.core.errors import HardwareError
from companion.links.interfaces import Link, Port
from companion.sensors.framing import FrameReader


class FrameKind(NamedTuple):
    """A frame of `length` bytes begins with `header` and ends with the low byte of the sum of all others."""

    name: str
    baud: int
    header: bytes
    length: int


A02YYUW: Final = FrameKind("A02YYUW", 9600, b"\xff", 4)
TFMINI: Final = FrameKind("TFmini", 115200, b"\x59\x59", 9)

Decoder = Callable[[bytes], float | None]

_PATIENCE_S: Final = 0.5  # more than the period of the slowest part, and of a servo's step
_POLL_S: Final = 0.05
_TOO_WEAK: Final = 0xFFFF
_SATURATED: Final = 0xFFFE
_DAZZLED: Final = 0xFFFC


class RangerReader(FrameReader):
    """Splits bytes into frames of a kind."""

    def __init__(self, kind: FrameKind) -> None:
        super().__init__()
        self._kind = kind

    def _size(self, held: bytes, at: int) -> int:
        header = self._kind.header
        return self._kind.length if header.startswith(held[at : at + len(header)]) else 0

    def _is_whole(self, frame: bytes) -> bool:
        return sum(frame[:-1]) & 0xFF == frame[-1]


def a02yyuw_range_m(frame: bytes) -> float | None:
    """Range in metres; the part sends 0 where nothing echoes."""
    millimetres = int.from_bytes(frame[1:3], "big")
    return millimetres / 1000.0 if millimetres else None


def tfmini_range_m(frame: bytes, min_strength: int) -> float | None:
    """Range in metres, None where nothing reflects enough. A strong reflection at 0 touches the part: 1 cm.
    Raises HardwareError: blinded by sunlight or a mirror: the range is unknown.
    """
    centimetres, strength = int.from_bytes(frame[2:4], "little"), int.from_bytes(frame[4:6], "little")
    if centimetres in (_SATURATED, _DAZZLED) or strength == 0xFFFF:
        raise HardwareError("TFmini: blinded by sunlight or a mirror")
    if centimetres == _TOO_WEAK or strength < min_strength:
        return None
    return max(centimetres, 1) / 100.0


class SerialRanger:
    """Satisfies `Ranger`. The port reconnects an unplugged part."""

    def __init__(
        self,
        port: Port,
        kind: FrameKind,
        decode: Decoder,
        max_range_m: float,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.period_s = 0.05
        self._port = port
        self._kind = kind
        self._decode = decode
        self._max_range_m = max_range_m
        self._clock = clock
        self._links: list[Link] = []
        self.reader = RangerReader(kind)

    def ping_m(self) -> float | None:
        """The newest range that has arrived, or the next one; takes up to half a second.
        Raises HardwareError: no frame arrives, or the part is blinded.
        """
        deadline_s = self._clock() + _PATIENCE_S
        while True:
            frames = [frame for chunk in self._receive() for frame in self.reader.split(chunk)]
            if frames:
                range_m = self._decode(frames[-1])
                return None if range_m is None or range_m > self._max_range_m else range_m
            if self._clock() >= deadline_s:
                raise HardwareError(f"{self._kind.name}: no frames; check its wires and {self._port.name}")
            descriptors = [link.fileno() for link in self._links]
            select.select(descriptors, [], [], _POLL_S)

    def forget(self) -> None:
        for _ in self._receive():
            pass
        self.reader.forget()

    def close(self) -> None:
        self._port.close()

    def _receive(self) -> Iterator[bytes]:
        for link in self._port.accept():
            self._links.append(link)
            self.reader.forget()
        for link in self._links:
            yield from link.receive()
        self._links = [link for link in self._links if not link.is_closed]
