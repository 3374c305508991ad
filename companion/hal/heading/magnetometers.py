"""Magnetometers on I²C, in their board axes.

QMC5883L: QST 13-52-04, revision 1.0, February 2016. QMC5883P: QST 13-52-19, revision C. HMC5883L: Honeywell
900405, revision E, February 2013. LIS3MDL: ST DocID024204, revision 6, May 2017. All measure continuously in
a range of several gauss, as steel near the compass can be stronger than the earth's half gauss.

After a supply dip a part is back in its power-up state and does not measure. The driver of the compass then
sets it up again.
"""

import struct
import time
from collections.abc import Callable
from typing import Final

from companion.core.vectors import Vector
from companion.hal.heading.registers import Registers
from companion.hal.raspberry_pi import I2cBus

_TRIES: Final = 3  # of an identification: other parts on the bus disturb the first
_RESET_S: Final = 0.1  # a QMC5883L answers wrongly for a while after its reset
_LITTLE: Final = struct.Struct("<3h")
_BIG: Final = struct.Struct(">3h")


class _Qst:
    """What the two parts of QST share."""

    ADDRESS: int
    MG: float
    _ID_AT: int
    _ID: int
    _DATA_AT: int
    _STATUS_AT: int
    _READY, _OVERFLOW = 0x01, 0x02  # reading clears the first: of the QMC5883L its data, of the P its status

    def __init__(self, bus: I2cBus, address: int = 0, wait: Callable[[float], None] = time.sleep) -> None:
        self.address = address or self.ADDRESS
        self._registers = Registers(bus, self.address)
        self._wait = wait

    def identify(self) -> str:
        """What answers instead. The number is right only after register 0 has been read."""
        found = -1
        for _ in range(_TRIES):
            self._registers.read(0x00, 1)
            (found,) = self._registers.read(self._ID_AT, 1)
            if found == self._ID:
                return ""
        return f"{found:#x}, not {self._ID:#x}"

    def read(self) -> Vector | None:
        """A new field."""
        (status,) = self._registers.read(self._STATUS_AT, 1)
        if not status & self._READY:
            return None
        x, y, z = _LITTLE.unpack(self._registers.read(self._DATA_AT, _LITTLE.size))
        if status & self._OVERFLOW:
            return None
        return x * self.MG, y * self.MG, z * self.MG


class Qmc5883l(_Qst):
    """QMC5883L. Boards sold as HMC5883L mostly carry this part, at its own address."""

    name = "QMC5883L"
    ADDRESS = 0x0D
    # Control 1 (9.2.4): oversampling 512, ±8 G, 50 Hz, continuous
    CONTROL: Final = 0x00 | 0x10 | 0x04 | 0x01
    MG = 1000.0 / 3000.0  # table 2, ±8 G
    _DATA_AT, _CONTROL_1_AT, _CONTROL_2_AT, _PERIOD_AT, _ID_AT = 0x00, 0x09, 0x0A, 0x0B, 0x0D
    _ID = 0xFF
    _RESET: Final = 0x80
    _STATUS_AT = 0x06

    def identify(self) -> str:
        """What answers instead. The part is reset."""
        if not (found := super().identify()):
            self._registers.write(self._CONTROL_2_AT, self._RESET)
            self._wait(_RESET_S)
        return found

    def set_up(self) -> None:
        """Start measuring."""
        self._registers.write(self._PERIOD_AT, 0x01)  # recommended (9.2.6)
        self._registers.write(self._CONTROL_1_AT, self.CONTROL)


class Qmc5883p(_Qst):
    """QMC5883P, the successor: another address and other registers, though boards may not say which it is."""

    name = "QMC5883P"
    ADDRESS = 0x2C
    # Control 1 (9.2.4): oversampling 8 and 8, 50 Hz, normal mode; control 2: ±8 G, set and reset on
    CONTROL: Final = (0xC0 | 0x04 | 0x01, 0x08)
    MG = 1000.0 / 3750.0  # table 2, ±8 G
    _ID_AT, _DATA_AT, _STATUS_AT, _CONTROL_1_AT, _CONTROL_2_AT, _SIGN_AT = 0x00, 0x01, 0x09, 0x0A, 0x0B, 0x29
    _ID = 0x80

    def set_up(self) -> None:
        """Start measuring. The signs of the axes come first, as in the data sheet's example (7.1)."""
        control_1, control_2 = self.CONTROL
        self._registers.write(self._SIGN_AT, 0x06)
        self._registers.write(self._CONTROL_2_AT, control_2)
        self._registers.write(self._CONTROL_1_AT, control_1)


class Hmc5883l:
    """HMC5883L."""

    name = "HMC5883L"
    ADDRESS: Final = 0x1E
    SET_UP: Final = (0x78, 0x40, 0x00)  # A: mean of 8, 75 Hz; B: ±1.9 G; mode: continuous (tables 3 to 12)
    MG: Final = 1000.0 / 820.0  # table 9, gain 2
    _DATA_AT, _STATUS_AT, _ID_AT = 0x03, 0x09, 0x0A
    _ID: Final = b"H43"
    _READY: Final = 0x01
    _OVERFLOW: Final = -4096

    def __init__(self, bus: I2cBus, address: int = 0) -> None:
        self.address = address or self.ADDRESS
        self._registers = Registers(bus, self.address)

    def identify(self) -> str:
        """What answers instead."""
        found = self._registers.read(self._ID_AT, len(self._ID))
        return "" if found == self._ID else f"{found!r}, not {self._ID!r}"

    def set_up(self) -> None:
        """Start measuring."""
        self._registers.write(0x00, *self.SET_UP)

    def read(self) -> Vector | None:
        """A new field. The registers are in the order x, z, y."""
        (status,) = self._registers.read(self._STATUS_AT, 1)
        if not status & self._READY:
            return None
        x, z, y = _BIG.unpack(self._registers.read(self._DATA_AT, _BIG.size))
        if self._OVERFLOW in (x, y, z):
            return None
        return x * self.MG, y * self.MG, z * self.MG


class Lis3mdl:
    """LIS3MDL."""

    name = "LIS3MDL"
    ADDRESS: Final = 0x1C  # 0x1E where its SDO/SA1 pin is high
    # CTRL_REG1 to 5: ultra-high performance, 80 Hz; ±8 G; continuous; z the same; block data update
    SET_UP: Final = (0x7C, 0x20, 0x00, 0x0C, 0x40)
    MG: Final = 1000.0 / 3421.0  # table 3, ±8 G
    _ID_AT, _CONTROL_AT, _STATUS_AT = 0x0F, 0x20, 0x27
    _ID: Final = 0x3D
    _FURTHER: Final = 0x80  # bit of a register address: go on to the next one (5.1.1)
    _READY: Final = 0x08
    _LIMIT: Final = 0x7FFF  # the part has no overflow flag: it stays at its limit

    def __init__(self, bus: I2cBus, address: int = 0) -> None:
        self.address = address or self.ADDRESS
        self._registers = Registers(bus, self.address)

    def identify(self) -> str:
        """What answers instead."""
        (found,) = self._registers.read(self._ID_AT, 1)
        return "" if found == self._ID else f"{found:#x}, not {self._ID:#x}"

    def set_up(self) -> None:
        """Start measuring."""
        self._registers.write(self._CONTROL_AT | self._FURTHER, *self.SET_UP)

    def read(self) -> Vector | None:
        """A new field."""
        data = self._registers.read(self._STATUS_AT | self._FURTHER, 1 + _LITTLE.size)
        x, y, z = _LITTLE.unpack_from(data, 1)
        if not data[0] & self._READY or max(abs(x), abs(y), abs(z)) >= self._LIMIT:
            return None
        return x * self.MG, y * self.MG, z * self.MG
