"""Finds frames in received bytes without unpacking them.

A frame of the dialect is accepted by its CRC. An unknown message has no verifiable CRC; it is accepted if its
structure is consistent: it ends at the next magic byte or at the end of the data, contains no frame of the
dialect, and does not overlap rejected data. After an invalid frame the search continues one byte after its
magic byte.

The cost is linear in the number of bytes. Bytes without a magic byte are skipped by memchr, as are runs of
one magic byte, which cannot be a header. Every other rejected position counts as a wasted check. The caller
can limit frames and wasted checks (`find`); the search then continues at the next call.
"""

import re
from collections import OrderedDict
from dataclasses import dataclass

from companion.mavlink.address import Address
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

# A run of one magic byte contains no header: FD FD FD has unknown incompatibility flags, and six times FE is
# a DEBUG message of 254 bytes, which has 9. Only the last bytes of a run may begin one.
_RUN_V1, _RUN_V2 = 6 * _V1, 3 * _V2
_run_of = re.compile(rb"\xfd+|\xfe+").match

NO_LIMIT = 1 << 62
_LATE = 128  # a larger jump of the sequence number is a late or repeated frame
_MAX_SENDERS = 256  # with known sequence numbers


@dataclass(slots=True)
class Counters:
    """Statistics of one link.

    bad_frames: places where invalid bytes were skipped, bad_crc among them; unknown: frames of messages not
    in the dialect; lost: gaps in sequence numbers.
    """

    bytes_in: int = 0
    bytes_out: int = 0
    frames_in: int = 0
    frames_out: int = 0
    bad_frames: int = 0
    bad_crc: int = 0
    unknown: int = 0
    lost: int = 0


class FrameFinder:
    """Frames of one link, oldest first.

    datagram: chunks are independent. Otherwise they are parts of a stream, of which at most one incomplete
    frame is kept.
    """

    def __init__(self, datagram: bool, counters: Counters | None = None) -> None:
        self.datagram = datagram
        self.counters = Counters() if counters is None else counters
        self.wasted_checks = 0  # rejected positions since the link opened
        self.is_behind = False  # the last `find` stopped at its limit
        self._rest = b""
        self._position = 0  # of the first kept byte, since the link opened
        self._counted_to = -1  # bytes before this position have been counted as invalid
        self._last_sequence: OrderedDict[Address, int] = OrderedDict()

    def feed(self, data: bytes) -> list[Frame]:
        """The frames completed by these bytes. Never raises."""
        self.put(data)
        return self.find()

    def put(self, data: bytes) -> None:
        """Add received bytes. The rest of an earlier datagram is dropped."""
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
        """The frames in the added bytes, within the limits. Never raises.

        An unknown message is scanned to its end, which may exceed the limit.
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
                self._count_invalid(at, magic)
                at = magic
                continue
            if self.wasted_checks >= last_look or len(found) >= most_frames:
                self.is_behind = True
                break
            self.wasted_checks += 1  # corrected below for a frame
            run = _RUN_V2 if at == next_v2 else _RUN_V1
            if data.startswith(run, at) and (match := _run_of(data, at)) is not None:
                begin, at = at, match.end() - len(run) + 1
                self._count_invalid(begin, at)
                continue
            frame = read_frame(data, at)
            if frame is Flaw.UNKNOWN:
                frame = self._check(data, at)
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
        """A truncated frame does not affect the next datagram."""
        self._counted_to = min(self._counted_to, self._position)

    def _check(self, data: bytes, at: int) -> Frame | Flaw:
        """A frame of an unknown message with a consistent structure."""
        if self._position + at < self._counted_to:
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
                frame = inner  # may be the middle of a known frame
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
        """Count an invalid frame, unless its magic byte is within one already counted."""
        if self._position + begin < self._counted_to:
            return
        if flaw is Flaw.UNKNOWN:
            self.counters.unknown += 1
        else:
            self.counters.bad_frames += 1
            self.counters.bad_crc += flaw is Flaw.CRC
        self._counted_to = self._position + (begin + 1 if flaw is Flaw.HEADER else end)

    def _count_invalid(self, begin: int, end: int) -> None:
        """Count a run of bytes without a magic byte, unless it continues counted ones."""
        if self._position + begin > self._counted_to:
            self.counters.bad_frames += 1
        self._counted_to = max(self._counted_to, self._position + end)
