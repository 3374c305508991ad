"""Bytes to messages and back, per link, without I/O.

Nothing that arrives can raise: what is no frame is skipped and counted.
"""

from typing import NamedTuple

from companion.mavlink.address import Address
from companion.mavlink.counters import Counters
from companion.mavlink.dialect import Message
from companion.mavlink.finder import FrameFinder
from companion.mavlink.framing import build_frame
from companion.mavlink.layout import LAYOUTS

__all__ = ["Counters", "Decoder", "Encoder", "Received"]


class Received(NamedTuple):
    """A message, who sent it, and its frame as it came (to be passed on or logged unaltered)."""

    message: Message
    sender: Address
    frame: bytes = b""


class Encoder:
    """Turns one component's messages into MAVLink 2 frames for one link, numbered in its own sequence."""

    __slots__ = ("_sequence", "address", "counters")

    def __init__(self, address: Address, counters: Counters | None = None) -> None:
        self.address = address
        self.counters = Counters() if counters is None else counters
        self._sequence = 0

    def encode(self, message: Message) -> bytes:
        """One frame.

        Raises:
            struct.error: a field's value does not fit its type.
        """
        layout = LAYOUTS[message.get_msgId()]
        data = build_frame(self.address, self._sequence, layout, layout.pack(message))
        self._sequence = (self._sequence + 1) & 0xFF
        self.counters.frames_out += 1
        self.counters.bytes_out += len(data)
        return data


class Decoder:
    """Finds the messages of the dialect in what a link hands over; others are counted and left out.

    datagram: each chunk stands for itself, and nothing is kept of it. Otherwise the chunks are pieces of one
    stream, of which at most one unfinished frame is kept.
    """

    __slots__ = ("_finder",)

    def __init__(self, datagram: bool, counters: Counters | None = None) -> None:
        self._finder = FrameFinder(datagram, counters)

    @property
    def counters(self) -> Counters:
        """What has come so far."""
        return self._finder.counters

    def feed(self, data: bytes) -> list[Received]:
        """The messages that these bytes complete, oldest first. Never raises."""
        return [
            Received(frame.layout.unpack(frame.payload), frame.sender, frame.data)
            for frame in self._finder.feed(data)
            if frame.layout is not None
        ]
