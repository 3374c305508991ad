"""BNO055 compass on I²C, from its data sheet (Bosch BST-BNO055-DS000-14, June 2016).

The part fuses accelerometer, magnetometer and gyroscope in NDOF mode and calibrates itself. It loses its
calibration with its supply. So the boat reads the profile (3.11.4) once it is good, keeps it in a file, and
writes it back. The part is not reset at program start.

The attitude comes from the quaternion, which turns the part's axes into east, north, up. The Euler angles are
of the part's y axis, in Android's signs (data sheet BMM150, 9.1), and are distorted above 20° of tilt in
firmware 0x0311.
"""

import logging
import math
import struct
from collections.abc import Callable
from typing import Final, NamedTuple

from companion.config.sensors import CompassPart, Mounting
from companion.core.errors import HardwareError
from companion.core.generations import ProfileFile
from companion.core.readings import HeadingReading
from companion.core.status_text import Severity
from companion.core.vectors import Vector
from companion.hal.background import BackgroundSensor
from companion.hal.heading.orientation import Quaternion, board_to_body, heading_reading
from companion.hal.raspberry_pi import I2cBus, Registers, open_i2c_part

ADDRESSES: Final = (0x28, 0x29)  # the second where its COM3 pin is high
CHIP_ID: Final = 0xA0
CONFIG_MODE, NDOF_MODE = 0x00, 0x0C  # table 3-5
UNITS: Final = 0x80  # table 3-11: degrees, degrees per second, Android's signs; the reset default
AXES: Final = bytes((0x24, 0x00))  # 3.4: the part's own axes (P1), map and signs; the reset default
_CHIP_ID_AT, _PAGE_AT, _DATA_AT, _STATUS_AT = 0x00, 0x07, 0x14, 0x35
_UNITS_AT, _MODE_AT, _POWER_AT, _AXES_AT = 0x3B, 0x3D, 0x3E, 0x41
_DATA: Final = struct.Struct("<3h6x4h")  # GYR_DATA; the Euler angles; QUA_Data w, x, y, z
_PROFILE_AT, PROFILE_BYTES = 0x55, 22  # offsets and radii; legible in CONFIG mode only
_STATUS_BYTES: Final = _AXES_AT + len(AXES) - _STATUS_AT  # CALIB_STAT to AXIS_MAP_SIGN
_RATE: Final = math.radians(1.0 / 16.0)  # table 3-22
_ONE: Final = 2.0**14  # of a quaternion (table 3-31)
_UNIT: Final = 0.01  # error of its length in a sound transfer: a hundred times its resolution
_MODE_BITS: Final = 0x0F
_PERIOD_S: Final = 0.04
_CALIBRATED: Final = 3
_GOOD_SAMPLES: Final = 250  # ten seconds
_USUAL: Final = Mounting()

_log = logging.getLogger(__name__)


class Bno055Sample(NamedTuple):
    """One reading.

    quaternion: x, y, z, w; turns the part's axes into east, north, up. rate: rad/s in the part's axes.
    magnet, gyro: their calibration status, 0..3.
    """

    quaternion: Quaternion
    rate: Vector
    magnet: int
    gyro: int


class Bno055:
    """Registers of the part at one bus address. Calls do not wait; it needs 20 ms between two."""

    def __init__(self, bus: I2cBus, address: int = ADDRESSES[0]) -> None:
        """Raises HardwareError: another part answers."""
        self.bus = bus
        self._registers = Registers(bus, address)
        (found,) = self._registers.read(_CHIP_ID_AT, 1)
        if found != CHIP_ID:
            raise HardwareError(
                f"BNO055: the part at I²C address {address:#x} says {found:#x}, not {CHIP_ID:#x}"
            )

    def read(self) -> Bno055Sample | None:
        """The present reading; None before it is set up. Raises OSError: it does not answer."""
        p, q, r, w, x, y, z = _DATA.unpack(self._registers.read(_DATA_AT, _DATA.size))
        status = self._registers.read(_STATUS_AT, _STATUS_BYTES)  # read after the data
        is_set_up = status[_MODE_AT - _STATUS_AT] & _MODE_BITS == NDOF_MODE
        if (
            not is_set_up
            or status[_UNITS_AT - _STATUS_AT] != UNITS
            or status[_AXES_AT - _STATUS_AT :] != AXES
        ):
            return None
        return Bno055Sample(
            (x / _ONE, y / _ONE, z / _ONE, w / _ONE),
            (p * _RATE, q * _RATE, r * _RATE),
            status[0] & 0x03,
            status[0] >> 4 & 0x03,
        )

    def set_up(self, profile: bytes = b"") -> None:
        """Start measuring, with a calibration profile. From another mode it takes two calls: units, axes and
        profile can only change in CONFIG mode. Raises OSError: it does not answer.
        """
        (mode,) = self._registers.read(_MODE_AT, 1)
        if mode & _MODE_BITS != CONFIG_MODE:
            self.stop()
            return
        self._registers.write(_PAGE_AT, 0)
        if len(profile) == PROFILE_BYTES:
            self._registers.write(_PROFILE_AT, *profile)
        self._registers.write(_POWER_AT, 0)  # normal power
        self._registers.write(_UNITS_AT, UNITS)
        self._registers.write(_AXES_AT, *AXES)
        self._registers.write(_MODE_AT, NDOF_MODE)  # it takes 7 ms

    def stop(self) -> None:
        """Go to CONFIG mode, which takes 19 ms (table 3-6). Raises OSError."""
        self._registers.write(_MODE_AT, CONFIG_MODE)

    def read_profile(self) -> bytes:
        """The calibration profile, in CONFIG mode. Raises OSError."""
        return self._registers.read(_PROFILE_AT, PROFILE_BYTES)


class Bno055Compass(BackgroundSensor[HeadingReading]):
    """Satisfies `companion.hal.interfaces.Compass`.

    mounting: of the board, from flat with its x arrow to the bow. Its north is magnetic; correction_rad is
    added. Headings are used only after the magnetometer has been calibrated since power-up: before, they
    start at zero in any direction.

    may_pause: reading and saving the profile may cost three readings now; the boat sets it.
    """

    def __init__(
        self,
        part: Bno055,
        now: Callable[[], float],
        correction_rad: float = 0.0,
        profile: ProfileFile | None = None,
        mounting: Mounting = _USUAL,
    ) -> None:
        super().__init__(self.step, "BNO055", now, part.bus.close)
        self.may_pause = False
        self._part = part
        self._correction_rad = correction_rad
        self._axes = board_to_body(mounting)
        self._knows_north = False
        self._file = profile
        self._profile = b"" if profile is None else profile.load()
        self._is_saving = False
        self._has_saved = profile is None
        self._good = 0  # samples in a row with a good calibration

    def step(self) -> float:
        """Read the part once; returns the seconds to wait before the next reading."""
        time_s = self._now()  # a transfer takes 30 ms at 10 kHz
        sample = self._part.read()
        if sample is None:
            if self._is_saving:
                self._save()
            else:  # a supply dip has reset the part to configuration mode
                if self._knows_north:
                    self.notify(Severity.WARNING, "Compass: BNO055 was reset: it must find north again")
                self._knows_north, self._has_saved, self._good = False, self._file is None, 0
            self._part.set_up(self._profile)
            return _PERIOD_S
        self._good = self._good + 1 if sample.magnet == sample.gyro == _CALIBRATED else 0
        if self._good >= _GOOD_SAMPLES and not self._has_saved and self.may_pause:
            self._has_saved = self._is_saving = True
            self._part.stop()
        if not self._knows_north:
            self._knows_north = sample.magnet > 0
        elif abs(math.hypot(*sample.quaternion) - 1.0) < _UNIT:  # reject corrupted transfers
            self._latest = heading_reading(
                sample.quaternion, sample.rate, self._axes, self._correction_rad, time_s
            )
        return _PERIOD_S

    def _save(self) -> None:
        self._is_saving = False
        found = self._part.read_profile()
        if self._file is not None and found != self._profile and any(found):
            self._profile = found
            self._file.save(found)
            _log.info("BNO055: its calibration is saved")


def open_bno055(
    part: CompassPart, now: Callable[[], float], profile: ProfileFile | None = None
) -> Bno055Compass:
    """Open the part on its I²C bus and start reading. profile: its calibration.
    Raises HardwareError: smbus2 is missing, there is no bus, or the part does not answer.
    """
    address = part.address or ADDRESSES[0]

    def create(bus: I2cBus) -> Bno055Compass:
        return Bno055Compass(Bno055(bus, address), now, part.correction_rad, profile, part.mounting)

    return open_i2c_part("BNO055", part.i2c_bus, address, create).start()
