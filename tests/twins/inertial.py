"""Twins of gyros with accelerometers, by their data sheets, in the scene of the magnetometers.

MPU-6050: InvenSense PS- and RM-MPU-6000A-00. LSM6DSOX: ST DS12814 revision 3.
"""

import struct

from twins.magnetics import MeasuringTwin, whole_counts


class Mpu6050Twin(MeasuringTwin):
    """It sleeps after power-up. Reading INT_STATUS clears it. A magnetometer on its auxiliary bus (`behind`)
    answers only in bypass.
    """

    address = 0x68
    chip_id = 0x68

    def reset(self) -> None:
        self.map[0x6B], self.map[0x75] = 0x40, self.chip_id

    def rate_hz(self) -> float:
        if self.map[0x6B] & 0x40 or not self.map[0x38] & 1:
            return 0.0
        clock_hz = 8000.0 if self.map[0x1A] & 7 in (0, 7) else 1000.0
        return clock_hz / (1 + self.map[0x19])

    def get(self, register: int, length: int) -> bytes:
        if register == 0x3A:
            is_new = self.has_new()
            self.map[0x3A] = int(is_new)
            if is_new:
                rate, force = self.sample((self.scene.rate_deg_s(), self.scene.force_g()))
                per_g = (16384, 8192, 4096, 2048)[self.map[0x1C] >> 3 & 3]
                per_rate = (131.0, 65.5, 32.8, 16.4)[self.map[0x1B] >> 3 & 3]
                self.map[0x3B:0x41] = struct.pack(">3h", *whole_counts([one * per_g for one in force]))
                self.map[0x41:0x43] = struct.pack(">h", round((25.0 - 36.53) * 340.0))
                self.map[0x43:0x49] = struct.pack(">3h", *whole_counts([one * per_rate for one in rate]))
        return bytes(self.map[register : register + length])

    def put(self, register: int, data: bytes) -> None:
        self.setups += register == 0x6B
        super().put(register, data)


class OtherTwin:
    """Another part at the address of an MPU-6050: it keeps what it is told and answers zeros else."""

    def __init__(self, chip_id: int) -> None:
        self.map = bytearray(0x100)
        self.map[0x3A], self.map[0x75] = 0x01, chip_id

    def get(self, register: int, length: int) -> bytes:
        return bytes(self.map[register : register + length])

    def put(self, register: int, data: bytes) -> None:
        self.map[register : register + len(data)] = data


class Lsm6dsTwin(MeasuringTwin):
    """Powered down until its control registers are written."""

    address = 0x6A
    chip_id = 0x6C

    def reset(self) -> None:
        self.map[0x0F], self.map[0x12] = self.chip_id, 0x04

    def rate_hz(self) -> float:
        gyro, force = self.map[0x11] >> 4, self.map[0x10] >> 4
        return 13.0 * 2 ** (min(gyro, force) - 1) if gyro and force else 0.0

    def get(self, register: int, length: int) -> bytes:
        if register == 0x1E:
            return bytes([0x03 if self.has_new() else 0x00])
        if register == 0x22 and self.has_new():
            rate, force = self.sample((self.scene.rate_deg_s(), self.scene.force_g()))
            mg = (0.061, 0.488, 0.122, 0.244)[self.map[0x10] >> 2 & 3]
            mdps = (8.75, 17.5, 35.0, 70.0)[self.map[0x11] >> 2 & 3]
            self.map[0x22:0x28] = struct.pack("<3h", *whole_counts([one * 1000.0 / mdps for one in rate]))
            self.map[0x28:0x2E] = struct.pack("<3h", *whole_counts([one * 1000.0 / mg for one in force]))
        return bytes(self.map[register : register + length])

    def put(self, register: int, data: bytes) -> None:
        self.setups += register == 0x10
        super().put(register, data)
