"""Magnetometers, and gyros with accelerometers, on I²C, in their board axes.

QMC5883L: QST 13-52-04, revision 1.0, February 2016. QMC5883P: QST 13-52-19, revision C. HMC5883L: Honeywell
900405, revision E, February 2013. LIS3MDL: ST DocID024204, revision 6, May 2017. All measure continuously in
a range of several gauss, as steel near the compass can be stronger than the earth's half gauss. MPU-6050:
InvenSense PS-MPU-6000A-00 and RM-MPU-6000A-00, revisions 3.4 and 4.2, August 2013. MPU-6500
(RM-MPU-6500A-00), MPU-9250 and their successors have the same registers, and one more for the filter of the
accelerometer. LSM6DS3, LSM6DSO and LSM6DSOX: ST DocID026899 revision 10 and DS12814 revision 3.

After a supply dip a part is back in its power-up state and does not measure. The driver of the compass then
sets it up again.
"""

import math
import struct
import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Final, Generic, NamedTuple, TypeVar

from companion.core.vectors import Vector, length
from companion.hal.raspberry_pi import I2cBus, Registers
from companion.sensors.compass.attitude import GRAVITY_M_S2

Sample_co = TypeVar("Sample_co", covariant=True)


class Motion(NamedTuple):
    """A sample of gyro and accelerometer in board axes: rate in rad/s, specific force in m/s²."""

    rate: Vector
    force: Vector


class Chip(ABC, Generic[Sample_co]):
    """A part at one bus address, whose samples are in board axes. Every call raises OSError if it does not
    answer.

    ID_AT, IDS: the register of its number, and the numbers of the parts that it may be. SET_UP: what makes it
    measure, as registers with the bytes to write from there on.
    """

    name: str
    ADDRESS: int
    ID_AT: int
    IDS: tuple[int, ...]
    SET_UP: tuple[tuple[int, ...], ...]

    def __init__(self, bus: I2cBus, address: int = 0, wait: Callable[[float], None] = time.sleep) -> None:
        self.address = address or self.ADDRESS
        self._registers = Registers(bus, self.address)
        self._wait = wait

    def identify(self) -> str:
        """What answers instead of the part; empty if it is the part."""
        (found,) = self._registers.read(self.ID_AT, 1)
        return "" if found in self.IDS else f"{found:#x}, not {self.IDS[0]:#x}"

    def set_up(self) -> None:
        """Write `SET_UP`: the part begins to measure."""
        for register, *values in self.SET_UP:
            self._registers.write(register, *values)

    @abstractmethod
    def read(self) -> Sample_co | None:
        """A new sample, a field in mG or `Motion`; None without a new one, or one out of range."""


Magnetometer = Chip[Vector]
InertialSensor = Chip[Motion]


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


def _scaled(values: tuple[int, ...], factor: float) -> Vector:
    x, y, z = values
    return x * factor, y * factor, z * factor


class Mpu6050(InertialSensor):
    """MPU-6050, its successors and their clones. Its auxiliary bus is connected through: boards such as the
    GY-87 have their magnetometer there.

    Boards sold as MPU-6050 carry many numbers. One that is not among `IDS` is taken if it keeps its settings
    and its accelerometer measures gravity.
    """

    name = "MPU-6050"
    ADDRESS = 0x68  # 0x69 where its AD0 pin is high
    ID_AT = 0x75
    # MPU-6050; ICM-20602; MPU-6500, -9250, -9255, -6515; ICM-20689, -20601, -20608
    IDS = (0x68, 0x12, 0x70, 0x71, 0x73, 0x74, 0x98, 0xAC, 0xAF)
    RATE: Final = math.radians(1.0 / 65.5)  # ±500 °/s (6.1)
    FORCE: Final = GRAVITY_M_S2 / 8192.0  # ±4 g (6.2)
    # From SMPLRT_DIV: 1 kHz / 10; low-pass 44 Hz, against motors and propellers; ±500 °/s; ±4 g
    _SETTINGS: Final = (0x19, 9, 0x03, 0x08, 0x08)
    SET_UP = ((0x6B, 0x01), _SETTINGS)  # power: awake, clocked by its gyro
    _FORCE_FILTER: Final = (0x1D, 0x03)  # ACCEL_CONFIG 2: 45 Hz; the MPU-6050 has one filter for both
    _CONNECT: Final = ((0x6A, 0x00), (0x37, 0x02, 0x01))  # USER_CTRL; bypass, and INT_ENABLE: data ready
    _STATUS_AT: Final = 0x3A
    _READY: Final = 0x01
    _DATA: Final = struct.Struct(">3hh3h")  # ACCEL, TEMP, GYRO
    _NO_PART: Final = (0x00, 0xFF)  # a bus that is held low, or on which nobody speaks
    _STARTS_S: Final = 0.1  # from sleep to valid data
    _UNEVEN: Final = 0.2  # share of gravity: offset and scale of a poor part, and a boat in hand
    _id = IDS[0]

    def identify(self) -> str:
        """An unknown number is tried by measuring gravity."""
        (self._id,) = self._registers.read(self.ID_AT, 1)
        if self._id in self.IDS or (self._id not in self._NO_PART and self._works()):
            return ""
        return f"{self._id:#x}, not {self.IDS[0]:#x}, and measures no gravity"

    def set_up(self) -> None:
        """Start measuring, and connect the auxiliary bus through."""
        super().set_up()
        if self._id != self.IDS[0]:
            self._registers.write(*self._FORCE_FILTER)
        for register, *values in self._CONNECT:
            self._registers.write(register, *values)

    def _works(self) -> bool:
        """Whether it keeps its settings and measures gravity."""
        self.set_up()
        self._wait(self._STARTS_S)
        motion = self.read()
        at, *settings = self._SETTINGS
        return (
            self._registers.read(at, len(settings)) == bytes(settings)
            and motion is not None
            and abs(length(motion.force) / GRAVITY_M_S2 - 1.0) < self._UNEVEN
        )

    def read(self) -> Motion | None:
        data = self._registers.read(self._STATUS_AT, 1 + self._DATA.size)  # the data follow the status
        if not data[0] & self._READY:
            return None
        values = self._DATA.unpack_from(data, 1)
        return Motion(_scaled(values[4:], self.RATE), _scaled(values[:3], self.FORCE))


class Lsm6ds(InertialSensor):
    """LSM6DS3, LSM6DS3TR-C, LSM6DSL, LSM6DSO, LSM6DSOX, LSM6DSR, ISM330DHCX."""

    name = "LSM6DS"
    ADDRESS = 0x6A  # 0x6B where its SA0 pin is high
    ID_AT = 0x0F
    IDS = (0x69, 0x6A, 0x6B, 0x6C)  # LSM6DS3; DS3TR-C and DSL; DSR and ISM330DHCX; DSO and DSOX
    # CTRL1_XL to CTRL3_C: 104 Hz, ±4 g; 104 Hz, ±500 °/s; block data update, address increment
    SET_UP = ((0x10, 0x48, 0x44, 0x44),)
    RATE: Final = math.radians(17.5e-3)  # ±500 °/s
    FORCE: Final = 0.122e-3 * GRAVITY_M_S2  # ±4 g
    _STATUS_AT, _DATA_AT = 0x1E, 0x22
    _READY: Final = 0x03  # both
    _DATA: Final = struct.Struct("<6h")  # gyro, accelerometer

    def read(self) -> Motion | None:
        (status,) = self._registers.read(self._STATUS_AT, 1)
        if status & self._READY != self._READY:
            return None
        values = self._DATA.unpack(self._registers.read(self._DATA_AT, self._DATA.size))
        return Motion(_scaled(values[:3], self.RATE), _scaled(values[3:], self.FORCE))
