"""Twin of a BNO085 on a UART, by CEVA's BNO08X data sheet 1000-3927 (1.2.3.1), SHTP reference 1000-3535 and
SH-2 reference 1000-3625: it measures what was requested since its last reset.
"""

import math
import struct

Quaternion = tuple[float, float, float, float]


def unescaped(frame: bytes) -> bytes:
    out, is_escaped = bytearray(), False
    for byte in frame:
        if byte == 0x7D and not is_escaped:
            is_escaped = True
            continue
        out.append(byte ^ 0x20 if is_escaped else byte)
        is_escaped = False
    return bytes(out)


class Bno085Twin:
    """`hear` takes what the host sends, `speak` returns what the part sends in a time. Degrees.

    gyro_deg_s: in board axes, x along the arrow, y to its left, z up. turned: quaternion from the axes of a
    board in its usual position to those of this one.
    """

    def __init__(self, turned: Quaternion = (0.0, 0.0, 0.0, 1.0)) -> None:
        self.heading_deg = self.roll_deg = self.pitch_deg = 0.0
        self.gyro_deg_s = (0.0, 0.0, 0.0)
        self.turned = turned
        self.status = 3
        self.is_silent = False
        self.is_hung = False  # until it is reset
        self.space = 256
        self.saves = 0
        self.requests: list[int] = []  # features
        self.commands: list[bytes] = []
        self._heard = bytearray()
        self._answers = bytearray()
        self.power_up()

    def power_up(self) -> None:
        """As its supply comes on, after a dip, or told to reset."""
        self.features: dict[int, float] = {}  # interval in s
        self._sequences = [0] * 6
        self._rest_s = {0x05: 0.0, 0x02: 0.0}
        advertisement = bytes([0x00, 0x01, 0x04, *range(40)])
        self._say(0, advertisement)
        self._say(1, b"\x01")
        self._say(2, bytes([0xF1, 0, 0x84, 0, 0]) + bytes(11))

    def _say(self, channel: int, payload: bytes) -> None:
        packet = struct.pack("<HBB", 4 + len(payload), channel, self._sequences[channel] & 0xFF) + payload
        self._sequences[channel] += 1
        body = b"".join(bytes([0x7D, b ^ 0x20]) if b in (0x7D, 0x7E) else bytes([b]) for b in packet)
        self._answers += b"\x7e\x01" + body + b"\x7e"

    def hear(self, data: bytes) -> None:
        """Bytes of the host."""
        if self.is_silent:
            return
        for byte in data:
            if byte != 0x7E:
                self._heard.append(byte)
                continue
            if self._heard:
                self._frame(unescaped(bytes(self._heard)))
            self._heard.clear()

    def _frame(self, frame: bytes) -> None:
        if frame == b"\x00":
            self._answers += b"\x7e\x00" + struct.pack("<H", self.space) + b"\x7e"
            return
        assert frame[0] == 0x01
        if len(frame) < 5:  # cut off where the line was unplugged
            return
        size, channel, _ = struct.unpack_from("<HBB", frame, 1)
        assert size == len(frame) - 1
        payload = frame[5:]
        if (channel, payload) == (1, b"\x01"):
            self.is_hung = False
            self.power_up()
        elif self.is_hung:
            return
        elif channel == 2 and payload[0] == 0xFD:
            assert len(payload) == 17
            feature, interval_us = payload[1], struct.unpack_from("<I", payload, 5)[0]
            self.requests.append(feature)
            self.features[feature] = interval_us * 1e-6
            self._say(2, b"\xfc" + payload[1:])
        elif channel == 2 and payload[0] == 0xF2:
            assert len(payload) == 12
            self.commands.append(payload)
            self.saves += payload[2] == 0x06
            self._say(2, bytes([0xF1, 0, payload[2], payload[1], 0]) + bytes(11))

    def speak(self, seconds: float) -> bytes:
        """What the part sends in this time, besides its answers."""
        for feature in sorted(self.features):
            interval_s = self.features[feature]
            self._rest_s[feature] = self._rest_s.get(feature, 0.0) + seconds
            while self._rest_s[feature] >= interval_s - 1e-9:
                self._rest_s[feature] -= interval_s
                self._say(3, b"\xfb" + struct.pack("<i", 12) + self._report(feature))
        said, self._answers = bytes(self._answers), bytearray()
        return b"" if self.is_silent else said

    def _report(self, feature: int) -> bytes:
        head = bytes([feature, self._sequences[3] & 0xFF, self.status, 0])
        if feature == 0x02:
            return head + struct.pack("<3h", *(round(math.radians(one) * 512.0) for one in self.gyro_deg_s))
        assert feature == 0x05
        x, y, z, w = self.quaternion()
        return head + struct.pack(
            "<5h", *(round(one * 16384.0) for one in (x, y, z, w)), round(0.05 * 4096.0)
        )

    def quaternion(self) -> Quaternion:
        """Board axes to east, north, up."""
        # Heading north, x is north and y west: a quarter turn about up from east and north
        yaw = math.radians(90.0 - self.heading_deg)
        usual = _times((0.0, 0.0, math.sin(yaw / 2.0), math.cos(yaw / 2.0)), _about_y(-self.pitch_deg))
        usual = _times(usual, _about_x(self.roll_deg))
        return _times(usual, self.turned)


def _about_x(degrees: float) -> Quaternion:
    """To starboard about ahead: y (left) goes up."""
    half = math.radians(degrees) / 2.0
    return math.sin(half), 0.0, 0.0, math.cos(half)


def _about_y(degrees: float) -> Quaternion:
    """About left: positive is the bow down."""
    half = math.radians(degrees) / 2.0
    return 0.0, math.sin(half), 0.0, math.cos(half)


def _times(a: Quaternion, b: Quaternion) -> Quaternion:
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )
