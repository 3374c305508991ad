"""The serial protocols of RC receivers: CRSF, iBUS, S.BUS. Pure; never raises."""

import math
from abc import abstractmethod
from typing import Final

from fastcrc.crc8 import dvb_s2

from companion.core.readings import RcReading
from companion.sensors.framing import FrameReader

PACKED_BYTES: Final = 22
_SHIFTS: Final = tuple(range(0, 8 * PACKED_BYTES, 11))
_MASK: Final = (1 << 11) - 1
_PULSES_US: Final = tuple(1500 + round(0.625 * (value - 992)) for value in range(_MASK + 1))


class RcParser(FrameReader):
    """A receiver's protocol. baud: of its line."""

    baud: int

    def feed(self, data: bytes, time_s: float) -> RcReading | None:
        """Parse more bytes. The latest reading in them, None without a complete frame."""
        latest: RcReading | None = None
        for frame in self.split(data):
            latest = self._reading(frame, time_s) or latest
        return latest

    @abstractmethod
    def _reading(self, frame: bytes, time_s: float) -> RcReading | None:
        """The reading of a good frame; None without channels."""


def unpack_channels(packed: bytes) -> tuple[int, ...]:
    """Sixteen channels of 11 bits, lowest bit first, as in CRSF and S.BUS: 172 is 988 µs, 992 is 1500 µs.

    packed: PACKED_BYTES bytes.
    """
    bits = int.from_bytes(packed, "little")
    return tuple([_PULSES_US[bits >> shift & _MASK] for shift in _SHIFTS])


_SYNC: Final = 0xC8
_SHORTEST, _LONGEST = 2, 62  # valid length bytes: type and CRC alone; a frame of 64 bytes
_CHANNELS_KIND: Final = 0x16
_STATISTICS_KIND: Final = 0x14
_STATISTICS_BYTES: Final = 10


class CrsfParser(RcParser):
    """CRSF, the protocol of TBS Crossfire and ExpressLRS receivers: 8N1, not inverted.

    Channels, with the link quality of the latest statistics; a quality of 0 is the failsafe.

    A frame: 0xC8, the number of bytes that follow, a type, the payload, and a CRC-8 over type and payload
    (polynomial 0xD5, as in DVB-S2). Source: the description by its working group (github.com/crsf-wg/crsf,
    wiki).
    """

    baud = 420_000

    def __init__(self) -> None:
        super().__init__()
        self._channels_us: tuple[int, ...] = ()
        self._quality: float | None = None
        self._rssi_dbm: float | None = None

    def _size(self, held: bytes, at: int) -> int:
        if held[at] != _SYNC:
            return 0
        if at + 1 >= len(held):
            return 2
        length = held[at + 1]
        return length + 2 if _SHORTEST <= length <= _LONGEST else 0

    def _is_whole(self, frame: bytes) -> bool:
        return dvb_s2(frame[2:]) == 0  # a CRC over data and CRC is 0

    def _reading(self, frame: bytes, time_s: float) -> RcReading | None:
        kind, payload = frame[2], frame[3:-1]
        if kind == _CHANNELS_KIND and len(payload) == PACKED_BYTES:
            self._channels_us = unpack_channels(payload)
        elif kind == _STATISTICS_KIND and len(payload) >= _STATISTICS_BYTES:
            if not self._ingest_statistics(payload):
                return None
        else:
            return None
        lost = self._quality == 0.0
        return RcReading(time_s, self._channels_us, lost, self._quality, self._rssi_dbm)

    def _ingest_statistics(self, payload: bytes) -> bool:
        """Read the up-link's statistics: signal of both antennas in −dBm, quality in percent, active antenna.

        Whether the transmitter is lost.
        """
        self._quality = min(payload[2], 100) / 100.0
        signal = payload[1] if payload[4] == 1 else payload[0]
        self._rssi_dbm = -float(signal) if signal else None
        return payload[2] == 0


_IBUS_SIZE: Final = 0x20
_IBUS_COMMAND: Final = 0x40
_IBUS_CHANNELS: Final = 14


class IbusParser(RcParser):
    """FlySky iBUS, servo output: 8N1, 32 bytes every 7 ms. Channels only: quality and signal are unknown.

    0x20, 0x40, fourteen channels of two bytes in µs, little-endian, and 0xFFFF minus the sum of all bytes so
    far. Newer receivers put channels 15 to 18 into the upper four bits of the first twelve, three words a
    channel. Source: blog.dsp.id.au/posts/2017/10/22/flysky-ibus-protocol. There is no flag for a lost
    transmitter: the receiver stops sending, or sends the pulses configured for that case, which FS_THR_VALUE
    detects.
    """

    baud = 115_200

    def _size(self, held: bytes, at: int) -> int:
        if held[at] != _IBUS_SIZE or (at + 1 < len(held) and held[at + 1] != _IBUS_COMMAND):
            return 0
        return _IBUS_SIZE

    def _is_whole(self, frame: bytes) -> bool:
        return 0xFFFF - sum(frame[:-2]) == frame[-2] | frame[-1] << 8

    def _reading(self, frame: bytes, time_s: float) -> RcReading:
        words = [frame[place] | frame[place + 1] << 8 for place in range(2, 2 + 2 * _IBUS_CHANNELS, 2)]
        channels_us = [word & 0x0FFF for word in words]
        nibbles = [word >> 12 for word in words[:12]]
        if any(nibbles):
            for first in range(0, 12, 3):
                low, middle, high = nibbles[first : first + 3]
                channels_us.append(low | middle << 4 | high << 8)
        return RcReading(time_s, tuple(channels_us))


PAUSE_S: Final = 0.002  # bytes of a frame are 0.12 ms apart, frames at least 4 ms
_SBUS_SIZE: Final = 25
_BEGIN: Final = 0x0F
_FLAGS: Final = 1 + PACKED_BYTES
_CHANNEL_17, _CHANNEL_18, _LOST, _FAILSAFE = 1, 2, 4, 8
_SWITCH_US: Final = (1000, 2000)  # channels 17 and 18 are on or off
_SHARE: Final = 1.0 / 50.0  # weight of a frame in the running mean of frames received


class SbusParser(RcParser):
    """Futaba S.BUS: 8E2, inverted (the line needs an inverter), 25 bytes every 7 to 14 ms.

    Channels, the failsafe flag, and the share of frames received as the quality. 0x0F, sixteen channels of 11
    bits, a byte of flags (1 and 2: two more channels, 4: frame lost on the air, 8: failsafe active), and an
    end byte: 0, or in S.BUS2 one whose lower half is 4. A frame lost on the air repeats the channels of the
    one before, and is no reading. There is no checksum, and a 0x0F within a frame looks like a start byte, so
    the first frame is expected after a pause on the line only, and the others right behind it. Sources:
    measurements by users (os.mbed.com/users/Digixx/notebook/futaba-s-bus-controlled-by-mbed,
    digitalwire.ch/de/projekte/futaba-sbus).
    """

    baud = 100_000

    def __init__(self) -> None:
        super().__init__()
        self._quality = 1.0
        self._is_in_step = False
        self._heard_s = -math.inf

    def feed(self, data: bytes, time_s: float) -> RcReading | None:
        pause_s, self._heard_s = time_s - self._heard_s, time_s
        if not self._is_in_step:
            if pause_s >= PAUSE_S:
                self._held = b""
            elif not self._held:
                self.skipped += len(data)
                return None
        return super().feed(data, time_s)

    def forget(self) -> None:
        super().forget()
        self._is_in_step = False

    def _size(self, held: bytes, at: int) -> int:
        is_possible = held[at] == _BEGIN and (at == 0 or self._is_in_step)
        self._is_in_step = self._is_in_step and is_possible
        return _SBUS_SIZE if is_possible else 0

    def _is_whole(self, frame: bytes) -> bool:
        end = frame[-1]
        self._is_in_step = (end == 0 or end & 0x0F == 0x04) and frame[_FLAGS] < 0x10
        return self._is_in_step

    def _reading(self, frame: bytes, time_s: float) -> RcReading | None:
        flags = frame[_FLAGS]
        is_lost = bool(flags & _LOST)
        self._quality += _SHARE * ((not is_lost) - self._quality)
        if is_lost and not flags & _FAILSAFE:
            return None
        channels_us = unpack_channels(frame[1:_FLAGS])
        switches = (_SWITCH_US[flags & _CHANNEL_17], _SWITCH_US[(flags & _CHANNEL_18) >> 1])
        return RcReading(time_s, channels_us + switches, bool(flags & _FAILSAFE), self._quality)
