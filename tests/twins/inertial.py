"""Twins of gyros with accelerometers, by their data sheets, in the scene of the magnetometers.

MPU-6050: InvenSense PS- and RM-MPU-6000A-00. LSM6DSOX: ST DS12814 revision 3. ICM-20948: as SparkFun's and
Adafruit's libraries, PX4 and ArduPilot (Invensensev2) use it, and DS-000189 revision 1.3.
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


class Icm20948Twin(MeasuringTwin):
    """Four banks of registers; that of 0x7F is in all of them. It sleeps after power-up, in bank 0, and takes
    no settings until 5 ms after it was woken up, as long as ArduPilot and Adafruit wait. Reading INT_STATUS_1
    clears it.
    """

    address = 0x69

    def reset(self) -> None:
        self.banks = [bytearray(0x80) for _ in range(4)]
        self.bank, self.woken_s = 0, self.scene.now()
        self.banks[0][0x00], self.banks[0][0x05], self.banks[0][0x06] = 0xEA, 0x40, 0x41
        self.banks[2][0x01], self.banks[2][0x14] = 0x01, 0x01

    @property
    def is_connected_through(self) -> bool:
        """BYPASS_EN, without I2C_MST_EN."""
        return bool(self.banks[0][0x0F] & 0x02) and not self.banks[0][0x03] & 0x20

    def rate_hz(self) -> float:
        """1125 Hz with the filters on; the slower of both sensors."""
        power, disabled = self.banks[0][0x06:0x08]
        settings = self.banks[2]
        if power & 0x60 or disabled or not settings[0x01] & settings[0x14] & 0x01:
            return 0.0
        return 1125.0 / (1 + max(settings[0x00], (settings[0x10] & 0x0F) << 8 | settings[0x11]))

    def get(self, register: int, length: int) -> bytes:
        if (self.bank, register) == (0, 0x1A):
            is_new = self.has_new()
            self.banks[0][0x1A] = int(is_new)
            if is_new:
                rate, force = self.sample((self.scene.rate_deg_s(), self.scene.force_g()))
                per_g = 16384 >> (self.banks[2][0x14] >> 1 & 3)
                per_rate = (131.0, 65.5, 32.8, 16.4)[self.banks[2][0x01] >> 1 & 3]
                counts = [one * per_g for one in force] + [one * per_rate for one in rate]
                self.banks[0][0x2D:0x39] = struct.pack(">6h", *whole_counts(counts))
        return bytes([*self.banks[self.bank][register : register + length]])

    def put(self, register: int, data: bytes) -> None:
        if register == 0x7F:
            self.bank = data[0] >> 4 & 3
        elif (self.bank, register) == (0, 0x06):
            self.setups += 1
            if self.banks[0][0x06] & 0x40:
                self.woken_s = self.scene.now()
            self.banks[0][0x06 : 0x06 + len(data)] = data
        elif not self.banks[0][0x06] & 0x40 and self.scene.now() - self.woken_s >= 0.0049:
            self.banks[self.bank][register : register + len(data)] = data
