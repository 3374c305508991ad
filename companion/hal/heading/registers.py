"""What the drivers of magnetometers and inertial sensors share: board axes, registers, samples."""

from typing import NamedTuple, Protocol

from companion.config.parts import Mounting
from companion.core.vectors import Matrix, Vector, product, quarter_turns
from companion.hal.raspberry_pi import I2cBus

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


class Magnetometer(Protocol):
    """A magnetometer in board axes."""

    name: str
    address: int

    def identify(self) -> str:
        """What answers instead of the part, empty if it is the part. Raises OSError."""

    def set_up(self) -> None:
        """Start measuring. Raises OSError."""

    def read(self) -> Vector | None:
        """A new field in mG; None without a new one, or one out of range. Raises OSError."""


class InertialSensor(Protocol):
    """Gyro and accelerometer in board axes."""

    name: str
    address: int

    def identify(self) -> str:
        """What answers instead of the part, empty if it is the part. Raises OSError."""

    def set_up(self) -> None:
        """Start measuring. Raises OSError."""

    def read(self) -> Motion | None:
        """A new sample; None without a new one. Raises OSError."""
