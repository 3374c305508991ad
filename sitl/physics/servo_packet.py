"""What ArduPilot's simulator sends: servo outputs, as its description of the JSON interface gives them.

Little-endian: magic, frame rate in Hz, frame count, then 16 pulse widths in µs, or 32 behind a magic of their
own.
"""

import struct
from typing import NamedTuple

MAGIC_16, MAGIC_32 = 18458, 29569
_HEAD = struct.Struct("<HHI")
_CHANNELS = {MAGIC_16: 16, MAGIC_32: 32}
_CENTRE_US, _SPAN_US = 1500.0, 500.0
_LEAST_US, _MOST_US = 800, 2200


class ServoPacket(NamedTuple):
    """One frame. rate_hz: how often the other side wants its physics stepped; pulses_us: 0 is no pulse."""

    rate_hz: int
    frame: int
    pulses_us: tuple[int, ...]

    def has_pulse(self, channel: int) -> bool:
        """Whether a channel, counted from 1, has a pulse that a servo output can send."""
        return _LEAST_US <= self.pulses_us[channel - 1] <= _MOST_US

    def share(self, channel: int) -> float:
        """What a channel, counted from 1, asks of a motor: −1..1. Without a pulse it is 0."""
        if not self.has_pulse(channel):
            return 0.0
        return min(max((self.pulses_us[channel - 1] - _CENTRE_US) / _SPAN_US, -1.0), 1.0)


def parse_servos(data: bytes) -> ServoPacket | None:
    """Read a datagram; None for anything that is not one of these packets, whole."""
    if len(data) < _HEAD.size:
        return None
    magic, rate_hz, frame = _HEAD.unpack_from(data)
    count = _CHANNELS.get(magic)
    if count is None or len(data) != _HEAD.size + 2 * count or rate_hz == 0:
        return None
    return ServoPacket(rate_hz, frame, struct.unpack_from(f"<{count}H", data, _HEAD.size))
