"""Twins of the I²C parts, register by register as their data sheets have them, behind Linux's i2c-dev.

smbus2 itself is real: only the system call below it is answered here.
"""

import ctypes
import errno
import math
import struct
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:  # benchmarks use these twins, too
    import pytest

I2C_SLAVE, I2C_FUNCS, I2C_SMBUS = 0x0703, 0x0705, 0x0720  # linux/i2c-dev.h
I2C_SMBUS_READ, I2C_SMBUS_I2C_BLOCK_DATA = 1, 8  # linux/i2c.h
CONFIG, AMG, NDOF = 0x00, 0x07, 0x0C


class Part(Protocol):
    """Something with registers on the bus."""

    def get(self, register: int, length: int) -> bytes: ...
    def put(self, register: int, data: bytes) -> None: ...


_WAYS = {  # of a boat: ahead, to starboard, down
    "bow": (1.0, 0.0, 0.0),
    "stern": (-1.0, 0.0, 0.0),
    "starboard": (0.0, 1.0, 0.0),
    "port": (0.0, -1.0, 0.0),
    "down": (0.0, 0.0, 1.0),
    "up": (0.0, 0.0, -1.0),
}


class Bno055Twin:
    """Bosch BST-BNO055-DS000-14: as after power-up, until it is written to.

    It measures in NDOF mode only (angles read as zero otherwise); units and axes change in CONFIG mode only.
    heading_deg, roll_deg, pitch_deg: how the boat lies: its bow from north, starboard side down, bow up.
    mounted: where on the boat the arrows x, y and z on the part (figure in 3.4) point.
    """

    def __init__(self, chip_id: int = 0xA0, mounted: tuple[str, str, str] = ("bow", "port", "up")) -> None:
        self.chip_id = chip_id
        self.mounted = mounted
        self.heading_deg, self.roll_deg, self.pitch_deg = 90.0, 1.0, -2.0
        self.yaw_rate_deg_s = 10.0  # of the boat about the vertical, to starboard
        self.magnet = 3
        self.flips = bytes(0x80)  # bits that the bus gets wrong
        self.resets = -1
        self.power_up()

    def power_up(self) -> None:
        """As its supply comes on, or after a dip."""
        self.resets += 1
        self.mode, self.units, self.page, self.power = CONFIG, 0x80, 0, 0
        self.axes = bytearray((0x24, 0x00))
        self.profile = bytes(22)

    def in_the_world(self) -> list[tuple[float, float, float]]:
        """East, north and up of the axes x, y and z that the part works with."""
        heading, roll, pitch = (
            math.radians(angle) for angle in (self.heading_deg, self.roll_deg, self.pitch_deg)
        )
        arrows = []
        for way in self.mounted:
            x, y, z = _WAYS[way]
            y, z = y * math.cos(roll) - z * math.sin(roll), y * math.sin(roll) + z * math.cos(roll)
            x, z = x * math.cos(pitch) + z * math.sin(pitch), z * math.cos(pitch) - x * math.sin(pitch)
            north, east = (
                x * math.cos(heading) - y * math.sin(heading),
                x * math.sin(heading) + y * math.cos(heading),
            )
            arrows.append((east, north, -z))
        axes = []
        for number in range(3):  # AXIS_MAP_CONFIG: two bits an axis; AXIS_MAP_SIGN: x is bit 2
            east, north, up = arrows[self.axes[0] >> 2 * number & 3]
            sign = -1.0 if self.axes[1] >> (2 - number) & 1 else 1.0
            axes.append((sign * east, sign * north, sign * up))
        return axes

    def _angles_deg(self) -> tuple[float, float, float]:
        """Heading, roll and pitch in Android's way (data sheet BMM150, 9.1): the heading is of the y axis,
        roll is positive when x moves towards z, pitch when z moves towards y.
        """
        x, y, z = self.in_the_world()
        heading = math.degrees(math.atan2(y[0], y[1])) % 360.0
        return heading, math.degrees(math.asin(x[2])), math.degrees(math.atan2(-y[2], z[2]))

    def _quaternion(self) -> tuple[float, float, float, float]:
        """w, x, y, z: 1, 0, 0, 0 with x to the east, y to the north, z up. Shepperd's method."""
        (a, d, g), (b, e, h), (c, f, i) = self.in_the_world()
        squares = (a + e + i, a, e, i)
        match squares.index(max(squares)):
            case 0:
                q = (1.0 + a + e + i, h - f, c - g, d - b)
            case 1:
                q = (h - f, 1.0 + a - e - i, b + d, c + g)
            case 2:
                q = (c - g, b + d, 1.0 - a + e - i, f + h)
            case _:
                q = (d - b, c + g, f + h, 1.0 - a - e + i)
        length = math.hypot(*q)
        return (q[0] / length, q[1] / length, q[2] / length, q[3] / length)

    def get(self, register: int, length: int) -> bytes:
        map_ = bytearray(0x80)
        map_[0x00:0x04] = bytes([self.chip_id, 0xFB, 0x32, 0x0F])
        map_[0x07] = self.page
        if self.mode == NDOF:
            per_degree = 900 * math.pi / 180 if self.units & 0x04 else 16
            per_rate = 900 * math.pi / 180 if self.units & 0x02 else 16
            values = (
                *(round(-self.yaw_rate_deg_s * axis[2] * per_rate) for axis in self.in_the_world()),
                *(round(angle * per_degree) for angle in self._angles_deg()),
                *(round(one * 2**14) for one in self._quaternion()),
            )
            map_[0x14:0x28] = struct.pack("<10h", *values)
            map_[0x35] = 0xFC | self.magnet
        if self.mode == CONFIG:  # 3.11.4
            map_[0x55:0x6B] = self.profile
        map_[0x3B], map_[0x3D], map_[0x3E] = self.units, self.mode, self.power
        map_[0x41:0x43] = self.axes
        read = bytes(one ^ flip for one, flip in zip(map_, self.flips, strict=True))
        return read[register : register + length]

    def put(self, register: int, data: bytes) -> None:
        for offset, value in enumerate(data):
            self._put(register + offset, value)
        if register == 0x55 and self.mode == CONFIG:
            self.profile = data

    def _put(self, register: int, value: int) -> None:
        match register:
            case 0x07:
                self.page = value
            case 0x3B if self.mode == CONFIG:
                self.units = value
            case 0x3D:
                self.mode = value & 0x0F
            case 0x3E if self.mode == CONFIG:
                self.power = value
            case 0x41 | 0x42 if self.mode == CONFIG:
                self.axes[register - 0x41] = value


class I2cDev:
    """The kernel's side of /dev/i2c-1: parts by their address, and one address for each open file."""

    def __init__(self, parts: dict[int, Part]) -> None:
        self.parts = parts
        self._address: dict[int, int] = {}

    def ioctl(self, fd: int, request: int, argument: Any) -> int:  # noqa: ANN401 — structures of ctypes
        """What smbus2 calls."""
        if request == I2C_FUNCS:
            argument.value = 0x0EFF0009
        elif request == I2C_SLAVE:
            self._address[fd] = argument
        elif request == I2C_SMBUS:
            assert argument.size == I2C_SMBUS_I2C_BLOCK_DATA
            part = self.parts.get(self._address[fd])
            if part is None:
                raise OSError(errno.EREMOTEIO, "Remote I/O error")
            block = argument.data.contents.block
            if argument.read_write == I2C_SMBUS_READ:
                data = part.get(argument.command, block[0])
                ctypes.memmove(ctypes.addressof(block) + 1, data, len(data))
            else:
                part.put(argument.command, bytes(block[1 : 1 + block[0]]))
        else:
            raise OSError(errno.ENOTTY, "Inappropriate ioctl for device")
        return 0


def plug_in(monkeypatch: "pytest.MonkeyPatch", tmp_path: Path, parts: dict[int, Part]) -> I2cDev:
    """Put parts on the bus that the drivers open."""
    bus = I2cDev(parts)
    (tmp_path / "dev").mkdir(exist_ok=True)
    for number in (1, 3):
        (tmp_path / "dev" / f"i2c-{number}").touch()
    monkeypatch.setattr("smbus2.smbus2.ioctl", bus.ioctl)
    monkeypatch.setattr("companion.hal.raspberry_pi.ROOT", tmp_path)
    return bus
