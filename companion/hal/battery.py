"""INA219 battery monitor on I²C: pack voltage and current through its shunt."""

import math
from collections.abc import Callable
from typing import Protocol

from companion import parts
from companion.errors import HardwareError
from companion.hal.background import Background
from companion.hal.optional import import_optional
from companion.sensors.readings import BatteryReading

_PERIOD_S = 0.1


class Ina219Part(Protocol):
    """What is used of the part's driver: V, V, mA, and whether the current was beyond its range."""

    @property
    def bus_voltage(self) -> float: ...
    @property
    def shunt_voltage(self) -> float: ...
    @property
    def current(self) -> float: ...
    @property
    def overflow(self) -> int: ...


class Ina219Battery:
    """Satisfies `companion.hal.interfaces.Battery`.

    Vin+ is wired to the pack and Vin− to the load, so discharge is positive and the pack's voltage is the
    bus voltage (behind the shunt) plus the drop over the shunt. Beyond the shunt's range (3.2 A at 0.1 Ω)
    the current is unknown, not zero.
    """

    def __init__(self, part: Ina219Part, now: Callable[[], float]) -> None:
        self._part = part
        self._now = now
        self._latest: BatteryReading | None = None
        self._background = Background(self.step, "battery monitor")

    def start(self) -> None:
        """Begin to read the part in a thread."""
        self._background.start()

    def step(self) -> float:
        """Read the part once; returns the seconds to wait before the next reading."""
        voltage_v = self._part.bus_voltage + self._part.shunt_voltage
        current_a = None if self._part.overflow else self._part.current / 1000.0
        if math.isfinite(voltage_v):
            self._latest = BatteryReading(self._now(), voltage_v, current_a)
        return _PERIOD_S

    def read(self) -> BatteryReading | None:
        """The latest reading, None before the first."""
        return self._latest

    def close(self) -> None:
        """End the thread. May be called twice."""
        self._background.close()


def open_ina219(part: parts.BatteryPart, now: Callable[[], float]) -> Ina219Battery:
    """The monitor on the Pi's I²C bus, being read.

    Raises:
        HardwareError: its library is missing, or nothing answers at the address.
    """
    board = import_optional("board", "INA219")
    ina219 = import_optional("adafruit_ina219", "INA219")
    try:
        battery = Ina219Battery(ina219.INA219(board.I2C(), part.address), now)
    except Exception as error:
        raise HardwareError(f"INA219: nothing usable at I²C address {part.address:#x}: {error}") from error
    battery.start()
    return battery
