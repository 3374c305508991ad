"""A dAISy AIS receiver, as its maker's firmware writes (A. Studer, dAISy, nmea.c).

A radio packet of whole bytes becomes sentences of at most 42 bytes each; the numbers of messages in parts are
1 to 9; lines end with CR and LF.
"""

from functools import reduce
from operator import xor

_BYTES = 42


def packet(*payloads: str) -> bytes:
    """What was on the radio, from the six-bit characters of a published message's parts."""
    codes = [ord(one) - 48 for one in "".join(payloads)]
    bits = "".join(f"{code - 8 if code > 40 else code:06b}" for code in codes)
    return bytes(int(bits[at : at + 8], 2) for at in range(0, len(bits) - 7, 8))


class Daisy:
    """Keeps the number of the last message in parts."""

    def __init__(self) -> None:
        self._number = 0

    def hear(self, packet: bytes, channel: str = "A") -> bytes:
        """The lines for a packet, without its checksum, on a channel."""
        parts = [packet[at : at + _BYTES] for at in range(0, len(packet), _BYTES)]
        number = ""
        if len(parts) > 1:
            self._number = self._number % 9 + 1
            number = str(self._number)
        lines = b""
        for count, part in enumerate(parts, 1):
            bits = "".join(f"{byte:08b}" for byte in part)
            fill = -len(bits) % 6
            bits += "0" * fill
            codes = [int(bits[at : at + 6], 2) for at in range(0, len(bits), 6)]
            payload = "".join(chr(code + (56 if code > 39 else 48)) for code in codes)
            body = f"AIVDM,{len(parts)},{count},{number},{channel},{payload},{fill}".encode()
            lines += b"!%b*%02X\r\n" % (body, reduce(xor, body))
        return lines
