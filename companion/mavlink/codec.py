"""Encoding and decoding of messages, per link, without I/O.

Received data never raises: invalid bytes are skipped and counted.
"""

from typing import NamedTuple

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message
from companion.mavlink.finder import Counters, FrameFinder
from companion.mavlink.framing import build_frame
from companion.mavlink.layout import LAYOUTS

__all__ = ["Counters", "Decoder", "Encoder", "Received"]


class Received(NamedTuple):
    """A message, its sender, and its original frame."""

    message: Message
    sender: Address
    frame: bytes = b""


class Encoder:
    """Encodes a component's messages as MAVLink 2 frames for one link, with its own sequence."""

    def __init__(self, address: Address, counters: Counters | None = None) -> None:
        self.address = address
        self.counters = Counters() if counters is None else counters
        self._sequence = 0

    def encode(self, message: Message, sender: Address | None = None) -> bytes:
        """One frame. sender: another, whose message is passed on. Raises struct.error: a value does not fit
        its field.
        """
        layout = LAYOUTS[message.get_msgId()]
        data = build_frame(sender or self.address, self._sequence, layout, layout.pack(message))
        self._sequence = (self._sequence + 1) & 0xFF
        self.counters.frames_out += 1
        self.counters.bytes_out += len(data)
        return data


class Decoder:
    """Decodes the messages of the dialect; others are counted and skipped.

    datagram: chunks are independent. Otherwise they are parts of a stream, of which at most one incomplete
    frame is kept.
    """

    def __init__(self, datagram: bool, counters: Counters | None = None) -> None:
        self._finder = FrameFinder(datagram, counters)
        self.counters = self._finder.counters

    def feed(self, data: bytes) -> list[Received]:
        """The messages completed by these bytes, oldest first. Never raises."""
        return [
            Received(frame.layout.unpack(frame.payload), frame.sender, frame.data)
            for frame in self._finder.feed(data)
            if frame.layout is not None
        ]
