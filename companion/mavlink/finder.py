"""Finds the frames in what a link hands over, without unpacking them.

A frame of the dialect is believed by its CRC. A message that the dialect does not have carries no CRC that
could be checked; it is believed where the structure holds: its end is the next frame's magic byte or the end
of what has come, no frame of the dialect begins inside it, and it does not lie in what was refused before.
After a flaw the search goes on from the byte behind the bad magic byte.
"""

import re
from collections import OrderedDict

from companion.mavlink.address import Address
from companion.mavlink.counters import Counters
from companion.mavlink.framing import (
    MAGIC_V1,
    MAGIC_V2,
    Flaw,
    Frame,
    claimed_length,
    read_frame,
    read_unknown,
)

_MAGIC = (MAGIC_V2, MAGIC_V1)
_next_magic = re.compile(rb"[\xfd\xfe]").search
_LATE = 128  # a sequence number that jumps this far ahead is one that comes late, or twice
_MAX_SENDERS = 256  # of whose sequence numbers are kept: a flood of addresses must not fill the memory


class FrameFinder:
    """Frames of one link, oldest first.

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
        self._last_sequence: OrderedDict[Address, int] = OrderedDict()

    def feed(self, data: bytes) -> list[Frame]:
        """The frames that these bytes complete. Never raises."""
        self.counters.bytes_in += len(data)
        if self._rest:
            data = self._rest + data
        found: list[Frame] = []
        at, end = 0, len(data)
        while at < end:
            if data[at] not in _MAGIC:
                magic = _next_magic(data, at)
                begin, at = at, magic.start() if magic else end
                self._blame(begin, at)
                continue
            frame = read_frame(data, at)
            if frame is Flaw.UNKNOWN:
                frame = self._believe(data, at)
            if isinstance(frame, Frame):
                self._count(frame)
                found.append(frame)
                at += len(frame.data)
            elif frame is Flaw.INCOMPLETE and not self.datagram:
                break
            else:
                self._refuse(frame, at, at + claimed_length(data, at))
                at += 1
        self._rest = b"" if self.datagram else data[at:]
        self._position += at
        return found

    def _believe(self, data: bytes, at: int) -> Frame | Flaw:
        """A frame of an unknown message where the structure holds."""
        if self._position + at < self._blamed_to:
            return Flaw.UNKNOWN
        frame = read_unknown(data, at)
        end = min(at + claimed_length(data, at), len(data))
        if isinstance(frame, Frame) and end < len(data) and data[end] not in _MAGIC:
            return Flaw.UNKNOWN
        magic = _next_magic(data, at + 1, end)
        while magic is not None:
            inner = read_frame(data, magic.start())
            if isinstance(inner, Frame):
                return Flaw.UNKNOWN
            if inner is Flaw.INCOMPLETE:
                frame = inner  # what looked like an end may be the middle of a frame that we do know
            magic = _next_magic(data, magic.start() + 1, end)
        return frame

    def _count(self, frame: Frame) -> None:
        counters, senders = self.counters, self._last_sequence
        if frame.layout is None:
            counters.unknown += 1
        else:
            counters.frames_in += 1
        last = senders.get(frame.sender)
        if last is None:
            if len(senders) >= _MAX_SENDERS:
                senders.popitem(last=False)
            senders[frame.sender] = frame.sequence
            return
        missing = (frame.sequence - last - 1) & 0xFF
        if missing < _LATE:
            counters.lost += missing
            senders[frame.sender] = frame.sequence

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
