"""The base of magnetometers, and of gyros with accelerometers, on I²C.

After a supply dip a part is back in its power-up state and does not measure. The driver of the compass then
sets it up again.
"""

import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Generic, NamedTuple, TypeVar

from companion.core.vectors import Vector
from companion.hal.raspberry_pi import I2cBus, Registers

Sample_co = TypeVar("Sample_co", covariant=True)


class Motion(NamedTuple):
    """A sample of gyro and accelerometer in board axes: rate in rad/s, specific force in m/s²."""

    rate: Vector
    force: Vector


class Chip(ABC, Generic[Sample_co]):
    """A part at one bus address, whose samples are in board axes. Every call raises OSError if it does not
    answer.

    ID_AT, ID_BYTES, IDS: the register of its number, the number's length, the higher byte first, and the
    numbers of the parts that it may be. SET_UP: what makes it measure, as registers with the bytes to write
    from there on. PAUSE_S: after each of these.
    """

    name: str
    ADDRESSES: tuple[int, ...]  # the usual one first
    ID_AT: int
    ID_BYTES: int = 1
    IDS: tuple[int, ...]
    SET_UP: tuple[tuple[int, ...], ...]
    PAUSE_S: float = 0.0

    def __init__(self, bus: I2cBus, address: int = 0, wait: Callable[[float], None] = time.sleep) -> None:
        self.address = address or self.ADDRESSES[0]
        self._registers = Registers(bus, self.address)
        self._wait = wait

    def identify(self) -> str:
        """What answers instead of the part; empty if it is the part."""
        found = int.from_bytes(self._registers.read(self.ID_AT, self.ID_BYTES), "big")
        return "" if found in self.IDS else f"{found:#x}, not {self.IDS[0]:#x}"

    def set_up(self) -> None:
        """Write `SET_UP`: the part begins to measure."""
        for register, *values in self.SET_UP:
            self._registers.write(register, *values)
            self._wait(self.PAUSE_S)

    @abstractmethod
    def read(self) -> Sample_co | None:
        """A new sample, a field in mG or `Motion`; None without a new one, or one out of range."""


Magnetometer = Chip[Vector]
InertialSensor = Chip[Motion]
