"""RTCM 3 framing: bytes to whole frames with a valid checksum. Malformed input is counted, never raised.

Source: RTCM 10403.3, section 4.1 (transport layer): preamble 0xD3, six zero bits, ten bits of length,
message, CRC-24Q.
"""

from typing import Final

_PREAMBLE: Final = b"\xd3"
_HEADER, _PARITY = 3, 3
_RESERVED: Final = 0xFC  # of the byte behind the preamble
_MOST_MALFORMED: Final = 3  # in one call
_POLYNOMIAL: Final = 0x1864CFB


def _table() -> list[int]:
    table = []
    for byte in range(256):
        crc = byte << 16
        for _ in range(8):
            crc = crc << 1 ^ (_POLYNOMIAL if crc & 0x800000 else 0)
        table.append(crc & 0xFFFFFF)
    return table


_TABLE: Final = _table()


def crc24q(data: bytes) -> int:
    """Qualcomm's CRC-24, which starts at 0."""
    crc = 0
    for byte in data:
        crc = (crc << 8 & 0xFFFFFF) ^ _TABLE[crc >> 16 ^ byte]
    return crc


def message_type(frame: bytes) -> int:
    """Such as 1005 for a station's position; 0 of an empty frame."""
    return frame[3] << 4 | frame[4] >> 4 if len(frame) > _HEADER + _PARITY + 1 else 0


class RtcmReader:
    """Splits a byte stream into frames. `malformed`: frames with a wrong checksum.

    Every wrong checksum costs the computation over up to 1029 bytes. Beyond a few in one call the rest is
    dropped, so that made-up preambles cannot load the computer.
    """

    def __init__(self) -> None:
        self.malformed = 0
        self._held = b""

    def feed(self, data: bytes) -> list[bytes]:
        """Whole frames, with header and checksum; a partial one is kept, at most 1028 bytes."""
        held, at = self._held + data, 0
        frames = []
        left = _MOST_MALFORMED
        while (at := held.find(_PREAMBLE, at)) >= 0:
            if len(held) < at + _HEADER:
                break
            if held[at + 1] & _RESERVED:
                at += 1
                continue
            end = at + _HEADER + int.from_bytes(held[at + 1 : at + 3], "big") + _PARITY
            if len(held) < end:
                break
            if crc24q(held[at:end]):  # with its own checksum behind it a frame gives 0
                self.malformed += 1
                at += 1
                left -= 1
                if not left:
                    at = -1
                    break
                continue
            frames.append(held[at:end])
            at = end
        self._held = held[at:] if at >= 0 else b""
        return frames

    @property
    def is_partial(self) -> bool:
        """Whether it holds a part of a frame."""
        return bool(self._held)

    def forget(self) -> None:
        """Drop a partial frame."""
        self._held = b""
