"""Clocks: TIMESYNC and PING answered, the offsets of other clocks estimated, the date taken from a station.

The offset follows from a question of ours: they stamp it with their clock, and half the way there and back is
what the answer took (as NTP does it). The answer with the shortest way is the best one.
"""

import math

from msgspec import Struct

from companion.mavlink.address import ALL, Address
from companion.mavlink.dialect import Message, dialect
from companion.services.outbox import Origin, Outbox

ASK_S = 10.0
LONGEST_WAY_S = 2.0  # there and back
_FORGET_WAY_S = 60.0  # after this a longer way is better than an old one: clocks drift
_MAX_PEERS = 16
_EARLIEST_UNIX_S, _LATEST_UNIX_S = 1_704_067_200.0, 4_102_444_800.0  # 2024, 2100
_SAME_S = 1.0  # a date that differs by less is the one we have, delayed on its way


class PeerClock(Struct, frozen=True):
    """Another clock: its time minus ours, the way there and back, and when that was measured."""

    offset_s: float
    way_s: float
    measured_s: float


class TimeService:
    """unix_offset_s: what to add to the boat's time for the date, as a station has it; None before one has
    said."""

    def __init__(self, outbox: Outbox) -> None:
        self.clocks: dict[Address, PeerClock] = {}
        self.unix_offset_s: float | None = None
        self._outbox = outbox
        self._asked_ns = 0
        self._due_s = ASK_S

    def on_timesync(self, message: Message, origin: Origin, now_s: float) -> None:
        """A question is answered at once; an answer to our own says how their clock stands."""
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
        """A PING to everybody is a question; one to somebody is an answer."""
        if message.target_system == ALL and message.target_component == ALL:
            self._outbox.send(
                origin.channel,
                dialect.MAVLink_ping_message(message.time_usec, message.seq, *origin.address),
            )

    def on_system_time(self, message: Message, now_s: float) -> None:
        """The date as a station has it. A computer without a clock of its own, and no receiver, needs one."""
        unix_s = message.time_unix_usec * 1e-6
        if not _EARLIEST_UNIX_S <= unix_s <= _LATEST_UNIX_S:
            return
        offset_s = unix_s - now_s
        if self.unix_offset_s is None or abs(offset_s - self.unix_offset_s) > _SAME_S:
            self.unix_offset_s = offset_s

    def to_own_clock(self, sender: Address, stamp_us: int, now_s: float, limit_s: float = 0.5) -> float:
        """A stamp of theirs as our time: now, unless their clock is known and the stamp is a little old."""
        known = self.clocks.get(sender)
        if known is None:
            return now_s
        own_s = stamp_us * 1e-6 - known.offset_s
        return own_s if now_s - limit_s <= own_s <= now_s else now_s

    def tick(self, now_s: float) -> None:
        """Ask everybody now and then."""
        if now_s < self._due_s:
            return
        self._due_s = now_s + ASK_S
        self._asked_ns = _to_ns(now_s)
        self._outbox.broadcast(dialect.MAVLink_timesync_message(0, self._asked_ns))


def _to_ns(seconds: float) -> int:
    """Never 0: a time of 0 is a question."""
    return max(math.floor(seconds * 1e9), 1)
