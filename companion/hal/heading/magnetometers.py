"""Magnetometers on I²C, in their board axes.

QMC5883L: QST 13-52-04, revision 1.0, February 2016. QMC5883P: QST 13-52-19, revision C. HMC5883L: Honeywell
900405, revision E, February 2013. LIS3MDL: ST DocID024204, revision 6, May 2017. IST8310, IST8308: registers
and scales of PX4 (src/drivers/magnetometer/isentek) and ArduPilot (AP_Compass_IST8310, AP_Compass_IST8308).
RM3100: PNI 1017252, r04. AK09916: InvenSense DS-000189, revision 1.3, sections 12 and 13. All measure in a
range of several gauss, as steel near the compass can be stronger than the earth's half gauss.
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
    ADDRESSES = (0x0D,)
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
    ADDRESSES = (0x2C,)
    ID_AT, IDS = 0x00, (0x80,)
    # The signs of the axes come first, as in the data sheet's example (7.1). Control 2: ±8 G, set and reset
    # on; control 1 (9.2.4): oversampling 8 and 8, 50 Hz, normal mode
    SET_UP = ((0x29, 0x06), (0x0B, 0x08), (0x0A, 0xC0 | 0x04 | 0x01))
    MG = 1000.0 / 3750.0  # table 2, ±8 G
    _DATA_AT, _STATUS_AT = 0x01, 0x09


class Hmc5883l(Magnetometer):
    """The registers of its field are in the order x, z, y."""

    name = "HMC5883L"
    ADDRESSES = (0x1E,)
    SET_UP = ((0x00, 0x78, 0x40, 0x00),)  # A: mean of 8, 75 Hz; B: ±1.9 G; mode: continuous (tables 3 to 12)
    MG: Final = 1000.0 / 820.0  # table 9, gain 2
    ID_AT, ID_BYTES, IDS = 0x0A, 3, (0x483433,)  # "H43"
    _DATA_AT, _STATUS_AT = 0x03, 0x09
    _READY: Final = 0x01
    _OVERFLOW: Final = -4096

    def read(self) -> Vector | None:
        (status,) = self._registers.read(self._STATUS_AT, 1)
        if not status & self._READY:
            return None
        x, z, y = _BIG.unpack(self._registers.read(self._DATA_AT, _BIG.size))
        if self._OVERFLOW in (x, y, z):
            return None
        return x * self.MG, y * self.MG, z * self.MG


class _Unflagged(Magnetometer):
    """A part without an overflow flag: a field out of range has counts beyond the limit. One read gets status
    and data, which belong together.
    """

    MG: float
    _STATUS_AT: int
    _READY = 0x01
    _LIMIT: int
    _PORT = 1.0  # −1: its y axis points to starboard

    def read(self) -> Vector | None:
        data = self._registers.read(self._STATUS_AT, 1 + _LITTLE.size)
        x, y, z = _LITTLE.unpack_from(data, 1)
        if not data[0] & self._READY or max(abs(x), abs(y), abs(z)) > self._LIMIT:
            return None
        return x * self.MG, self._PORT * y * self.MG, z * self.MG


class Lis3mdl(_Unflagged):
    """A field out of range stays at its limit."""

    name = "LIS3MDL"
    ADDRESSES = (0x1C, 0x1E)  # the second where its SDO/SA1 pin is high
    ID_AT, IDS = 0x0F, (0x3D,)
    _FURTHER: Final = 0x80  # bit of a register address: go on to the next one (5.1.1)
    # CTRL_REG1 to 5: ultra-high performance, 80 Hz; ±8 G; continuous; z the same; block data update
    SET_UP = ((0x20 | _FURTHER, 0x7C, 0x20, 0x00, 0x0C, 0x40),)
    MG = 1000.0 / 3421.0  # table 3, ±8 G
    _STATUS_AT, _READY, _LIMIT = 0x27 | _FURTHER, 0x08, 0x7FFE


class Ist8310(_Unflagged):
    """It measures once when told to. After a supply dip it would with its power-up settings, so its
    resolution is checked before each measurement.
    """

    name = "IST8310"
    ADDRESSES = (0x0E, 0x0C, 0x0D, 0x0F)  # by its pins
    ID_AT, IDS = 0x00, (0x10,)
    _MEASURE: Final = (0x0A, 0x01)  # CNTL1: takes 6 ms with 16 averages
    _CNTL3_AT, _16_BITS = 0x0D, 0x70  # in all axes
    # AVGCNTL: mean of 16; PDCNTL: normal set and reset pulse
    SET_UP = ((0x41, 0x24), (0x42, 0xC0), (_CNTL3_AT, _16_BITS), _MEASURE)
    MG = 1000.0 / 1320.0  # with 16 bits (PX4)
    _STATUS_AT, _LIMIT, _PORT = 0x02, 21120, -1.0  # 16 G, its range in x and y (ArduPilot)

    def read(self) -> Vector | None:
        field = super().read()
        (resolution,) = self._registers.read(self._CNTL3_AT, 1)
        if resolution & self._16_BITS != self._16_BITS:
            return None
        self._registers.write(*self._MEASURE)
        return field


class Ist8308(_Unflagged):
    """Its address is that of an AK09916, too."""

    name = "IST8308"
    ADDRESSES = (0x0C,)
    ID_AT, IDS = 0x00, (0x08,)
    # ACTR: not suspended; CNTL4: ±5 G; OSRCNTL: oversampling 16; CNTL2: continuous, 100 Hz
    SET_UP = ((0x20, 0x00), (0x34, 0x00), (0x41, 0x24), (0x31, 0x08))
    MG = 10.0 / 6.6  # ±5 G (ArduPilot)
    _STATUS_AT, _LIMIT, _PORT = 0x10, 3300, -1.0


class Rm3100(Magnetometer):
    """Its resolution and gain follow from the number of cycles that it counts."""

    name = "RM3100"
    ADDRESSES = (0x20, 0x21, 0x22, 0x23)  # by its pins
    ID_AT, IDS = 0x36, (0x22,)
    # CMM: stopped, or TMRC does not change (Linux); 200 cycles an axis; TMRC: 75 Hz (table 5-4); CMM: go on
    # measuring, ready with all axes
    SET_UP = ((0x01, 0x00), (0x04, 0, 200, 0, 200, 0, 200), (0x0B, 0x95), (0x01, 0x71))
    MG: Final = 10.0 / 75.0  # with 200 cycles (ArduPilot)
    _LIMIT: Final = 60000  # 8 G, its range (PX4)
    _DATA_AT, _STATUS_AT = 0x24, 0x34
    _READY: Final = 0x80

    def read(self) -> Vector | None:
        (status,) = self._registers.read(self._STATUS_AT, 1)
        if not status & self._READY:
            return None
        data = self._registers.read(self._DATA_AT, 9)
        x, y, z = (int.from_bytes(data[at : at + 3], "big", signed=True) for at in (0, 3, 6))
        if max(abs(x), abs(y), abs(z)) > self._LIMIT:
            return None
        return x * self.MG, -y * self.MG, -z * self.MG  # z points down


class Ak09916(Magnetometer):
    """Alone, or in an ICM-20948, which must connect it through."""

    name = "AK09916"
    ADDRESSES = (0x0C,)
    ID_AT, ID_BYTES, IDS = 0x00, 2, (0x4809,)  # of the maker and of the part
    SET_UP = ((0x31, 0x00), (0x31, 0x08))  # CNTL2: power-down between modes; continuous, 100 Hz
    PAUSE_S = 0.001  # 0.1 ms between modes; Adafruit waits for 1 ms
    MG: Final = 1.5
    _STATUS_AT: Final = 0x10
    _READY, _OVERFLOW = 0x01, 0x08
    _DATA: Final = struct.Struct("<B3hxB")  # ST1, field, ST2: only after its reading the field changes again

    def read(self) -> Vector | None:
        data = self._registers.read(self._STATUS_AT, self._DATA.size)
        status, x, y, z, further = self._DATA.unpack(data)
        if not status & self._READY or further & self._OVERFLOW:
            return None
        return x * self.MG, -y * self.MG, -z * self.MG  # z points down


MAGNETOMETERS: Final[dict[str, type[Magnetometer]]] = {
    "qmc5883l": Qmc5883l,
    "qmc5883p": Qmc5883p,
    "hmc5883l": Hmc5883l,
    "lis3mdl": Lis3mdl,
    "ist8310": Ist8310,
    "ist8308": Ist8308,
    "rm3100": Rm3100,
    "ak09916": Ak09916,
}
