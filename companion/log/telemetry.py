"""Telemetry logs: every frame of a link, both ways, in the `.tlog` form that ground stations replay.

Each frame stands behind its time as 8 bytes, microseconds since 1970, big-endian (the form of QGroundControl
and MAVProxy). Signatures are taken off, and a frame that carries a signing key is left out.
"""

from collections.abc import Callable
from struct import Struct
from typing import Final

from companion.log.sink import Sink
from companion.mavlink.dialect import crc16, dialect
from companion.mavlink.framing import MAGIC_V2, SIGNATURE_LENGTH, SIGNED
from companion.mavlink.layout import LAYOUTS

_STAMP = Struct(">Q")
_BLOCK_BYTES: Final = 8192
_FLUSH_S: Final = 1.0
_SECRET: Final = dialect.MAVLINK_MSG_ID_SETUP_SIGNING


def loggable(frame: bytes) -> bytes:
    """A frame as it may be logged: without its signature; empty when it must not be logged at all.

    A signed frame of a message that the dialect does not have keeps its shape, with zeros for a signature:
    its checksum cannot be worked out anew.
    """
    if frame[0] != MAGIC_V2:
        return frame
    message_id = int.from_bytes(frame[7:10], "little")
    if message_id == _SECRET:
        return b""
    if not frame[2] & SIGNED:
        return frame
    layout = LAYOUTS.get(message_id)
    if layout is None:
        return frame[:-SIGNATURE_LENGTH] + bytes(SIGNATURE_LENGTH)
    body = frame[1:2] + bytes((frame[2] & ~SIGNED,)) + frame[3 : -SIGNATURE_LENGTH - 2]
    return frame[:1] + body + crc16(body + layout.crc_extra).to_bytes(2, "little")


class TelemetryLog:
    """The log of one link."""

    __slots__ = ("_block", "_clock_us", "_due_s", "_sink", "dropped")

    def __init__(self, sink: Sink, clock_us: Callable[[], int]) -> None:
        """clock_us: microseconds since 1970, or since boot while the date is not known."""
        self.dropped = 0  # blocks of some frames
        self._sink = sink
        self._clock_us = clock_us
        self._block = bytearray()
        self._due_s = 0.0
        sink.begin()

    def add(self, frame: bytes) -> None:
        """Log one frame, whichever way it goes."""
        if len(self._block) > _BLOCK_BYTES:
            self._hand_over()
        if clean := loggable(frame):
            self._block += _STAMP.pack(self._clock_us()) + clean

    def tick(self, now_s: float) -> None:
        """Once in a while everything goes to the medium."""
        if now_s >= self._due_s and self._block:
            self._due_s = now_s + _FLUSH_S
            self._hand_over()

    def close(self) -> None:
        """The link has gone."""
        self._hand_over()
        self._sink.end()

    def _hand_over(self) -> None:
        if self._block and not self._sink.write(bytes(self._block), self._clock_us() * 1e-6):
            self.dropped += 1
        self._block.clear()
