"""Magnetometers on I²C, in their board axes.

QMC5883L: QST 13-52-04, revision 1.0, February 2016. QMC5883P: QST 13-52-19, revision C. HMC5883L: Honeywell
900405, revision E, February 2013. LIS3MDL: ST DocID024204, revision 6, May 2017. All measure continuously in
a range of several gauss, as steel near the compass can be stronger than the earth's half gauss.
"""

import struct
from typing import Final

from companion.core.vectors import Vector
from companion.hal.heading.chips import Magnetometer

_TRIES: Final = 3  # of an identification: other parts on the bus disturb the first
_RESET_S: Final = 0.1  # a QMC5883L answers wrongly for a while after its reset
_LITTLE: Final = struct.Struct("<3h")
_BIG: Final = struct.Struct(">3h")


class _Qst(Magnetometer):
    """What the two parts of QST share."""

    MG: float
    _DATA_AT: int
    _STATUS_AT: int
    _READY, _OVERFLOW = 0x01, 0x02  # reading clears the first: of the QMC5883L its data, of the P its status

    def identify(self) -> str:
        """Its number is right only after register 0 has been read."""
        found = ""
        for _ in range(_TRIES):
            self._registers.read(0x00, 1)
            if not (found := super().identify()):
                break
        return found

    def read(self) -> Vector | None:
        (status,) = self._registers.read(self._STATUS_AT, 1)
        if not status & self._READY:
            return None
        x, y, z = _LITTLE.unpack(self._registers.read(self._DATA_AT, _LITTLE.size))
        if status & self._OVERFLOW:
            return None
        return x * self.MG, y * self.MG, z * self.MG


class Qmc5883l(_Qst):
    """Boards sold as HMC5883L mostly carry this part, at its own address."""

    name = "QMC5883L"
    ADDRESS = 0x0D
    ID_AT, IDS = 0x0D, (0xFF,)
    # The period as recommended (9.2.6); control 1 (9.2.4): oversampling 512, ±8 G, 50 Hz, continuous
    SET_UP = ((0x0B, 0x01), (0x09, 0x00 | 0x10 | 0x04 | 0x01))
    MG = 1000.0 / 3000.0  # table 2, ±8 G
    _DATA_AT, _STATUS_AT, _CONTROL_2_AT = 0x00, 0x06, 0x0A
    _RESET: Final = 0x80

    def identify(self) -> str:
        """The part is reset as well."""
        if not (found := super().identify()):
            self._registers.write(self._CONTROL_2_AT, self._RESET)
            self._wait(_RESET_S)
        return found


class Qmc5883p(_Qst):
    """The successor: another address and other registers, though boards may not say which it is."""

    name = "QMC5883P"
    ADDRESS = 0x2C
    ID_AT, IDS = 0x00, (0x80,)
    # The signs of the axes come first, as in the data sheet's example (7.1). Control 2: ±8 G, set and reset
    # on; control 1 (9.2.4): oversampling 8 and 8, 50 Hz, normal mode
    SET_UP = ((0x29, 0x06), (0x0B, 0x08), (0x0A, 0xC0 | 0x04 | 0x01))
    MG = 1000.0 / 3750.0  # table 2, ±8 G
    _DATA_AT, _STATUS_AT = 0x01, 0x09


class Hmc5883l(Magnetometer):
    """The registers of its field are in the order x, z, y."""

    name = "HMC5883L"
    ADDRESS = 0x1E
    SET_UP = ((0x00, 0x78, 0x40, 0x00),)  # A: mean of 8, 75 Hz; B: ±1.9 G; mode: continuous (tables 3 to 12)
    MG: Final = 1000.0 / 820.0  # table 9, gain 2
    _DATA_AT, _STATUS_AT, ID_AT = 0x03, 0x09, 0x0A
    _ID: Final = b"H43"
    _READY: Final = 0x01
    _OVERFLOW: Final = -4096

    def identify(self) -> str:
        """Its number has three letters."""
        found = self._registers.read(self.ID_AT, len(self._ID))
        return "" if found == self._ID else f"{found!r}, not {self._ID!r}"

    def read(self) -> Vector | None:
        (status,) = self._registers.read(self._STATUS_AT, 1)
        if not status & self._READY:
            return None
        x, z, y = _BIG.unpack(self._registers.read(self._DATA_AT, _BIG.size))
        if self._OVERFLOW in (x, y, z):
            return None
        return x * self.MG, y * self.MG, z * self.MG


class Lis3mdl(Magnetometer):
    """It has no overflow flag: a field out of range stays at its limit."""

    name = "LIS3MDL"
    ADDRESS = 0x1C  # 0x1E where its SDO/SA1 pin is high
    ID_AT, IDS = 0x0F, (0x3D,)
    _FURTHER: Final = 0x80  # bit of a register address: go on to the next one (5.1.1)
    # CTRL_REG1 to 5: ultra-high performance, 80 Hz; ±8 G; continuous; z the same; block data update
    SET_UP = ((0x20 | _FURTHER, 0x7C, 0x20, 0x00, 0x0C, 0x40),)
    MG: Final = 1000.0 / 3421.0  # table 3, ±8 G
    _STATUS_AT: Final = 0x27
    _READY: Final = 0x08
    _LIMIT: Final = 0x7FFF

    def read(self) -> Vector | None:
        data = self._registers.read(self._STATUS_AT | self._FURTHER, 1 + _LITTLE.size)
        x, y, z = _LITTLE.unpack_from(data, 1)
        if not data[0] & self._READY or max(abs(x), abs(y), abs(z)) >= self._LIMIT:
            return None
        return x * self.MG, y * self.MG, z * self.MG


MAGNETOMETERS: Final[dict[str, type[Magnetometer]]] = {
    "qmc5883l": Qmc5883l,
    "qmc5883p": Qmc5883p,
    "hmc5883l": Hmc5883l,
    "lis3mdl": Lis3mdl,
}
