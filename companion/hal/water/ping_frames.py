"""Frames of the Ping protocol (Blue Robotics): bytes to messages and back. Malformed input is counted.

'B' 'R', length of the payload, message id, source and destination (one byte each), payload, sum of all bytes
before; numbers of two bytes, the lower one first (docs.bluerobotics.com/ping-protocol).
"""

import struct
from typing import Final, NamedTuple

SET_SPEED_OF_SOUND: Final = 1002  # u32, mm/s
SET_MODE_AUTO: Final = 1003  # u8: gain and range by the part
SET_PING_INTERVAL: Final = 1004  # u16, ms
DISTANCE_SIMPLE: Final = 1211  # u32 mm, u8 percent
DISTANCE: Final = 1212  # u32 mm, u16 percent, and the settings of the measurement
CONTINUOUS_START: Final = 1400  # u16: the message to send by itself

_START: Final = b"BR"
_HEADER: Final = struct.Struct("<2sHHBB")
_LONGEST: Final = 256  # a profile has some 230 bytes
_HOST, _ANY = 0, 0


class PingMessage(NamedTuple):
    """A message with a valid sum."""

    number: int
    payload: bytes


def encode(number: int, payload: bytes = b"") -> bytes:
    """A frame to the part."""
    frame = _HEADER.pack(_START, len(payload), number, _HOST, _ANY) + payload
    return frame + struct.pack("<H", sum(frame) & 0xFFFF)


class PingParser:
    """Finds the frames in a byte stream. `malformed`: those with a wrong sum or length."""

    def __init__(self) -> None:
        self._held = b""
        self.malformed = 0

    def feed(self, data: bytes) -> list[PingMessage]:
        """The whole messages; a partial one is kept."""
        held, messages = self._held + data, list[PingMessage]()
        while True:
            begin = held.find(_START)
            if begin < 0:
                held = held[-1:] if held.endswith(_START[:1]) else b""
                break
            held = held[begin:]
            if len(held) < _HEADER.size:
                break
            _, length, number, _, _ = _HEADER.unpack_from(held)
            end = _HEADER.size + length
            if length <= _LONGEST and len(held) < end + 2:
                break
            if length <= _LONGEST and sum(held[:end]) & 0xFFFF == int.from_bytes(
                held[end : end + 2], "little"
            ):
                messages.append(PingMessage(number, held[_HEADER.size : end]))
                held = held[end + 2 :]
            else:
                self.malformed += 1
                held = held[1:]
        self._held = held
        return messages

    def forget(self) -> None:
        """Drop a partial frame."""
        self._held = b""
