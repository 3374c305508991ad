"""The Pi's pins through gpiozero, and its I²C bus through smbus2 and i2c-dev. Errors say what to do."""

import contextlib
import fcntl
import importlib
import os
import threading
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import Protocol, TypeVar

from companion.cli.program_end import how_to_install
from companion.config.board import i2c_device
from companion.core.errors import HardwareError

ROOT = Path("/")  # of the devices
_I2C_TIMEOUT = 0x0702  # linux/i2c-dev.h, in units of 10 ms; a Pi's own is 1 s, that of i2c-gpio 0.1 s
_TRANSFER = 10  # 0.1 s: the longest takes 35 ms, 32 bytes at 10 kHz. A bus that hangs is then told in 0.4 s
_PIPE = ".lgd-nfy"  # created by lgpio in LG_WD or the working directory
_Part = TypeVar("_Part")
_PINS = threading.RLock()  # gpiozero makes its pin factory once, and warnings are caught for all threads


def import_optional(module: str, part: str) -> ModuleType:
    """Import a module of the extra `pi`.
    Raises HardwareError: it is not installed or does not load; the message says what to do.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise HardwareError(
            f"{part}: the Python module {error.name or module!r} is missing; {how_to_install('pi')}"
        ) from None
    except Exception as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        raise HardwareError(
            f"{part}: the Python module {module!r} does not load on this machine ({reason}); "
            "reinstall the extra pi, or set the part's driver to none"
        ) from error


@contextmanager
def opening_pins(part: str) -> Iterator[ModuleType]:
    """gpiozero, in a context that explains its errors.
    Raises HardwareError: gpiozero is missing, there are no pins, or one is in use.
    """
    gpiozero = import_optional("gpiozero", part)
    with _PINS, warnings.catch_warnings(record=True) as fallbacks:  # why gpiozero could not use lgpio
        warnings.simplefilter("always")
        try:
            yield gpiozero
        except Exception as error:
            reasons = [str(one.message) for one in fallbacks]
            raise HardwareError(f"{part}: the pins cannot be opened: {_reason(error, reasons)}") from error


def _reason(error: Exception, fallbacks: list[str]) -> str:
    if any(_PIPE in reason for reason in fallbacks):
        return f"lgpio cannot write to {os.getcwd()}; start in a folder of this user's, or name one in LG_WD"
    first = f" ({fallbacks[0]})" if fallbacks else ""
    return " ".join(f"{error}{first}".split())


class I2cBus(Protocol):
    """The used part of smbus2's SMBus. Every call raises OSError if the part does not answer."""

    def read_i2c_block_data(self, address: int, register: int, length: int) -> list[int]:
        """Read bytes from a register."""

    def write_i2c_block_data(self, address: int, register: int, data: Sequence[int]) -> None:
        """Write bytes to a register."""

    def close(self) -> None:
        """Close the device of the bus."""


class Registers:
    """The registers of the part at one bus address. Every call raises OSError if it does not answer."""

    def __init__(self, bus: I2cBus, address: int) -> None:
        self.bus = bus
        self.address = address

    def read(self, register: int, length: int) -> bytes:
        return bytes(self.bus.read_i2c_block_data(self.address, register, length))

    def read_word(self, register: int) -> int:
        """Read two bytes, the higher one first."""
        return int.from_bytes(self.read(register, 2), "big")

    def write(self, register: int, *values: int) -> None:
        self.bus.write_i2c_block_data(self.address, register, values)


def open_i2c(part: str, bus: int | str = 1) -> I2cBus:
    """Open the bus, by its number or its device, for one part. Each part opens its own: the address belongs
    to the file, not to the call.
    Raises HardwareError: smbus2 is missing, or the bus cannot be opened; the message says what to do.
    """
    smbus2 = import_optional("smbus2", part)
    device = ROOT / i2c_device(bus).lstrip("/")
    try:
        opened = smbus2.SMBus(str(device))
    except FileNotFoundError:
        cure = (
            "switch I²C on: sudo raspi-config nonint do_i2c 0" if bus == 1 else "add its line to config.txt"
        )
        raise HardwareError(f"{part}: there is no {device}; {cure}") from None
    except PermissionError:
        raise HardwareError(f"{part}: {device} may not be opened; add the user to the group i2c") from None
    except OSError as error:
        raise HardwareError(f"{part}: {device} cannot be opened: {error}") from error
    with contextlib.suppress(OSError):  # without it a bus that hangs is only noticed later
        fcntl.ioctl(opened.fd, _I2C_TIMEOUT, _TRANSFER)
    i2c: I2cBus = opened
    return i2c


def open_i2c_part(part: str, bus: int | str, address: int, create: Callable[[I2cBus], _Part]) -> _Part:
    """Open the bus and create the part on it.
    Raises HardwareError: smbus2 is missing, there is no bus, or the part does not answer.
    """
    opened = open_i2c(part, bus)
    try:
        return create(opened)
    except HardwareError:
        opened.close()
        raise
    except OSError as error:
        opened.close()
        raise HardwareError(f"{part}: no answer at I²C address {address:#x}: {error}") from error
