"""Gyros with accelerometers on I²C, in their board axes.

MPU-6050: InvenSense PS-MPU-6000A-00 and RM-MPU-6000A-00, revisions 3.4 and 4.2, August 2013. MPU-6500
(RM-MPU-6500A-00), MPU-9250 and their successors have the same registers, and one more for the filter of the
accelerometer. LSM6DS3, LSM6DSO and LSM6DSOX: ST DocID026899 revision 10 and DS12814 revision 3. ICM-20948:
InvenSense DS-000189, revision 1.3.
"""

import math
import struct
from typing import Final

from companion.core.vectors import Vector, length
from companion.hal.heading.chips import InertialSensor, Motion
from companion.sensors.compass.attitude import GRAVITY_M_S2


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
    ADDRESSES = (0x68, 0x69)  # the second where its AD0 pin is high
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
    ADDRESSES = (0x6A, 0x6B)  # the second where its SA0 pin is high
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


class Icm20948(InertialSensor):
    """Registers in banks: a read selects bank 0, set-up leaves bank 2. Its AK09916 is connected through."""

    name = "ICM-20948"
    ADDRESSES = (0x69, 0x68)  # the second where its AD0 pin is low
    ID_AT, IDS = 0x00, (0xEA,)
    _BANK_0, _BANK_2 = (0x7F, 0x00), (0x7F, 0x20)
    SET_UP = (
        (0x06, 0x01, 0x00),  # PWR_MGMT_1 and 2: awake, best clock; gyro and accelerometer on
        (0x03, 0x00),  # USER_CTRL: no bus master of its own, or bypass does not work
        (0x0F, 0x02),  # INT_PIN_CFG: bypass
        _BANK_2,
        (0x00, 10, 0x1B),  # GYRO_SMPLRT_DIV, GYRO_CONFIG_1: 1125 Hz / 11; low-pass 51 Hz, ±500 °/s
        (0x10, 0, 10),  # ACCEL_SMPLRT_DIV: the same rate
        (0x14, 0x1B),  # ACCEL_CONFIG: low-pass 50 Hz, ±4 g
    )
    PAUSE_S = 0.005  # it wakes up within (ArduPilot)
    RATE: Final = math.radians(1.0 / 65.5)  # ±500 °/s (SparkFun)
    FORCE: Final = GRAVITY_M_S2 / 8192.0  # ±4 g (SparkFun)
    _STATUS_AT, _DATA_AT = 0x1A, 0x2D
    _READY: Final = 0x01
    _DATA: Final = struct.Struct(">6h")  # accelerometer, gyro

    def identify(self) -> str:
        """The number is in bank 0."""
        self._registers.write(*self._BANK_0)
        return super().identify()

    def read(self) -> Motion | None:
        self._registers.write(*self._BANK_0)
        (status,) = self._registers.read(self._STATUS_AT, 1)
        if not status & self._READY:
            return None
        values = self._DATA.unpack(self._registers.read(self._DATA_AT, self._DATA.size))
        return Motion(_scaled(values[3:], self.RATE), _scaled(values[:3], self.FORCE))


INERTIAL: Final[dict[str, type[InertialSensor]]] = {
    "mpu6050": Mpu6050,
    "lsm6ds": Lsm6ds,
    "icm20948": Icm20948,
}
