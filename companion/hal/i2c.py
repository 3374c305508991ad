"""The Pi's I²C bus through Linux's i2c-dev."""

from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

from companion.core.errors import HardwareError
from companion.hal.optional import import_optional

DEVICE = Path("/dev/i2c-1")  # on header pins 3 and 5 of every Pi with 40 pins


class I2cBus(Protocol):
    """The used part of smbus2's SMBus. Every call raises OSError if the part does not answer."""

    def read_i2c_block_data(self, address: int, register: int, length: int) -> list[int]:
        """Read bytes from a register."""

    def write_i2c_block_data(self, address: int, register: int, data: Sequence[int]) -> None:
        """Write bytes to a register."""

    def close(self) -> None:
        """Close the bus."""


def open_i2c(part: str) -> I2cBus:
    """Open the bus for one part. Each part opens its own: the address belongs to the file, not to the call.

    Raises:
        HardwareError: smbus2 is missing, or the bus cannot be opened; the message says what to do.
    """
    smbus2 = import_optional("smbus2", part)
    try:
        bus: I2cBus = smbus2.SMBus(str(DEVICE))
    except FileNotFoundError:
        raise HardwareError(
            f"{part}: there is no {DEVICE}; switch I²C on: sudo raspi-config nonint do_i2c 0"
        ) from None
    except PermissionError:
        raise HardwareError(f"{part}: {DEVICE} may not be opened; add the user to the group i2c") from None
    except OSError as error:
        raise HardwareError(f"{part}: {DEVICE} cannot be opened: {error}") from error
    return bus
