"""Telemetry logs: all frames of a link in `.tlog` format.

Each frame follows its time as 8 bytes, microseconds since 1970, big-endian (as in QGroundControl and
MAVProxy). The channel removes signatures and omits frames with a signing key.
"""

from collections.abc import Callable
from struct import Struct
from typing import Final

from companion.log.sink import Sink

_STAMP = Struct(">Q")
_BLOCK_BYTES: Final = 8192
_FLUSH_S: Final = 1.0


class TelemetryLog:
    """The log of one link."""

    def __init__(self, sink: Sink, clock_us: Callable[[], int]) -> None:
        """clock_us: microseconds since 1970, or since boot if unknown."""
        self.dropped = 0  # blocks
        self._sink = sink
        self._clock_us = clock_us
        self._block = bytearray()
        self._due_s = 0.0
        sink.begin()

    def add(self, frame: bytes) -> None:
        """Log one frame."""
        if len(self._block) > _BLOCK_BYTES:
            self._hand_over()
        self._block += _STAMP.pack(self._clock_us()) + frame

    def tick(self, now_s: float) -> None:
        """Flush periodically."""
        if now_s >= self._due_s and self._block:
            self._due_s = now_s + _FLUSH_S
            self._hand_over()

    def close(self) -> None:
        """The link has closed."""
        self._hand_over()
        self._sink.end()

    def _hand_over(self) -> None:
        if self._block and not self._sink.write(bytes(self._block), self._clock_us() * 1e-6):
            self.dropped += 1
        self._block.clear()
