"""Frames of a BNO08x on a UART: SHTP packets between flags (CEVA BNO08X data sheet 1000-3927, section
1.2.3.1; SHTP reference manual 1000-3535).

A frame is a flag, a protocol id, escaped bytes, a flag. There is no checksum; a frame that has lost a byte is
recognised by the packet's own length.
"""

import struct
from typing import Final, NamedTuple

_FLAG, _ESCAPE, _FLIP = 0x7E, 0x7D, 0x20
_CONTROL, _SHTP = 0x00, 0x01  # protocol ids
_HEADER: Final = struct.Struct("<HBB")  # length with header, channel, sequence number
_CONTINUES: Final = 0x8000  # bit of the length
_LONGEST: Final = 1024  # the advertisement after a reset is the longest, with some 300 bytes

COMMAND, EXECUTABLE, CONTROL, REPORTS = range(4)  # channels
QUERY: Final = bytes((_FLAG, _CONTROL, _FLAG))  # for the space in the part's buffer, asked before each packet


class Packet(NamedTuple):
    """Payload on a channel."""

    channel: int
    payload: bytes


class Space(NamedTuple):
    """How many bytes the part can take."""

    size: int


def encode(channel: int, sequence: int, payload: bytes) -> bytes:
    """The frame of a packet."""
    packet = _HEADER.pack(_HEADER.size + len(payload), channel, sequence & 0xFF) + payload
    escaped = bytearray((_FLAG, _SHTP))
    for byte in packet:
        escaped += bytes((_ESCAPE, byte ^ _FLIP)) if byte in (_FLAG, _ESCAPE) else bytes((byte,))
    return bytes(escaped) + bytes((_FLAG,))


class FrameReader:
    """Finds frames in a stream. dropped: those that were incomplete."""

    def __init__(self) -> None:
        self.dropped = 0
        self._frame = bytearray()
        self._is_escaped = False

    def feed(self, data: bytes) -> list[Packet | Space]:
        """The frames that these bytes complete."""
        found: list[Packet | Space] = []
        for byte in data:
            if byte == _FLAG:
                if self._frame:  # two flags in a row begin a frame
                    found += self._decode(bytes(self._frame))
                self._frame.clear()
                self._is_escaped = False
            elif byte == _ESCAPE:
                self._is_escaped = True
            elif len(self._frame) < _LONGEST:
                self._frame.append(byte ^ _FLIP if self._is_escaped else byte)
                self._is_escaped = False
        return found

    def _decode(self, frame: bytes) -> list[Packet | Space]:
        protocol, body = frame[0], frame[1:]
        if protocol == _CONTROL and len(body) == 2:
            return [Space(int.from_bytes(body, "little"))]
        if protocol == _SHTP and len(body) >= _HEADER.size:
            size, channel, _ = _HEADER.unpack_from(body)
            if size == len(body):  # a continuation has its bit set, and is not needed
                return [Packet(channel, body[_HEADER.size :])]
            if size & ~_CONTINUES == len(body):
                return []
        self.dropped += 1
        return []
