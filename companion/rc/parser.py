"""What the receivers' serial protocols have in common: frames in a stream of bytes. Pure; never raises."""

from typing import Final

from companion.sensors.readings import RcReading

PACKED_BYTES: Final = 22
_SHIFTS: Final = tuple(range(0, 8 * PACKED_BYTES, 11))
_MASK: Final = (1 << 11) - 1
_PULSES_US: Final = tuple(1500 + round(0.625 * (value - 992)) for value in range(_MASK + 1))


class RcParser:
    """Cuts a stream into frames, whatever is between them; each protocol says what a frame looks like.

    A frame that turns out to be none costs its first byte only, so the next one is found within it. No more
    than the longest frame is ever held. frames: those that were good; skipped: bytes that belonged to none.
    """

    def __init__(self) -> None:
        self.frames = 0
        self.skipped = 0
        self._held = b""

    def feed(self, data: bytes, time_s: float) -> RcReading | None:
        """Take what has come; the latest reading in it, None where no frame has been completed."""
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
        """Drop half a frame: the line was cut."""
        self._held = b""

    def _size(self, held: bytes, at: int) -> int:
        """How long the frame is that may begin here, or how many bytes it takes to tell; 0 if none does."""
        raise NotImplementedError

    def _is_whole(self, frame: bytes) -> bool:
        """Whether its checksum, or what there is instead, is right."""
        raise NotImplementedError

    def _reading(self, frame: bytes, time_s: float) -> RcReading | None:
        """What a good frame says; None if it says nothing of the channels."""
        raise NotImplementedError


def unpack_channels(packed: bytes) -> tuple[int, ...]:
    """Sixteen channels of 11 bits, the lowest bit first, as CRSF and S.BUS have them: 172 is 988 µs, 992 the
    centre, 1811 is 2012 µs.

    packed: PACKED_BYTES bytes.
    """
    bits = int.from_bytes(packed, "little")
    return tuple([_PULSES_US[bits >> shift & _MASK] for shift in _SHIFTS])
