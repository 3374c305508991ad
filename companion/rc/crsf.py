"""CRSF, the protocol of TBS Crossfire and ExpressLRS receivers: 420,000 baud, 8N1, not inverted.

A frame: 0xC8, the number of bytes that follow, a type, the payload, and a CRC-8 over type and payload
(polynomial 0xD5, as in DVB-S2). Source: the description by its working group (github.com/crsf-wg/crsf, wiki).
"""

from typing import Final

from companion.core.readings import RcReading
from companion.rc.parser import PACKED_BYTES, RcParser, unpack_channels

BAUD: Final = 420_000
_SYNC: Final = 0xC8
_SHORTEST, _LONGEST = 2, 62  # valid length bytes: type and CRC alone; a frame of 64 bytes
_CHANNELS: Final = 0x16
_STATISTICS: Final = 0x14
_STATISTICS_BYTES: Final = 10
_POLYNOMIAL: Final = 0xD5


def _crc_table() -> bytes:
    table = bytearray()
    for byte in range(256):
        crc = byte
        for _ in range(8):
            crc = crc << 1 ^ (_POLYNOMIAL if crc & 0x80 else 0)
        table.append(crc & 0xFF)
    return bytes(table)


_TABLE: Final = _crc_table()


def crc8(data: bytes) -> int:
    """CRC-8/DVB-S2."""
    crc = 0
    for byte in data:
        crc = _TABLE[crc ^ byte]
    return crc


class CrsfParser(RcParser):
    """Channels, with the link quality of the latest statistics. A quality of 0 is the failsafe."""

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
        return crc8(frame[2:]) == 0  # a CRC over data and CRC is 0

    def _reading(self, frame: bytes, time_s: float) -> RcReading | None:
        kind, payload = frame[2], frame[3:-1]
        if kind == _CHANNELS and len(payload) == PACKED_BYTES:
            self._channels_us = unpack_channels(payload)
        elif kind == _STATISTICS and len(payload) >= _STATISTICS_BYTES:
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
