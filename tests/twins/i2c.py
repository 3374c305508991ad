"""Twins of the I²C parts, register by register as their data sheets have them, behind Linux's i2c-dev.

smbus2 itself is real: only the system call below it is answered here.
"""

import ctypes
import errno
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


class Bno055Twin:
    """Bosch BST-BNO055-DS000-14: as after power-up, until it is written to.

    It measures in NDOF mode only (angles read as zero otherwise), and takes units in CONFIG mode only.
    """

    def __init__(self, chip_id: int = 0xA0) -> None:
        self.chip_id = chip_id
        self.heading_deg, self.roll_deg, self.pitch_deg = 90.0, 1.0, -2.0
        self.yaw_rate_deg_s = 10.0
        self.magnet = 3
        self.resets = -1
        self.power_up()

    def power_up(self) -> None:
        """As its supply comes on, or after a dip."""
        self.resets += 1
        self.mode, self.units, self.page, self.power = CONFIG, 0x80, 0, 0
        self.profile = bytes(22)

    def get(self, register: int, length: int) -> bytes:
        map_ = bytearray(0x80)
        map_[0x00:0x04] = bytes([self.chip_id, 0xFB, 0x32, 0x0F])
        map_[0x07] = self.page
        if self.mode == NDOF:
            per_degree = 900 * 3.141592653589793 / 180 if self.units & 0x04 else 16
            per_rate = 900 * 3.141592653589793 / 180 if self.units & 0x02 else 16
            values = (
                *(0, 0, round(self.yaw_rate_deg_s * per_rate)),
                *(round(angle * per_degree) for angle in (self.heading_deg, self.roll_deg, self.pitch_deg)),
            )
            map_[0x14:0x20] = struct.pack("<6h", *values)
            map_[0x35] = 0xFC | self.magnet
        if self.mode == CONFIG:  # 3.11.4
            map_[0x55:0x6B] = self.profile
        map_[0x3B], map_[0x3D], map_[0x3E] = self.units, self.mode, self.power
        return bytes(map_[register : register + length])

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
    device = tmp_path / "i2c-1"
    device.touch()
    monkeypatch.setattr("smbus2.smbus2.ioctl", bus.ioctl)
    monkeypatch.setattr("companion.hal.raspberry_pi.DEVICE", device)
    return bus
