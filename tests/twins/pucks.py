"""Twins of the magnetometers of GNSS pucks, by drivers that work on real parts.

IST8310: PX4 (isentek/ist8310) and ArduPilot (AP_Compass_IST8310). IST8308: the same two; its scales also
KitSprout (ist8308.h). RM3100: Linux (iio/magnetometer/rm3100-core.c), PX4 and ArduPilot; PNI 1017252 r04.
AK09916: PX4 (ICM20948_AK09916), ArduPilot and SparkFun; InvenSense DS-000189 revision 1.3.

Their axes, x ahead: PX4 and ArduPilot turn z over of both iSentek parts, whose y points to starboard and z
up, and take those of the RM3100 and AK09916 as they are, to starboard and down.
"""

import errno
import struct
from typing import Final

from twins.inertial import Icm20948Twin
from twins.magnetics import MeasuringTwin, Triple, whole_counts


def _right_handed_down(axes: Triple) -> Triple:
    """From ahead, port, up to ahead, starboard, down."""
    x, y, z = axes
    return x, -y, -z


def _left_handed_up(axes: Triple) -> Triple:
    """From ahead, port, up to ahead, starboard, up."""
    x, y, z = axes
    return x, -y, z


class Ist8310Twin(MeasuringTwin):
    """In stand-by until told to measure once; then back in it. 16 averages take 6 ms (PX4). CNTL3 adds two
    bits to an axis. Both drivers ask for the normal set and reset pulse: without it the twin's field is off.
    """

    address = 0x0E

    def reset(self) -> None:
        self.map[0x00] = 0x10
        self.began_s: float | None = None

    def get(self, register: int, length: int) -> bytes:
        if self.began_s is not None and self.scene.now() - self.began_s >= 0.006:
            self.began_s, self.map[0x0A] = None, 0x00
            (field,) = self.sample((self.scene.field_mg(),))
            per_mg = 1.320 if self.map[0x0D] & 0x70 == 0x70 else 0.330
            off_mg = 0.0 if self.map[0x42] & 0xC0 == 0xC0 else 100.0
            counts = [(one + off_mg) * per_mg for one in _left_handed_up(field)]
            self.map[0x02:0x09] = struct.pack("<B3h", 0x01, *whole_counts(counts))
        data = bytes(self.map[register : register + length])
        if register <= 0x08 and register + length > 0x03:
            self.map[0x02] = 0x00
        return data

    def put(self, register: int, data: bytes) -> None:
        assert len(data) == 1, "no driver writes more than one register at once"
        super().put(register, data)
        self.setups += register == 0x42
        if register == 0x0A and data[0] & 0x0F == 0x01:
            self.began_s = self.scene.now()


class Ist8308Twin(MeasuringTwin):
    """Stand-by after power-up. Its oversampling limits its rate: 16 allow 100 Hz, 32 allow 50 Hz (PX4)."""

    address = 0x0C
    RATES_HZ: Final = {2: 10.0, 4: 20.0, 6: 50.0, 8: 100.0, 10: 200.0, 11: 8.0, 12: 1.0, 13: 0.5}

    def reset(self) -> None:
        self.map[0x00] = 0x08

    def rate_hz(self) -> float:
        is_suspended = bool(self.map[0x20] & 0x02)
        limit_hz = 50.0 if self.map[0x41] & 0x07 == 5 else 100.0
        return 0.0 if is_suspended else min(limit_hz, self.RATES_HZ.get(self.map[0x31] & 0x1F, 0.0))

    def get(self, register: int, length: int) -> bytes:
        if register == 0x10:
            self.map[0x10] = int(self.has_new())
            if self.has_new():
                (field,) = self.sample((self.scene.field_mg(),))
                per_mg = 0.66 if self.map[0x34] & 0x03 == 0 else 1.32
                self.map[0x11:0x17] = struct.pack(
                    "<3h", *whole_counts([one * per_mg for one in _left_handed_up(field)])
                )
        return bytes(self.map[register : register + length])

    def put(self, register: int, data: bytes) -> None:
        assert len(data) == 1, "no driver writes more than one register at once"
        self.setups += register == 0x31
        super().put(register, data)


class Rm3100Twin(MeasuringTwin):
    """Idle after power-up, with 200 cycles (ArduPilot knows it by these). TMRC is not taken while it measures
    (Linux). DRDY goes with the first byte of the results, or with any write (Linux).
    """

    address = 0x20
    RATES_HZ = (600.0, 300.0, 150.0, 75.0, 37.0, 18.0, 9.0, 4.5, 2.3, 1.2, 0.6, 0.3, 0.15, 0.075)
    PER_UT: Final = {50: 20.0, 100: 38.0, 200: 75.0}

    def reset(self) -> None:
        self.map[0x04:0x0A] = struct.pack(">3H", 200, 200, 200)
        self.map[0x0B], self.map[0x36] = 0x96, 0x22

    def rate_hz(self) -> float:
        return self.RATES_HZ[self.map[0x0B] - 0x92] if self.map[0x01] & 0x71 == 0x71 else 0.0

    def get(self, register: int, length: int) -> bytes:
        if register == 0x34:
            return bytes([0x80 if self.has_new() else 0x00])
        if register == 0x24 and self.has_new():
            (field,) = self.sample((self.scene.field_mg(),))
            cycles = struct.unpack_from(">3H", self.map, 0x04)
            values = zip(_right_handed_down(field), cycles, strict=True)
            counts = [round(one / 10.0 * self.PER_UT[count]) for one, count in values]
            self.map[0x24:0x2D] = b"".join(one.to_bytes(3, "big", signed=True) for one in counts)
        return bytes(self.map[register : register + length])

    def put(self, register: int, data: bytes) -> None:
        if register == 0x0B and self.map[0x01] & 0x01:
            return
        self.setups += register == 0x01 and data[0] != 0x00
        super().put(register, data)


class Ak09916Twin(MeasuringTwin):
    """Powered down after power-up, and for 0.1 ms between two modes. Its data stay until ST2 is read. Behind
    an ICM-20948 (`carrier`) it answers only in bypass.
    """

    address = 0x0C
    RATES_HZ: Final = {2: 10.0, 4: 20.0, 6: 50.0, 8: 100.0}
    carrier: Icm20948Twin | None = None

    def reset(self) -> None:
        self.map[0x00:0x02] = bytes([0x48, 0x09])
        self.down_s, self.is_locked = -1.0, False

    def rate_hz(self) -> float:
        return self.RATES_HZ.get(self.map[0x31] & 0x1F, 0.0)

    def get(self, register: int, length: int) -> bytes:
        self._reach()
        if register == 0x10:
            self.map[0x10] = int(self.has_new())
            if self.has_new() and not self.is_locked:
                (field,) = self.sample((self.scene.field_mg(),))
                field = _right_handed_down(field)
                counts = whole_counts([one / 1.5 for one in field], 32752)
                is_over = sum(map(abs, field)) >= 49120.0
                self.map[0x11:0x19] = struct.pack("<3hxB", *counts, 0x08 * is_over)
                self.is_locked = True
            self.is_locked = self.is_locked and length < 9
        return bytes(self.map[register : register + length])

    def put(self, register: int, data: bytes) -> None:
        self._reach()
        if register == 0x31 and data[0]:
            if self.map[0x31] or self.scene.now() - self.down_s < 0.0001:
                return
            self.setups += 1
        elif register == 0x31:
            self.down_s = self.scene.now()
        super().put(register, data)

    def _reach(self) -> None:
        if self.carrier is not None and not self.carrier.is_connected_through:
            raise OSError(errno.EREMOTEIO, "Remote I/O error")
