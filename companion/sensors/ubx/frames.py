"""UBX framing: bytes to frames and back. Malformed input is counted, never raised.

Source: u-blox, *u-blox 8 / u-blox M8 Receiver description including protocol specification* (UBX-13003221),
sections 32.2 "UBX Frame Structure" and 32.4 "UBX Checksum".
"""

from typing import Final, NamedTuple

_SYNC: Final = b"\xb5\x62"
_HEADER, _CHECKSUM = 6, 2
# The longest expected frame is a MON-VER of 16 extensions. More is a corrupted length, which would hold back
# all that follows.
_LONGEST_PAYLOAD: Final = 520

ACK_NAK, ACK_ACK = 0x0500, 0x0501
CFG_PRT, CFG_MSG, CFG_RATE, CFG_NAV5, CFG_VALSET = 0x0600, 0x0601, 0x0608, 0x0624, 0x068A
MON_VER = 0x0A04
NAV_DOP, NAV_PVT, NAV_RELPOSNED = 0x0104, 0x0107, 0x013C


class UbxFrame(NamedTuple):
    """kind: message class × 256 + message id."""

    kind: int
    payload: bytes


def encode(kind: int, payload: bytes = b"") -> bytes:
    """A frame as it goes over the line. Without a payload it polls the message."""
    body = kind.to_bytes(2, "big") + len(payload).to_bytes(2, "little") + payload
    return _SYNC + body + _checksum(body)


class UbxReader:
    """Splits a byte stream into frames and the bytes between them, which are NMEA sentences or noise.

    `malformed`: frames with a wrong checksum or length.
    """

    def __init__(self) -> None:
        self._held = b""
        self.malformed = 0

    def feed(self, data: bytes) -> tuple[list[UbxFrame], bytes]:
        """Complete frames, and the bytes between them; a partial frame is kept."""
        held, start = self._held + data, 0
        frames: list[UbxFrame] = []
        between = []
        while True:
            sync = held.find(_SYNC, start)
            if sync < 0:
                sync = len(held) - held.endswith(_SYNC[:1])
                break
            length = int.from_bytes(held[sync + 4 : sync + 6], "little")
            end = sync + _HEADER + length + _CHECKSUM
            if len(held) < sync + _HEADER or (length <= _LONGEST_PAYLOAD and len(held) < end):
                break
            if length > _LONGEST_PAYLOAD or _checksum(held[sync + 2 : end - 2]) != held[end - 2 : end]:
                self.malformed += 1
                between.append(held[start : sync + 1])
                start = sync + 1
                continue
            between.append(held[start:sync])
            kind = int.from_bytes(held[sync + 2 : sync + 4], "big")
            frames.append(UbxFrame(kind, held[sync + _HEADER : end - 2]))
            start = end
        between.append(held[start:sync])
        self._held = held[sync:]
        return frames, b"".join(between)

    def forget(self) -> None:
        """Drop a partial frame after a reconnect."""
        self._held = b""


def _checksum(body: bytes) -> bytes:
    a = b = 0
    for byte in body:
        a += byte
        b += a
    return bytes((a & 0xFF, b & 0xFF))
