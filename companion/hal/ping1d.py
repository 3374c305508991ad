"""Ping1D echo sounder of Blue Robotics on a serial line.

It is told to send its distances by itself, and told again whenever it is silent: a part that has lost its
supply begins without. A frame of the Ping protocol:
'B' 'R', length of the payload, message id, source and destination (one byte each), payload, sum of all bytes
before; numbers of two bytes, the lower one first (docs.bluerobotics.com/ping-protocol).
"""

import struct
from collections.abc import Callable, Iterator
from typing import Final

from companion.config.sensors import DepthPart
from companion.core.readings import DepthReading
from companion.hal.port_sensor import PortSensor
from companion.links.interfaces import Port
from companion.links.port_url import open_line
from companion.sensors.framing import FrameReader

_SET_SPEED_OF_SOUND: Final = 1002  # u32, mm/s
_SET_MODE_AUTO: Final = 1003  # u8: gain and range by the part
_SET_PING_INTERVAL: Final = 1004  # u16, ms
_DISTANCE_SIMPLE: Final = 1211  # u32 mm, u8 percent
_DISTANCE: Final = 1212  # u32 mm, u16 percent, and the settings of the measurement
_CONTINUOUS_START: Final = 1400  # u16: the message to send by itself

_START: Final = b"BR"
_HEADER: Final = struct.Struct("<2sHHBB")
_LONGEST: Final = 256  # a profile has some 230 bytes
_HOST, _ANY = 0, 0
BAUD: Final = 115200
_INTERVAL_MS: Final = 200  # a boat sails less than half a metre
_SILENT_S: Final = 2.0  # ten intervals
_REST_S: Final = 0.05  # a UART hands over a frame in pieces
_SIMPLE, _FULL = struct.Struct("<IB"), struct.Struct("<IH")


def encode(number: int, payload: bytes = b"") -> bytes:
    """A frame to the part."""
    frame = _HEADER.pack(_START, len(payload), number, _HOST, _ANY) + payload
    return frame + struct.pack("<H", sum(frame) & 0xFFFF)


class PingReader(FrameReader):
    """Splits bytes into frames with a valid sum."""

    def _size(self, held: bytes, at: int) -> int:
        if not _START.startswith(held[at : at + 2]):
            return 0
        if len(held) < at + _HEADER.size:
            return _HEADER.size
        length = int.from_bytes(held[at + 2 : at + 4], "little")
        return _HEADER.size + length + 2 if length <= _LONGEST else 0

    def _is_whole(self, frame: bytes) -> bool:
        return sum(frame[:-2]) & 0xFFFF == int.from_bytes(frame[-2:], "little")


class Ping1d(PortSensor[DepthReading]):
    """A Ping1D on its serial line. Satisfies `companion.hal.interfaces.DepthSounder`."""

    def __init__(self, port: Port, now: Callable[[], float], part: DepthPart) -> None:
        super().__init__(port, now, _REST_S)
        self._part = part
        self.reader = PingReader()
        self._due_s = now()

    def step(self) -> None:
        """Process received bytes; set the part up if it is silent. Never waits."""
        super().step()
        now_s = self._now()
        if now_s < self._due_s or not self._links:
            return
        self._due_s = now_s + _SILENT_S
        for link in self._links:
            link.send(self._set_up())

    def _set_up(self) -> bytes:
        millimetres_s = round(self._part.sound_m_s * 1000.0)
        return (
            encode(_SET_SPEED_OF_SOUND, millimetres_s.to_bytes(4, "little"))
            + encode(_SET_MODE_AUTO, b"\x01")
            + encode(_SET_PING_INTERVAL, _INTERVAL_MS.to_bytes(2, "little"))
            + encode(_CONTINUOUS_START, _DISTANCE_SIMPLE.to_bytes(2, "little"))
        )

    def _decode(self, chunk: bytes, time_s: float) -> Iterator[DepthReading]:
        for frame in self.reader.split(chunk):
            number, payload = int.from_bytes(frame[4:6], "little"), frame[_HEADER.size : -2]
            layout = {_DISTANCE_SIMPLE: _SIMPLE, _DISTANCE: _FULL}.get(number)
            if layout is None or len(payload) < layout.size:
                continue
            self._due_s = time_s + _SILENT_S
            millimetres, percent = layout.unpack_from(payload)
            yield self._reading(time_s, millimetres / 1000.0, min(percent / 100.0, 1.0))

    def _reading(self, time_s: float, depth_m: float, confidence: float) -> DepthReading:
        part = self._part
        is_found = confidence >= part.min_confidence and 0.0 < depth_m <= part.max_range_m
        return DepthReading(
            time_s,
            depth_m if is_found else None,
            None,
            part.transducer_m,
            part.min_range_m,
            part.max_range_m,
            confidence,
        )

    def _forget(self) -> None:
        self.reader.forget()
        self._due_s = self._now()


def open_ping1d(part: DepthPart, now: Callable[[], float]) -> Ping1d:
    """Open the sounder on its port and start reading. Raises as `open_line`."""
    return Ping1d(open_line(part.port, part.baud or BAUD, now), now, part).start()
