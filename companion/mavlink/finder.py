"""Finds the frames in what a link hands over, without unpacking them.

A frame of the dialect is believed by its CRC. A message that the dialect does not have carries no CRC that
could be checked; it is believed where the structure holds: its end is the next frame's magic byte or the end
of what has come, no frame of the dialect begins inside it, and it does not lie in what was refused before.
After a flaw the search goes on from the byte behind the bad magic byte.

The cost is linear in the bytes, whatever they are. Bytes without a magic byte are skipped by memchr, and so
are runs of one magic byte, which are no header. Each other place that is examined and turns out to be no
frame counts as a wasted look. A caller that must not be held up limits frames and wasted looks (`find`); the
search goes on where it stopped.
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
_V1, _V2 = bytes((MAGIC_V1,)), bytes((MAGIC_V2,))
_next_magic = re.compile(rb"[\xfd\xfe]").search

# Inside a run of one magic byte there is no header: FD FD FD has incompatibility flags that do not exist, and
# six times FE is a DEBUG message of 254 bytes, which has 9. Only the last bytes of a run may begin one.
_RUN_V1, _RUN_V2 = 6 * _V1, 3 * _V2
_run_of = re.compile(rb"\xfd+|\xfe+").match

NO_LIMIT = 1 << 62
_LATE = 128  # a sequence number that jumps this far ahead is one that comes late, or twice
_MAX_SENDERS = 256  # of whose sequence numbers are kept: a flood of addresses must not fill the memory


class FrameFinder:
    """Frames of one link, oldest first.

    datagram: each chunk stands for itself, and nothing is kept of it once it was searched. Otherwise the
    chunks are pieces of one stream, of which at most one unfinished frame is kept.
    """

    __slots__ = (
        "_blamed_to",
        "_last_sequence",
        "_position",
        "_rest",
        "counters",
        "datagram",
        "is_behind",
        "wasted_checks",
    )

    def __init__(self, datagram: bool, counters: Counters | None = None) -> None:
        self.datagram = datagram
        self.counters = Counters() if counters is None else counters
        self.wasted_checks = 0  # places that were examined since the link began, and were no frame
        self.is_behind = False  # the last `find` stopped at its limit
        self._rest = b""
        self._position = 0  # of the rest's first byte since the link began
        self._blamed_to = -1  # bytes before this position have been counted as one flaw or another
        self._last_sequence: OrderedDict[Address, int] = OrderedDict()

    def feed(self, data: bytes) -> list[Frame]:
        """The frames that these bytes complete. Never raises."""
        self.put(data)
        return self.find()

    def put(self, data: bytes) -> None:
        """Bytes have arrived. What is left of an earlier datagram is given up."""
        self.counters.bytes_in += len(data)
        if not self._rest:
            self._rest = data
        elif self.datagram:
            self._position += len(self._rest)
            self._end_datagram()
            self._rest = data
        else:
            self._rest += data

    def find(self, most_frames: int = NO_LIMIT, most_wasted_looks: int = NO_LIMIT) -> list[Frame]:
        """The frames in what was put in, as far as the limits go. Never raises.

        An unknown message is searched to its end, which may exceed the limit by as many looks as it claims
        bytes.
        """
        found: list[Frame] = []
        data = self._rest
        at, end, last_look = 0, len(data), self.wasted_checks + most_wasted_looks
        next_v1 = next_v2 = -1
        self.is_behind = False
        while at < end:
            if next_v1 < at and (next_v1 := data.find(_V1, at)) < 0:
                next_v1 = end
            if next_v2 < at and (next_v2 := data.find(_V2, at)) < 0:
                next_v2 = end
            magic = min(next_v1, next_v2)
            if magic > at:
                self._blame(at, magic)
                at = magic
                continue
            if self.wasted_checks >= last_look or len(found) >= most_frames:
                self.is_behind = True
                break
            self.wasted_checks += 1  # taken back if it was not
            run = _RUN_V2 if at == next_v2 else _RUN_V1
            if data.startswith(run, at) and (match := _run_of(data, at)) is not None:
                begin, at = at, match.end() - len(run) + 1
                self._blame(begin, at)
                continue
            frame = read_frame(data, at)
            if frame is Flaw.UNKNOWN:
                frame = self._believe(data, at)
            if isinstance(frame, Frame):
                self._count(frame)
                self.wasted_checks -= 1
                found.append(frame)
                at += len(frame.data)
            elif frame is Flaw.INCOMPLETE and not self.datagram:
                break
            else:
                self._refuse(frame, at, at + claimed_length(data, at))
                at += 1
        self._rest = data[at:]
        self._position += at
        if self.datagram and not self._rest:
            self._end_datagram()
        return found

    def _end_datagram(self) -> None:
        """What a cut frame claimed beyond its datagram says nothing of the next one."""
        self._blamed_to = min(self._blamed_to, self._position)

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
            self.wasted_checks += 1
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
