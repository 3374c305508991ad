"""Bytes to messages and back, per link, without I/O.

Nothing that arrives can raise: what is no frame is skipped and counted. After a flaw the search goes on from
the byte behind the bad magic byte, so a stray one costs no frame that follows it.
"""

import re
from dataclasses import dataclass
from typing import NamedTuple

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message
from companion.mavlink.framing import MAGIC_V1, MAGIC_V2, Flaw, Frame, build_frame, claimed_length, read_frame
from companion.mavlink.layout import LAYOUTS

_next_magic = re.compile(rb"[\xfd\xfe]").search
_LATE = 128  # a sequence number that jumps this far ahead is one that comes late, or twice


@dataclass(slots=True)
class Counters:
    """What went over one link.

    bad_frames counts places where bytes were skipped that were no frame, bad_crc among them; unknown counts
    frames of messages that the dialect does not have; lost is what the senders' sequence numbers say is
    missing.
    """

    bytes_in: int = 0
    bytes_out: int = 0
    frames_in: int = 0
    frames_out: int = 0
    bad_frames: int = 0
    bad_crc: int = 0
    unknown: int = 0
    lost: int = 0


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
    """Finds the messages in what a link hands over.

    datagram: each chunk stands for itself, and nothing is kept of it. Otherwise the chunks are pieces of one
    stream, of which at most one unfinished frame is kept.
    """

    __slots__ = ("_blamed_to", "_last_sequence", "_position", "_rest", "counters", "datagram")

    def __init__(self, datagram: bool, counters: Counters | None = None) -> None:
        self.datagram = datagram
        self.counters = Counters() if counters is None else counters
        self._rest = b""
        self._position = 0  # of the rest's first byte since the link began
        self._blamed_to = -1  # bytes before this position have been counted as one flaw or another
        self._last_sequence: dict[Address, int] = {}

    def feed(self, data: bytes) -> list[Received]:
        """The messages that these bytes complete, oldest first. Never raises."""
        self.counters.bytes_in += len(data)
        if self._rest:
            data = self._rest + data
        received: list[Received] = []
        at, end = 0, len(data)
        while at < end:
            if data[at] not in (MAGIC_V2, MAGIC_V1):
                magic = _next_magic(data, at)
                begin, at = at, magic.start() if magic else end
                self._blame(begin, at)
                continue
            frame = read_frame(data, at)
            if isinstance(frame, Frame):
                received.append(self._receive(frame))
                at += len(frame.data)
            elif frame is Flaw.INCOMPLETE and not self.datagram:
                break
            else:
                self._refuse(frame, at, at + claimed_length(data, at))
                at += 1
        self._rest = b"" if self.datagram else data[at:]
        self._position += at
        return received

    def _receive(self, frame: Frame) -> Received:
        self.counters.frames_in += 1
        sender = frame.sender
        last = self._last_sequence.get(sender)
        missing = 0 if last is None else (frame.sequence - last - 1) & 0xFF
        if missing < _LATE:
            self.counters.lost += missing
            self._last_sequence[sender] = frame.sequence
        return Received(frame.layout.unpack(frame.payload), sender, frame.data)

    def _refuse(self, flaw: Flaw, begin: int, end: int) -> None:
        """Count a bad frame, unless its magic byte lies within one that has been counted."""
        if self._position + begin < self._blamed_to:
            return
        if flaw is Flaw.UNKNOWN:
            self.counters.unknown += 1
        else:
            self.counters.bad_frames += 1
            self.counters.bad_crc += flaw is Flaw.CRC
        self._blamed_to = self._position + (begin + 1 if flaw is Flaw.HEADER else end)

    def _blame(self, begin: int, end: int) -> None:
        """Count a run of bytes without a magic byte, unless it goes on from what has been counted."""
        if self._position + begin > self._blamed_to:
            self.counters.bad_frames += 1
        self._blamed_to = max(self._blamed_to, self._position + end)
