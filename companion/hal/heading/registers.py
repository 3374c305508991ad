"""What the drivers of magnetometers and inertial sensors share: board axes, registers, samples."""

import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Generic, NamedTuple, TypeVar

from companion.config.parts import Mounting
from companion.core.vectors import Matrix, Vector, product, quarter_turns
from companion.hal.raspberry_pi import I2cBus

Sample_co = TypeVar("Sample_co", covariant=True)

# A board's axes are x along its arrow, y to its left, z up; half a turn about x makes them body axes
_BOARD = quarter_turns(2, 0, 0)


def board_to_body(mounting: Mounting) -> Matrix:
    """Turns vectors in the axes printed on a board into body axes."""
    turns = (mounting.roll_deg // 90, mounting.pitch_deg // 90, mounting.yaw_deg // 90)
    return product(quarter_turns(*turns), _BOARD)


class Registers:
    """The registers of the part at one bus address."""

    def __init__(self, bus: I2cBus, address: int) -> None:
        self._bus = bus
        self._address = address

    def read(self, register: int, length: int) -> bytes:
        """Read bytes. Raises OSError if the part does not answer."""
        return bytes(self._bus.read_i2c_block_data(self._address, register, length))

    def write(self, register: int, *values: int) -> None:
        """Write bytes. Raises OSError if the part does not answer."""
        self._bus.write_i2c_block_data(self._address, register, values)


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
