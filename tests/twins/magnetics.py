"""Twins of magnetometers, by their data sheets, and the scene that they share with inertial sensors.

QMC5883L: QST 13-52-04 revision 1.0. QMC5883P: QST 13-52-19 revision C. HMC5883L: Honeywell 900405 revision E.
LIS3MDL: ST DocID024204 revision 6.
"""

import math
import random
import struct
from collections.abc import Callable, Sequence

Triple = tuple[float, float, float]


class Scene:
    """The boat that carries the boards: its attitude, the earth's field and its own iron.

    Angles in degrees; north_mg and down_mg: the earth's field; iron_mg: added in body axes (ahead, starboard,
    down). Boards lie flat with x ahead, y to port and z up, unless `turned`: board axes to usual board axes.
    """

    def __init__(self, now: Callable[[], float], seed: int = 1) -> None:
        self.now = now
        self.heading_deg = self.roll_deg = self.pitch_deg = 0.0
        self.yaw_rate_deg_s = 0.0
        self.north_mg, self.down_mg = 200.0, 440.0
        self.iron_mg: Triple = (0.0, 0.0, 0.0)
        self.noise_mg = 1.5
        self.random = random.Random(seed)

    def turn(self, dt_s: float) -> None:
        """Turn at the yaw rate."""
        self.heading_deg = (self.heading_deg + self.yaw_rate_deg_s * dt_s) % 360.0

    def to_body(self, north: float, east: float, down: float) -> Triple:
        """A vector of the world in body axes: yaw, then pitch, then roll (Fossen 2011, 2.2.1)."""
        psi, theta, phi = (math.radians(a) for a in (self.heading_deg, self.pitch_deg, self.roll_deg))
        x = north * math.cos(psi) + east * math.sin(psi)
        y = -north * math.sin(psi) + east * math.cos(psi)
        x, z = x * math.cos(theta) - down * math.sin(theta), x * math.sin(theta) + down * math.cos(theta)
        y, z = y * math.cos(phi) + z * math.sin(phi), -y * math.sin(phi) + z * math.cos(phi)
        return x, y, z

    def field_mg(self) -> Triple:
        """The field at the board, in body axes."""
        x, y, z = self.to_body(self.north_mg, 0.0, self.down_mg)
        noise = [self.random.gauss(0.0, self.noise_mg) for _ in range(3)]
        return (
            x + self.iron_mg[0] + noise[0],
            y + self.iron_mg[1] + noise[1],
            z + self.iron_mg[2] + noise[2],
        )

    def force_g(self) -> Triple:
        """What an accelerometer feels, in body axes: it pushes up at rest."""
        x, y, z = self.to_body(0.0, 0.0, -1.0)
        a, b, c = (self.random.gauss(0.0, 0.003) for _ in range(3))
        return x + a, y + b, z + c

    def rate_deg_s(self) -> Triple:
        """The boat's rate in body axes (Fossen 2011, 2.28)."""
        x, y, z = self.to_body(0.0, 0.0, self.yaw_rate_deg_s)
        noise = [self.random.gauss(0.0, 0.05) for _ in range(3)]
        return x + noise[0], y + noise[1], z + noise[2]


def _board(body: Triple) -> Triple:
    """Body axes to those of a board that lies flat, its arrow to the bow: x ahead, y to port, z up."""
    return body[0], -body[1], -body[2]


def whole_counts(values: Sequence[float], limit: int = 32767) -> list[int]:
    """Rounded, and held at the limits of two bytes."""
    return [max(-limit - 1, min(limit, round(value))) for value in values]


class MeasuringTwin:
    """A part with a byte map that measures at a rate while it is set up to."""

    address = 0

    def __init__(self, scene: Scene, turned: Callable[[Triple], Triple] = lambda axes: axes) -> None:
        """turned: from the axes of a board in its usual position to those of this one."""
        self.scene = scene
        self.turned = turned
        self.is_stuck = False
        self.resets = -1
        self.setups = 0
        self.power_up()

    def power_up(self) -> None:
        """As its supply comes on, or after a dip."""
        self.resets += 1
        self.map = bytearray(0x100)
        self.measured_s = -1.0
        self.held: tuple[Triple, ...] | None = None
        self.reset()

    def reset(self) -> None:
        """The registers' initial values."""

    def rate_hz(self) -> float:
        """0: it does not measure."""
        raise NotImplementedError

    def has_new(self) -> bool:
        """Whether a new measurement is due since the data were last read."""
        rate_hz = self.rate_hz()
        return rate_hz > 0.0 and self.scene.now() - self.measured_s >= 0.999 / rate_hz

    def sample(self, vectors: tuple[Triple, ...]) -> tuple[Triple, ...]:
        """Measure, or repeat what it is stuck at."""
        self.measured_s = self.scene.now()
        if not self.is_stuck or self.held is None:
            self.held = tuple(self.turned(_board(one)) for one in vectors)
        return self.held

    def get(self, register: int, length: int) -> bytes:
        raise NotImplementedError

    def put(self, register: int, data: bytes) -> None:
        for offset, value in enumerate(data):
            self.map[register + offset] = value


class Qmc5883lTwin(MeasuringTwin):
    """Reading the data clears DRDY (9.2.2); standby keeps the last values. Its number reads wrongly until
    register 0 has been read, `misreads` times also then; for starts_s after a reset it takes no settings.
    """

    address = 0x0D
    RATES_HZ = (10.0, 50.0, 100.0, 200.0)
    misreads = 0
    starts_s = 0.0999
    has_been_read = False

    def reset(self) -> None:
        self.map[0x0D] = 0xFF
        self.reset_s = -1.0

    def rate_hz(self) -> float:
        control = self.map[0x09]
        return self.RATES_HZ[control >> 2 & 3] if control & 3 == 1 else 0.0

    def get(self, register: int, length: int) -> bytes:
        per_gauss, limit = (3000, 32767) if self.map[0x09] & 0x30 == 0x10 else (12000, 32767)
        if register == 0x06:
            field = self.turned(_board(self.scene.field_mg()))
            is_over = any(abs(one) / 1000.0 * per_gauss > limit for one in field)
            return bytes([int(self.has_new()) | int(is_over) << 1])
        self.has_been_read = self.has_been_read or register == 0x00
        if register == 0x0D and (self.misreads or not self.has_been_read):
            self.misreads = max(0, self.misreads - 1)
            return b"\x00"
        if register == 0x00 and self.has_new():
            assert self.map[0x0B] == 0x01, "9.2.6: the recommended period"
            (field,) = self.sample((self.scene.field_mg(),))
            self.map[0:6] = struct.pack("<3h", *whole_counts([one * per_gauss / 1000.0 for one in field]))
        return bytes(self.map[register : register + length])

    def put(self, register: int, data: bytes) -> None:
        if register == 0x0A and data[0] & 0x80:
            self.map = bytearray(0x100)
            self.reset()
            self.reset_s = self.scene.now()
        elif self.scene.now() - self.reset_s >= self.starts_s:
            self.setups += register == 0x09
            super().put(register, data)


class Qmc5883pTwin(MeasuringTwin):
    """Suspended after power-up; reading the status clears DRDY. Its axes are right once 0x29 is written."""

    address = 0x2C
    RATES_HZ = (10.0, 50.0, 100.0, 200.0)
    PER_GAUSS = (1000, 2500, 3750, 15000)

    def reset(self) -> None:
        self.map[0x00] = 0x80

    def rate_hz(self) -> float:
        control = self.map[0x0A]
        return self.RATES_HZ[control >> 2 & 3] if control & 3 in (1, 3) else 0.0

    def get(self, register: int, length: int) -> bytes:
        per_gauss = self.PER_GAUSS[self.map[0x0B] >> 2 & 3]
        if register == 0x09:
            is_new = self.has_new()
            is_over = False
            if is_new:
                (field,) = self.sample((self.scene.field_mg(),))
                sign = 1.0 if self.map[0x29] == 0x06 else -1.0
                counts = [sign * one * per_gauss / 1000.0 for one in field]
                is_over = max(map(abs, counts)) > 32767
                self.map[1:7] = struct.pack("<3h", *whole_counts(counts))
            return bytes([int(is_new) | int(is_over) << 1])
        return bytes(self.map[register : register + length])

    def put(self, register: int, data: bytes) -> None:
        self.setups += register == 0x0A
        super().put(register, data)


class Hmc5883lTwin(MeasuringTwin):
    """Data in the order x, z, y, the higher byte first; −4096 out of range. The pointer turns back after 0x08
    to 0x03, so the status is not behind the data.
    """

    address = 0x1E
    PER_GAUSS = (1370, 1090, 820, 660, 440, 390, 330, 230)  # table 9
    RATES_HZ = (0.75, 1.5, 3.0, 7.5, 15.0, 30.0, 75.0)

    def reset(self) -> None:
        self.map[0:3] = bytes([0x10, 0x20, 0x01])
        self.map[0x0A:0x0D] = b"H43"

    def rate_hz(self) -> float:
        return self.RATES_HZ[self.map[0] >> 2 & 7] if self.map[2] & 3 == 0 else 0.0

    def get(self, register: int, length: int) -> bytes:
        if register == 0x09:
            return bytes([int(self.has_new())])
        if register == 0x03:
            assert length == 6
            if self.has_new():
                (field,) = self.sample((self.scene.field_mg(),))
                counts = [one * self.PER_GAUSS[self.map[1] >> 5] / 1000.0 for one in field]
                x, y, z = (round(one) if abs(one) <= 2047 else -4096 for one in counts)
                self.map[3:9] = struct.pack(">3h", x, z, y)
        return bytes(self.map[register : register + length])

    def put(self, register: int, data: bytes) -> None:
        self.setups += register == 0
        super().put(register, data)


class Lis3mdlTwin(MeasuringTwin):
    """Without bit 7 of the register's address every byte is that of one register (5.1.1)."""

    address = 0x1C
    PER_GAUSS = (6842, 3421, 2281, 1711)  # table 3

    def reset(self) -> None:
        self.map[0x0F] = 0x3D
        self.map[0x20:0x25] = bytes([0x10, 0x00, 0x03, 0x00, 0x00])

    def rate_hz(self) -> float:
        return (0.625, 1.25, 2.5, 5.0, 10.0, 20.0, 40.0, 80.0)[self.map[0x20] >> 2 & 7] * (
            self.map[0x22] & 3 == 0
        )

    def get(self, register: int, length: int) -> bytes:
        first, goes_on = register & 0x7F, bool(register & 0x80)
        if first == 0x27:
            self.map[0x27] = 0x08 if self.has_new() else 0x00
        if first in (0x27, 0x28) and first + length > 0x28 and self.has_new():
            (field,) = self.sample((self.scene.field_mg(),))
            per_gauss = self.PER_GAUSS[self.map[0x21] >> 5 & 3]
            self.map[0x28:0x2E] = struct.pack(
                "<3h", *whole_counts([one * per_gauss / 1000.0 for one in field])
            )
        return (
            bytes(self.map[first : first + length])
            if goes_on
            else bytes(self.map[first : first + 1]) * length
        )

    def put(self, register: int, data: bytes) -> None:
        first, goes_on = register & 0x7F, bool(register & 0x80)
        self.setups += first == 0x20
        for offset, value in enumerate(data):
            self.map[first + (offset if goes_on else 0)] = value
