"""Twins of scanning lidars, whose zero is ahead and which turn clockwise seen from above.

LD06 and LD19, by the maker's own driver (LDROBOT, ldlidar_stl_ros2: `lipkg.h`, `lipkg.cpp`): a packed struct
of 54 2C, speed in °/s, first angle, 12 times range in mm and intensity, last angle, stamp in ms up to 30,000,
CRC-8 of polynomial 4D over all before; the rays lie evenly from the first angle to the last; 4,500 rays a
second. Its development manual has one packet; a user of an LD20, which has the same ones, published another.

RPLIDAR A1, by Slamtec's rplidar_sdk (`sl_lidar_cmd.h`, `sl_lidar_driver.cpp`, `handler_normalnode.cpp`) and
Adafruit_CircuitPython_RPLIDAR: A5 and a command; answers after A5 5A, length and mode, type; nodes of five
bytes. ArduPilot waits for 63 bytes of text after a reset.
"""

import struct
from collections.abc import Callable

LD06_MANUAL = bytes.fromhex(
    "542C6808AB7EE000E4DC00E2D900E5D500E3D300E4D000E9CD00E4CA00E2C700E9C500E5C200E5C000E5BE823A1A50"
)
LD20_IN_THE_OPEN = bytes.fromhex(
    "542C7408B0860000D40000D40000D40000D40000D40000D50000D50000490000 5F0000B00000D20000D402891E091F"
)

Echo = Callable[[float], tuple[int, int]]
"""Range in mm (0: none) and intensity at an angle in degrees."""

OPEN: Echo = lambda _: (0, 0)  # noqa: E731
NODES_HZ, RAYS_HZ = 2000.0, 4500.0


def crc8(data: bytes) -> int:
    """Bit by bit; the maker has a table of it."""
    crc = 0
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1 ^ 0x4D) & 0xFF if crc & 0x80 else crc << 1
    return crc


class Ld06Twin:
    """Sends what `echo` says, always. turn_hz: of its motor."""

    def __init__(self, echo: Echo = OPEN, turn_hz: float = 10.0) -> None:
        self.echo, self.turn_hz = echo, turn_hz
        self._angle_deg = self._owed = 0.0
        self._stamp_s = 0.0

    def say(self, seconds: float) -> bytes:
        """The packets that it completes in this time."""
        self._owed += seconds * RAYS_HZ
        said = b""
        while self._owed >= 12.0:
            self._owed -= 12.0
            said += self._packet()
        return said

    def _packet(self) -> bytes:
        step_deg = 360.0 * self.turn_hz / RAYS_HZ
        angles = [(self._angle_deg + ray * step_deg) % 360.0 for ray in range(12)]
        self._angle_deg = (angles[-1] + step_deg) % 360.0
        self._stamp_s += 12.0 / RAYS_HZ
        first, last = (round(100.0 * angle) % 36_000 for angle in (angles[0], angles[-1]))
        body = struct.pack("<BBHH", 0x54, 0x2C, round(360.0 * self.turn_hz), first)
        body += b"".join(struct.pack("<HB", *self.echo(angle)) for angle in angles)
        body += struct.pack("<HH", last, round(1e3 * self._stamp_s) % 30_000)
        return body + bytes([crc8(body)])


class RplidarTwin:
    """Does what it is asked. health: status and code; heals: whether a reset makes it good again."""

    def __init__(self, echo: Echo = OPEN, turn_hz: float = 5.5) -> None:
        self.echo, self.turn_hz = echo, turn_hz
        self.health, self.heals = (0, 0), True
        self.is_scanning = False
        self.requests = b""
        self._angle_deg = self._owed = 0.0

    def power_up(self) -> None:
        """It waits for requests."""
        self.is_scanning = False

    def hear(self, data: bytes) -> bytes:
        """Take requests; the answers."""
        answer = b""
        while data:
            assert data[0] == 0xA5, data
            command, length = data[1], 2
            if command & 0x80:
                length = 4 + data[2]
                checksum = 0
                for byte in data[:length]:
                    checksum ^= byte
                assert checksum == 0
            data = data[length:]
            self.requests += bytes([command])
            answer += self._do(command)
        return answer

    def _do(self, command: int) -> bytes:
        if command == 0x25:
            self.is_scanning = False
        elif command == 0x40:
            self.is_scanning = False
            if self.heals:
                self.health = (0, 0)
            return b"RP LIDAR System.\r\nFirmware Ver 1.29, HW Ver 7\r\nModel: 18\r\n".ljust(63, b"\n")
        elif command == 0x52 and not self.is_scanning:
            return b"\xa5\x5a" + struct.pack("<IB", 3, 6) + struct.pack("<BH", *self.health)
        elif command == 0x20 and self.health[0] != 2:
            self.is_scanning = True
            return b"\xa5\x5a" + struct.pack("<IB", 1 << 30 | 5, 0x81)
        return b""

    def say(self, seconds: float) -> bytes:
        """The nodes that it completes in this time."""
        self._owed += seconds * NODES_HZ
        count, self._owed = int(self._owed), self._owed % 1.0
        return b"".join(self._node() for _ in range(count)) if self.is_scanning else b""

    def _node(self) -> bytes:
        millimetres, quality = self.echo(self._angle_deg)
        angle_q6 = round(64.0 * self._angle_deg)
        before_deg = self._angle_deg
        self._angle_deg = (self._angle_deg + 360.0 * self.turn_hz / NODES_HZ) % 360.0
        flags = 1 if before_deg < 360.0 * self.turn_hz / NODES_HZ else 2
        return struct.pack("<BHH", quality << 2 | flags, angle_q6 << 1 | 1, 4 * millimetres)
