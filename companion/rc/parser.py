"""Framing shared by the receivers' serial protocols. Pure; never raises."""

from typing import Final

from companion.core.readings import RcReading

PACKED_BYTES: Final = 22
_SHIFTS: Final = tuple(range(0, 8 * PACKED_BYTES, 11))
_MASK: Final = (1 << 11) - 1
_PULSES_US: Final = tuple(1500 + round(0.625 * (value - 992)) for value in range(_MASK + 1))


class RcParser:
    """Splits a byte stream into frames. Each protocol defines size, checksum and content.

    After a bad frame, the search continues at its second byte. At most one frame is buffered. frames: count
    of good ones; skipped: count of bytes outside them.
    """

    def __init__(self) -> None:
        self.frames = 0
        self.skipped = 0
        self._held = b""

    def feed(self, data: bytes, time_s: float) -> RcReading | None:
        """Parse more bytes. The latest reading in them, None without a complete frame."""
        held = self._held + data
        at, end = 0, len(held)
        latest: RcReading | None = None
        while at < end:
            size = self._size(held, at)
            if size and at + size > end:
                break
            if size and self._is_whole(frame := held[at : at + size]):
                self.frames += 1
                latest = self._reading(frame, time_s) or latest
                at += size
            else:
                self.skipped += 1
                at += 1
        self._held = held[at:]
        return latest

    def forget(self) -> None:
        """Drop a partial frame: the line was interrupted."""
        self._held = b""

    def _size(self, held: bytes, at: int) -> int:
        """Length of the frame that may start here, or of what decides it; 0 if none starts here."""
        raise NotImplementedError

    def _is_whole(self, frame: bytes) -> bool:
        """Whether the frame's checksum is right."""
        raise NotImplementedError

    def _reading(self, frame: bytes, time_s: float) -> RcReading | None:
        """The reading of a good frame; None without channels."""
        raise NotImplementedError


def unpack_channels(packed: bytes) -> tuple[int, ...]:
    """Sixteen channels of 11 bits, lowest bit first, as in CRSF and S.BUS: 172 is 988 µs, 992 is 1500 µs.

    packed: PACKED_BYTES bytes.
    """
    bits = int.from_bytes(packed, "little")
    return tuple([_PULSES_US[bits >> shift & _MASK] for shift in _SHIFTS])
