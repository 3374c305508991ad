"""MAVLink 2 signing (MAVLink guide, "Message signing"), sans-I/O and without the dialect.

    FD len 01 … payload crc16 │ link id, timestamp (48 bits), signature (48 bits)

The signature is the head of SHA-256 over key, frame, link id and timestamp. Timestamps count 10 µs since
2015-01-01 UTC. They prove that a frame is new, not that it is young: each stream (system, component, link id)
must count upwards for ever, over restarts and when a clock jumps back; a stream not heard before may be a
minute behind what we hold for now. A key says who may speak; all that is remembered of a stream is remembered
only of frames whose signature fits, so that nobody without the key can spoil or fill the table.

Signing sets a flag in the header, which the CRC covers. The CRC is linear, so its new value follows from the
old one without knowing the message: frames of messages that no dialect here knows can be signed too.
"""

import hmac
from dataclasses import dataclass
from enum import Enum
from typing import Literal

from companion.mavlink.signing_key import SIGNATURE_BYTES, SigningKey

EPOCH_UNIX_S = 1_420_070_400.0  # 2015-01-01 00:00 UTC
TICKS_PER_S = 100_000
NEVER = (1 << 48) - 1  # the last timestamp there is, in 2104
STREAM_LAG = 60 * TICKS_PER_S  # a new stream may be this far behind
MAX_STREAMS = 256

SigningPolicy = Literal["off", "accept", "required"]
"""What a link asks of its frames: nothing; signed ones must be right; all must be signed."""

_MAGIC_V2, _SIGNED = 0xFD, 0x01
_BLOCK_BYTES = 13
_FARTHEST = NEVER - 365 * 86_400 * TICKS_PER_S  # nobody's word takes our count nearer to its end than a year
_RADIO_STATUS = (109).to_bytes(3, "little")
_SETUP_SIGNING = (256).to_bytes(3, "little")  # beyond what version 1 can number


def timestamp_at(unix_s: float) -> int:
    """The timestamp of a date, 0 for one that is not known or before 2015."""
    return min(max(int((unix_s - EPOCH_UNIX_S) * TICKS_PER_S), 0), _FARTHEST)


def _flag_crcs() -> tuple[int, ...]:
    """What the signed flag does to the CRC, by length of the payload: CRC-16/MCRF4XX of the flag alone."""
    crc, table = 0, []
    for position, byte in enumerate([_SIGNED, *[0] * (255 + 8)]):  # to the end of the payload and crc_extra
        low = (byte ^ crc) & 0xFF
        low ^= (low << 4) & 0xFF
        crc = (crc >> 8) ^ (low << 8) ^ (low << 3) ^ (low >> 4)
        if position >= 8:
            table.append(crc)
    return tuple(table)


_FLAG_CRCS = _flag_crcs()


def is_signed(frame: bytes) -> bool:
    """Whether a frame, whole and unflawed, carries a signature block."""
    return frame[0] == _MAGIC_V2 and bool(frame[2] & _SIGNED)


def sign(frame: bytes, key: SigningKey, link_id: int, timestamp: int) -> bytes:
    """An unsigned MAVLink 2 frame with its signature block."""
    block = link_id.to_bytes(1, "little") + timestamp.to_bytes(6, "little")
    signed = _with_flag(frame, _SIGNED) + block
    return signed + key.signature(signed)


def without_signature(frame: bytes) -> bytes:
    """The frame as it was before it was signed."""
    return _with_flag(frame[:-_BLOCK_BYTES], 0) if is_signed(frame) else frame


def loggable(frame: bytes) -> bytes:
    """What a log may hold of a frame: no signature, and nothing at all of one that carries a key."""
    carries_key = frame[0] == _MAGIC_V2 and frame[7:10] == _SETUP_SIGNING
    return b"" if carries_key else without_signature(frame)


def _with_flag(frame: bytes, flag: int) -> bytes:
    crc = (frame[-2] | frame[-1] << 8) ^ _FLAG_CRCS[frame[1]]
    return frame[:2] + bytes((flag,)) + frame[3:-2] + crc.to_bytes(2, "little")


class Stamps:
    """Our own timestamps: each is greater than every one before it.

    `limit` is the first that may not be used: who keeps the stamps over a restart raises it once the medium
    has it, and begins there the next time. `seen` is the highest that anybody has proved to us.
    """

    __slots__ = ("_last", "clock", "limit", "seen")

    def __init__(self, first: int = 1, seen: int = 0, limit: int = NEVER) -> None:
        self._last = first - 1
        self.clock = 0  # the date, as far as it is known; may jump back
        self.seen = seen
        self.limit = limit

    @property
    def now(self) -> int:
        """What time it is, by our own date or by what stations have proved, whichever is later."""
        return max(self.clock, self.seen)

    @property
    def last(self) -> int:
        """The last one used."""
        return self._last

    def take(self) -> int | None:
        """The next one; None where the limit is reached, or the date is beyond it and none was used yet: a
        station that knows the date would not believe such an old one.
        """
        following = self._last + 1
        stamp = max(following, self.clock, self.seen)
        if stamp >= self.limit:
            if following >= self.limit or not self._last:
                return None
            stamp = following  # the clock has run ahead of the limit; it can wait
        self._last = stamp
        return stamp

    def follow(self, timestamp: int) -> None:
        """Somebody with the key counts further than we do."""
        if self.seen < timestamp <= _FARTHEST:
            self.seen = timestamp


class SignatureVerdict(Enum):
    """What a signature proves."""

    GOOD = "signed with our key, and newer than all before it"
    UNSIGNED = "not signed"
    FORGED = "signed, but not with our key"
    OLD = "signed with our key, but heard before or out of date"


class Signatory:
    """One key, and all that has been heard under it, on whatever link."""

    __slots__ = ("_floor", "_key", "_streams", "proved", "stamps")

    def __init__(self, key: SigningKey | None, stamps: Stamps, floor: int | None = None) -> None:
        """floor: the highest timestamp that was proved under the key before; as `stamps` has it unless
        given.
        """
        self._key = key
        self._floor = stamps.seen if floor is None else floor  # what was proved once is not proved again
        self.proved = self._floor  # the highest timestamp that was proved under the key
        self._streams: dict[bytes, int] = {}
        self.stamps = stamps

    @property
    def key(self) -> SigningKey | None:
        """The key of now."""
        return self._key

    def change_key(self, key: SigningKey | None, floor: int = 0) -> None:
        """Another key, or none. What was heard under the old one proves nothing any more, nor does what was
        signed with the new one up to `floor`.
        """
        if key != self._key:
            self._key = key
            self._streams.clear()
            self._floor = self.proved = floor

    def sign(self, frame: bytes, link_id: int) -> bytes | None:
        """The frame, signed; as it is without a key; None while there is no timestamp to be had."""
        if self._key is None:
            return frame
        stamp = self.stamps.take()
        return None if stamp is None else sign(frame, self._key, link_id, stamp)

    def check(self, frame: bytes) -> SignatureVerdict:
        """What a whole frame's signature proves."""
        if not is_signed(frame):
            return SignatureVerdict.UNSIGNED
        if self._key is None:
            return SignatureVerdict.FORGED
        if not hmac.compare_digest(self._key.signature(frame[:-SIGNATURE_BYTES]), frame[-SIGNATURE_BYTES:]):
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
            # Streams out of date may be forgotten, as long as nothing of them is ever taken for new
            self._floor = max(self._floor, oldest - 1)
            self._streams = {stream: last for stream, last in self._streams.items() if last >= oldest}
        return len(self._streams) < MAX_STREAMS


@dataclass(slots=True)
class SigningCounters:
    """What one link's guard has seen. The last four were refused or not sent."""

    verified: int = 0
    unsigned: int = 0
    forged: int = 0
    old: int = 0
    unsendable: int = 0  # frames for which there was no timestamp

    @property
    def refused(self) -> int:
        """All that was turned away."""
        return self.unsigned + self.forged + self.old


class Guard:
    """Signing on one link: which frames come in, and what goes out. Without a key, `accept` is `off`.

    link_id tells our links apart for whoever hears several of them. A radio's own RADIO_STATUS cannot be
    signed by anybody; on a link that is a radio it may come in unsigned.
    """

    __slots__ = ("_signatory", "counters", "is_radio", "link_id", "policy")

    def __init__(
        self, signatory: Signatory, policy: SigningPolicy, link_id: int, *, is_radio: bool = False
    ) -> None:
        self._signatory = signatory
        self.policy: SigningPolicy = policy
        self.link_id = link_id & 0xFF
        self.is_radio = is_radio
        self.counters = SigningCounters()

    @property
    def has_key(self) -> bool:
        """Whether there is a key to sign with."""
        return self._signatory.key is not None

    @property
    def has_verified(self) -> bool:
        """Whether somebody on the link has shown that they hold the key."""
        return self.counters.verified > 0

    def admits(self, frame: bytes) -> bool:
        """Whether a whole, unflawed frame of either version may come in."""
        if self.policy == "off" or (self.policy == "accept" and not self.has_key):
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
        """A frame as it is to leave by this link; None if it must not.

        A frame that its sender has signed, or that cannot be signed (MAVLink 1), leaves as it is.
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
