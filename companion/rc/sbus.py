"""Futaba S.BUS: 100,000 baud, 8E2, inverted (the line needs an inverter), 25 bytes every 7 to 14 ms.

0x0F, sixteen channels of 11 bits, a byte of flags (1 and 2: two more channels, 4: frame lost on the air,
8: failsafe active), and an end byte: 0, or in S.BUS2 one whose lower half is 4. Sources: measurements by
users (os.mbed.com/users/Digixx/notebook/futaba-s-bus-controlled-by-mbed,
digitalwire.ch/de/projekte/futaba-sbus). There is no checksum, and a 0x0F within a frame looks like a start
byte, so the first frame is expected after a pause on the line only, and the others right behind it.
"""

import math
from typing import Final

from companion.core.readings import RcReading
from companion.rc.parser import PACKED_BYTES, RcParser, unpack_channels

BAUD: Final = 100_000
PAUSE_S: Final = 0.002  # bytes of a frame are 0.12 ms apart, frames at least 4 ms
_SIZE: Final = 25
_BEGIN: Final = 0x0F
_FLAGS: Final = 1 + PACKED_BYTES
_CHANNEL_17, _CHANNEL_18, _LOST, _FAILSAFE = 1, 2, 4, 8
_SWITCH_US: Final = (1000, 2000)  # channels 17 and 18 are on or off
_SHARE: Final = 1.0 / 50.0  # weight of a frame in the running mean of frames received


class SbusParser(RcParser):
    """Channels, the failsafe flag, and the share of frames received as the quality.

    A frame lost on the air repeats the channels of the one before, and is no reading.
    """

    def __init__(self) -> None:
        super().__init__()
        self._quality = 1.0
        self._is_in_step = False
        self._heard_s = -math.inf

    def feed(self, data: bytes, time_s: float) -> RcReading | None:
        """Parse more bytes. The latest reading in them, None without a complete frame."""
        pause_s, self._heard_s = time_s - self._heard_s, time_s
        if not self._is_in_step:
            if pause_s >= PAUSE_S:
                self._held = b""
            elif not self._held:
                self.skipped += len(data)
                return None
        return super().feed(data, time_s)

    def forget(self) -> None:
        """Drop half a frame: the line was cut."""
        super().forget()
        self._is_in_step = False

    def _size(self, held: bytes, at: int) -> int:
        is_possible = held[at] == _BEGIN and (at == 0 or self._is_in_step)
        self._is_in_step = self._is_in_step and is_possible
        return _SIZE if is_possible else 0

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
