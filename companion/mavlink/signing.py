"""MAVLink 2 signing (MAVLink guide, "Message signing"), sans-I/O and without the dialect.

    FD len 01 … payload crc16 │ link id, timestamp (48 bits), signature (48 bits)

The signature is the head of SHA-256 over key, frame, link id and timestamp. Timestamps count 10 µs since
2015-01-01 UTC. They prevent replay, not delay: each stream (system, component, link id) must always count
upwards, over restarts and clock steps; a new stream may be up to a minute behind our time. Streams are only
remembered from frames with a valid signature, so the table cannot be filled without the key.

Signing sets a flag in the header, which the CRC covers. The CRC is linear, so its new value follows from the
old one without the message definition: unknown messages can be signed, too.
"""

import hmac
from dataclasses import dataclass
from enum import Enum
from typing import Literal

from fastcrc.crc16 import mcrf4xx

from companion.mavlink.signing_key import SIGNATURE_BYTES, SigningKey

EPOCH_UNIX_S = 1_420_070_400.0  # 2015-01-01 00:00 UTC
TICKS_PER_S = 100_000
NEVER = (1 << 48) - 1  # the last timestamp, in 2104
STREAM_LAG = 60 * TICKS_PER_S  # a new stream may be this far behind
MAX_STREAMS = 256

SigningPolicy = Literal["off", "accept", "required"]
"""Requirement on frames: none; signed ones must be valid; all must be signed."""

_MAGIC_V2, _SIGNED = 0xFD, 0x01
_BLOCK_BYTES = 13
_FARTHEST = NEVER - 365 * 86_400 * TICKS_PER_S  # received timestamps are accepted up to a year before the end
_RADIO_STATUS = (109).to_bytes(3, "little")
_SETUP_SIGNING = (256).to_bytes(3, "little")  # not in version 1


def timestamp_at(unix_s: float) -> int:
    """The timestamp of a Unix time, 0 if unknown or before 2015."""
    return min(max(int((unix_s - EPOCH_UNIX_S) * TICKS_PER_S), 0), _FARTHEST)


# Effect of the signed flag on the CRC, by payload length: that of the flag alone, to the end of crc_extra
_FLAG_CRCS = tuple(mcrf4xx(bytes((_SIGNED,)) + bytes(length + 8), 0) for length in range(256))


def is_signed(frame: bytes) -> bool:
    """Whether a valid frame has a signature block."""
    return frame[0] == _MAGIC_V2 and bool(frame[2] & _SIGNED)


def sign(frame: bytes, key: SigningKey, link_id: int, timestamp: int) -> bytes:
    """An unsigned MAVLink 2 frame with its signature block."""
    block = link_id.to_bytes(1, "little") + timestamp.to_bytes(6, "little")
    signed = _with_flag(frame, _SIGNED) + block
    return signed + key.signature(signed)


def without_signature(frame: bytes) -> bytes:
    return _with_flag(frame[:-_BLOCK_BYTES], 0) if is_signed(frame) else frame


def loggable(frame: bytes) -> bytes:
    """A frame as it may be logged: without signature; empty if it contains a key."""
    carries_key = frame[0] == _MAGIC_V2 and frame[7:10] == _SETUP_SIGNING
    return b"" if carries_key else without_signature(frame)


def _with_flag(frame: bytes, flag: int) -> bytes:
    crc = (frame[-2] | frame[-1] << 8) ^ _FLAG_CRCS[frame[1]]
    return frame[:2] + bytes((flag,)) + frame[3:-2] + crc.to_bytes(2, "little")


class Stamps:
    """Our own timestamps, strictly increasing.

    `limit`: the first that must not be used; raised by the owner once it is stored, and the start after a
    restart. `seen`: the highest proven by others.
    """

    def __init__(self, first: int = 1, seen: int = 0, limit: int = NEVER) -> None:
        self.last = first - 1  # used
        self.clock = 0  # Unix time as timestamp, if known; may jump back
        self.seen = seen
        self.limit = limit

    @property
    def now(self) -> int:
        """The present time, by our clock or by proven timestamps, whichever is later."""
        return max(self.clock, self.seen)

    def take(self) -> int | None:
        """The next one; None at the limit, or if the clock is beyond the limit before the first: stations
        would reject such an old one.
        """
        following = self.last + 1
        stamp = max(following, self.clock, self.seen)
        if stamp >= self.limit:
            if following >= self.limit or not self.last:
                return None
            stamp = following  # the clock is ahead of the limit
        self.last = stamp
        return stamp

    def follow(self, timestamp: int) -> None:
        """A proven timestamp of a station."""
        if self.seen < timestamp <= _FARTHEST:
            self.seen = timestamp


class SignatureVerdict(Enum):
    """What a signature proves."""

    GOOD = "signed with our key, and newer than all before it"
    UNSIGNED = "not signed"
    FORGED = "signed, but not with our key"
    OLD = "signed with our key, but heard before or out of date"


class Signatory:
    """One key, and the streams signed with it, on all links."""

    def __init__(self, key: SigningKey | None, stamps: Stamps, floor: int | None = None) -> None:
        """floor: the highest timestamp proven under the key before; default: that of `stamps`."""
        self.key = key  # the present one
        self._floor = stamps.seen if floor is None else floor  # what was proved once is not proved again
        self.proved = self._floor  # the highest timestamp proven under the key
        self._streams: dict[bytes, int] = {}
        self.stamps = stamps

    def change_key(self, key: SigningKey | None, floor: int = 0) -> None:
        """Replace or remove the key and its streams; frames of the new one are valid above `floor`."""
        if key != self.key:
            self.key = key
            self._streams.clear()
            self._floor = self.proved = floor

    def sign(self, frame: bytes, link_id: int) -> bytes | None:
        """The signed frame; unchanged without a key; None without a timestamp."""
        if self.key is None:
            return frame
        stamp = self.stamps.take()
        return None if stamp is None else sign(frame, self.key, link_id, stamp)

    def check(self, frame: bytes) -> SignatureVerdict:
        """What a frame's signature proves."""
        if not is_signed(frame):
            return SignatureVerdict.UNSIGNED
        if self.key is None:
            return SignatureVerdict.FORGED
        if not hmac.compare_digest(self.key.signature(frame[:-SIGNATURE_BYTES]), frame[-SIGNATURE_BYTES:]):
            return SignatureVerdict.FORGED
        stream = frame[5:7] + frame[-_BLOCK_BYTES : 1 - _BLOCK_BYTES]
        timestamp = int.from_bytes(frame[1 - _BLOCK_BYTES : -SIGNATURE_BYTES], "little")
        before = self._streams.get(stream)
        if before is None:
            if not self._is_new_stream(timestamp):
                return SignatureVerdict.OLD
        elif timestamp <= before:
            return SignatureVerdict.OLD
        self._streams[stream] = timestamp
        self.proved = max(self.proved, timestamp)
        self.stamps.follow(timestamp)
        return SignatureVerdict.GOOD

    def _is_new_stream(self, timestamp: int) -> bool:
        oldest = self.stamps.now - STREAM_LAG
        if timestamp < oldest or timestamp <= self._floor:
            return False
        if len(self._streams) >= MAX_STREAMS:
            # Outdated streams may be dropped if the floor then excludes them
            self._floor = max(self._floor, oldest - 1)
            self._streams = {stream: last for stream, last in self._streams.items() if last >= oldest}
        return len(self._streams) < MAX_STREAMS


@dataclass(slots=True)
class SigningCounters:
    """Statistics of a guard. The last four were refused or not sent."""

    verified: int = 0
    unsigned: int = 0
    forged: int = 0
    old: int = 0
    unsendable: int = 0  # frames without a timestamp

    @property
    def refused(self) -> int:
        return self.unsigned + self.forged + self.old


class SigningGuard:
    """Signing on one link: checks incoming frames, signs outgoing ones. Without a key, `accept` is `off`.

    link_id distinguishes our links for stations that receive several. A radio's own RADIO_STATUS is never
    signed; a radio link accepts it.
    """

    def __init__(
        self, signatory: Signatory, policy: SigningPolicy, link_id: int, *, is_radio: bool = False
    ) -> None:
        self._signatory = signatory
        self.policy: SigningPolicy = policy
        self.link_id = link_id & 0xFF
        self.is_radio = is_radio
        self.counters = SigningCounters()

    @property
    def key(self) -> SigningKey | None:
        return self._signatory.key

    def verifies_with(self, key: SigningKey | None) -> bool:
        """Whether a signed frame that is accepted has been verified with this key."""
        return self.policy != "off" and key is not None and self._signatory.key == key

    @property
    def has_verified(self) -> bool:
        """Whether a valid signature was received on the link."""
        return self.counters.verified > 0

    def admits(self, frame: bytes) -> bool:
        """Whether a valid frame of either version is accepted."""
        if self.policy == "off" or (self.policy == "accept" and self.key is None):
            return True
        verdict = self._signatory.check(frame)
        counters = self.counters
        if verdict is SignatureVerdict.GOOD:
            counters.verified += 1
            return True
        if verdict is SignatureVerdict.UNSIGNED:
            if self.policy == "accept" or (self.is_radio and _is_radio_status(frame)):
                return True
            counters.unsigned += 1
        elif verdict is SignatureVerdict.FORGED:
            counters.forged += 1
        else:
            counters.old += 1
        return False

    def seal(self, frame: bytes) -> bytes | None:
        """The frame to send; None if it must not be sent.

        Frames that are signed already or cannot be signed (MAVLink 1) are unchanged.
        """
        if self.policy == "off" or frame[0] != _MAGIC_V2 or frame[2] & _SIGNED:
            return frame
        sealed = self._signatory.sign(frame, self.link_id)
        if sealed is None:
            self.counters.unsendable += 1
        return sealed


def _is_radio_status(frame: bytes) -> bool:
    if frame[0] == _MAGIC_V2:
        return frame[7:10] == _RADIO_STATUS
    return frame[5] == _RADIO_STATUS[0]
