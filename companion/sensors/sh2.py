"""A BNO08x on a UART: its frames, its set-up, its rotation vector and gyro.

SHTP packets between flags (CEVA BNO08X data sheet 1000-3927, section 1.2.3.1; SHTP reference manual
1000-3535): a flag, a protocol id, escaped bytes, a flag. There is no checksum; a frame that has lost a byte
is recognised by the packet's own length.

The session (CEVA SH-2 reference manual 1000-3625, section 6) requests the features when the part reports a
reset, and again when it falls silent; after a longer silence it tells the part to reset. The rotation vector
is absolute: its north is that of the part's magnetometer, which calibrates itself. The part keeps the
calibration in its flash; it is saved once the accuracy is high.
"""

import struct
from collections import deque
from typing import Final, NamedTuple

from companion.core.vectors import Vector

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


class ShtpReader:
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


PERIOD_S: Final = 0.02
SILENT_S: Final = 1.0  # without a rotation vector: the features are requested again
RESET_S: Final = 4.0  # without one: the part is reset
_QUERY_S: Final = 0.1  # until the space is asked for again
_QUERIES: Final = 5  # without an answer; then a packet is sent without one

_SET_FEATURE, _COMMAND_REQUEST = 0xFD, 0xF2  # 6.5.4, 6.3.8
_TIMEBASE, _REBASE = 0xFB, 0xFA
_ROTATION, _GYRO = 0x05, 0x02  # 6.5.18, 6.5.13
_SIZES: Final = {_TIMEBASE: 5, _REBASE: 5, _ROTATION: 14, _GYRO: 10}
_RESET, _RESET_DONE = 1, 1  # on the executable channel
_SAVE_CALIBRATION, _SET_CALIBRATION = 0x06, 0x07  # 6.4.6, 6.4.7
_FEATURE: Final = struct.Struct("<BBBHIII")  # id, feature, flags, sensitivity, interval µs, batch µs, word
_QUATERNION: Final = struct.Struct("<4hh")  # i, j, k, real, accuracy
_RATE: Final = struct.Struct("<3h")
_Q14, _Q12, _Q9 = 2.0**-14, 2.0**-12, 2.0**-9
_HIGH: Final = 3  # status of a sample: 0 unreliable to 3 high
_UNIT: Final = (0.9, 1.1)  # length of a sound quaternion


class Rotation(NamedTuple):
    """A sample: x, y, z, w turn board axes into east, north, up. rate: rad/s in board axes, None before the
    first. status: 0 unreliable to 3.
    """

    quaternion: tuple[float, float, float, float]
    accuracy_rad: float
    status: int
    rate: Vector | None


class Sh2Session:
    """Feed it bytes and time; send what it puts out, one byte at a time."""

    def __init__(self, now_s: float) -> None:
        self.resets = 0
        self._reader = ShtpReader()
        self._waiting: deque[tuple[int, bytes]] = deque()
        self._outbox: list[bytes] = []
        self._sequences = [0] * 6  # by channel
        self._commands = 0
        self._rate: Vector | None = None
        self._heard_s = self._asked_s = self._reset_s = now_s
        self._query_s = -1.0
        self._queries = 0
        self._has_saved = False
        self._request_features()

    def feed(self, data: bytes, now_s: float) -> list[Rotation]:
        """The samples that these bytes complete."""
        samples: list[Rotation] = []
        for frame in self._reader.feed(data):
            if isinstance(frame, Space):
                self._queries = 0
                self._send_waiting(frame.size)
            elif frame.channel == REPORTS:
                samples += self._read_reports(frame.payload)
            elif frame.channel == EXECUTABLE and frame.payload[:1] == bytes((_RESET_DONE,)):
                self.resets += 1
                self._rate, self._has_saved = None, False
                self._waiting.clear()
                self._request_features()
        if samples:
            self._heard_s = now_s
            if samples[-1].status == _HIGH and not self._has_saved:
                self._has_saved = True
                self._request(_SAVE_CALIBRATION)
        return samples

    def tick(self, now_s: float) -> None:
        """Ask again where the part is silent."""
        if now_s - max(self._heard_s, self._reset_s) > RESET_S:
            self._reset_s = now_s
            self._waiting.clear()
            self._waiting.append((EXECUTABLE, bytes((_RESET,))))
        elif now_s - max(self._heard_s, self._asked_s, self._reset_s) > SILENT_S:
            self._asked_s = now_s
            self._waiting.clear()
            self._request_features()
        if self._waiting and now_s - self._query_s >= _QUERY_S:
            self._query_s = now_s
            self._queries += 1
            if self._queries > _QUERIES:
                self._send_waiting(None)
            else:
                self._outbox.append(QUERY)

    def take_outbox(self) -> list[bytes]:
        """Frames to send since the last call."""
        frames, self._outbox = self._outbox, []
        return frames

    def _request_features(self) -> None:
        interval_us = round(PERIOD_S * 1e6)
        for feature in (_ROTATION, _GYRO):
            self._waiting.append((CONTROL, _FEATURE.pack(_SET_FEATURE, feature, 0, 0, interval_us, 0, 0)))
        # Accelerometer, gyro and magnetometer calibrate themselves; by default the gyro does not
        self._request(_SET_CALIBRATION, bytes((1, 1, 1)))

    def _request(self, command: int, parameters: bytes = b"") -> None:
        body = bytes((_COMMAND_REQUEST, self._commands & 0xFF, command)) + parameters.ljust(9, b"\0")
        self._commands += 1
        self._waiting.append((CONTROL, body))

    def _send_waiting(self, space: int | None) -> None:
        if not self._waiting:
            return
        channel, payload = self._waiting[0]
        frame = encode(channel, self._sequences[channel], payload)
        if space is not None and space < len(frame):  # as it is sent, escaped
            return
        self._waiting.popleft()
        self._queries, self._query_s = 0, -1.0  # the next one is asked for at once
        self._outbox.append(frame)
        self._sequences[channel] += 1

    def _read_reports(self, payload: bytes) -> list[Rotation]:
        samples: list[Rotation] = []
        at = 0
        while at < len(payload):
            kind = payload[at]
            size = _SIZES.get(kind)
            if size is None or at + size > len(payload):
                break  # of a feature that was not requested, or cut off
            body = payload[at + 4 : at + size]
            if kind == _GYRO:
                x, y, z = _RATE.unpack(body)
                self._rate = (x * _Q9, y * _Q9, z * _Q9)
            elif kind == _ROTATION:
                i, j, k, real, accuracy = _QUATERNION.unpack(body)
                quaternion = (i * _Q14, j * _Q14, k * _Q14, real * _Q14)
                if _UNIT[0] < sum(one * one for one in quaternion) < _UNIT[1]:
                    status = payload[at + 2] & 0x03
                    samples.append(Rotation(quaternion, accuracy * _Q12, status, self._rate))
            at += size
        return samples
