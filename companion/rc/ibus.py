"""FlySky iBUS, servo output: 115,200 baud, 8N1, 32 bytes every 7 ms.

0x20, 0x40, fourteen channels of two bytes in µs, little-endian, and 0xFFFF minus the sum of all bytes so far.
Newer receivers put channels 15 to 18 into the upper four bits of the first twelve, three words a channel.
Source: blog.dsp.id.au/posts/2017/10/22/flysky-ibus-protocol. There is no flag for a lost transmitter: the
receiver stops sending, or sends the pulses configured for that case, which FS_THR_VALUE detects.
"""

from typing import Final

from companion.core.readings import RcReading
from companion.rc.parser import RcParser

BAUD: Final = 115_200
_SIZE: Final = 0x20
_COMMAND: Final = 0x40
_CHANNELS: Final = 14


class IbusParser(RcParser):
    """Channels only: quality and signal are unknown."""

    def _size(self, held: bytes, at: int) -> int:
        if held[at] != _SIZE or (at + 1 < len(held) and held[at + 1] != _COMMAND):
            return 0
        return _SIZE

    def _is_whole(self, frame: bytes) -> bool:
        return 0xFFFF - sum(frame[:-2]) == frame[-2] | frame[-1] << 8

    def _reading(self, frame: bytes, time_s: float) -> RcReading:
        words = [frame[place] | frame[place + 1] << 8 for place in range(2, 2 + 2 * _CHANNELS, 2)]
        channels_us = [word & 0x0FFF for word in words]
        nibbles = [word >> 12 for word in words[:12]]
        if any(nibbles):
            for first in range(0, 12, 3):
                low, middle, high = nibbles[first : first + 3]
                channels_us.append(low | middle << 4 | high << 8)
        return RcReading(time_s, tuple(channels_us))
