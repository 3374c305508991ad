"""Clocks: answers TIMESYNC and PING, estimates the offsets of other clocks, and takes the date from a
station.

The offset follows from a question of ours: the peer stamps it with its clock, and half the round trip is the
delay (as in NTP). The answer with the shortest round trip is the best.
"""

import math

from msgspec import Struct

from companion.mavlink.address import ALL, Address
from companion.mavlink.dialect import Message, dialect
from companion.services.outbox import Origin, Outbox

ASK_S = 10.0
LONGEST_WAY_S = 2.0  # round trip
_FORGET_WAY_S = 60.0  # after this a longer round trip replaces an older one: clocks drift
_MAX_PEERS = 16
_OLDEST_STAMP_S = 0.5
_EARLIEST_UNIX_S, _LATEST_UNIX_S = 1_704_067_200.0, 4_102_444_800.0  # 2024, 2100
_SAME_S = 1.0  # a smaller difference is transmission delay


class PeerClock(Struct, frozen=True):
    """Another clock: its time minus ours, the round trip, and the time of measurement."""

    offset_s: float
    way_s: float
    measured_s: float


class TimeService:
    """unix_offset_s: Unix time less the boat's time, from a station; None if unknown."""

    def __init__(self, outbox: Outbox) -> None:
        self.clocks: dict[Address, PeerClock] = {}
        self.unix_offset_s: float | None = None
        self._outbox = outbox
        self._asked_ns = 0
        self._due_s = ASK_S

    def on_timesync(self, message: Message, origin: Origin, now_s: float) -> None:
        """Answer a question; an answer to our own gives the offset."""
        if message.tc1 == 0:
            self._outbox.send(origin.channel, dialect.MAVLink_timesync_message(_to_ns(now_s), message.ts1))
        elif message.ts1 == self._asked_ns:
            self._learn(origin.address, message.tc1 * 1e-9, message.ts1 * 1e-9, now_s)

    def _learn(self, peer: Address, theirs_s: float, asked_s: float, now_s: float) -> None:
        way_s = now_s - asked_s
        if not 0.0 <= way_s <= LONGEST_WAY_S:
            return
        known = self.clocks.get(peer)
        if known is not None and way_s > known.way_s and now_s - known.measured_s < _FORGET_WAY_S:
            return
        if known is None and len(self.clocks) >= _MAX_PEERS:
            del self.clocks[min(self.clocks, key=lambda one: self.clocks[one].measured_s)]
        self.clocks[peer] = PeerClock(theirs_s - 0.5 * (asked_s + now_s), way_s, now_s)

    def on_ping(self, message: Message, origin: Origin) -> None:
        """A PING to all is a question; one to a target is an answer."""
        if message.target_system == ALL and message.target_component == ALL:
            self._outbox.send(
                origin.channel,
                dialect.MAVLink_ping_message(message.time_usec, message.seq, *origin.address),
            )

    def on_system_time(self, message: Message, now_s: float) -> None:
        """The date from a station, for a computer without a clock or receiver."""
        unix_s = message.time_unix_usec * 1e-6
        if not _EARLIEST_UNIX_S <= unix_s <= _LATEST_UNIX_S:
            return
        offset_s = unix_s - now_s
        if self.unix_offset_s is None or abs(offset_s - self.unix_offset_s) > _SAME_S:
            self.unix_offset_s = offset_s

    def to_own_clock(self, sender: Address, stamp_us: int, now_s: float) -> float:
        """A stamp of a sender in our time; now, unless its clock is known and the stamp is recent."""
        known = self.clocks.get(sender)
        if known is None:
            return now_s
        own_s = stamp_us * 1e-6 - known.offset_s
        return own_s if now_s - _OLDEST_STAMP_S <= own_s <= now_s else now_s

    def tick(self, now_s: float) -> None:
        if now_s < self._due_s:
            return
        self._due_s = now_s + ASK_S
        self._asked_ns = _to_ns(now_s)
        self._outbox.broadcast(dialect.MAVLink_timesync_message(0, self._asked_ns))


def _to_ns(seconds: float) -> int:
    """Never 0: a time of 0 marks a question."""
    return max(math.floor(seconds * 1e9), 1)
