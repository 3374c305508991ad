"""INA219 battery monitor on I²C: pack voltage and current through its shunt."""

from collections.abc import Callable
from typing import Protocol

from companion.config import parts
from companion.core.errors import HardwareError
from companion.hal.background import Background
from companion.hal.i2c import open_i2c
from companion.hal.ina219 import Ina219, Ina219Sample
from companion.sensors.readings import BatteryReading

_PERIOD_S = 0.1


class Ina219Part(Protocol):
    """The register interface."""

    def read(self) -> Ina219Sample: ...
    def close(self) -> None: ...


class Ina219Battery:
    """Satisfies `companion.hal.interfaces.Battery`.

    Vin+ is wired to the pack and Vin− to the load: discharge is positive, and the pack voltage is the bus
    voltage (behind the shunt) plus the shunt voltage. Beyond the shunt's range (3.2 A at 0.1 Ω) the current
    is unknown, not zero, and the voltage is that of the bus.
    """

    def __init__(self, part: Ina219Part, now: Callable[[], float], shunt_ohm: float = 0.1) -> None:
        self._part = part
        self._now = now
        self._shunt_ohm = shunt_ohm
        self._latest: BatteryReading | None = None
        self._background = Background(self.step, "battery monitor")

    def start(self) -> None:
        """Begin to read the part in a thread."""
        self._background.start()

    def step(self) -> float:
        """Read the part once; returns the seconds to wait before the next reading."""
        bus_v, shunt_v = self._part.read()
        if shunt_v is None:
            self._latest = BatteryReading(self._now(), bus_v, None)
        else:
            self._latest = BatteryReading(self._now(), bus_v + shunt_v, shunt_v / self._shunt_ohm)
        return _PERIOD_S

    def read(self) -> BatteryReading | None:
        """The latest reading, None before the first."""
        return self._latest

    def close(self) -> None:
        """Stop the thread and close the bus. May be called twice."""
        self._background.close()
        self._part.close()


def open_ina219(part: parts.BatteryPart, now: Callable[[], float]) -> Ina219Battery:
    """Open the monitor on the Pi's I²C bus and start reading.

    Raises:
        HardwareError: smbus2 is missing, there is no bus, or nothing answers at the address.
    """
    bus = open_i2c("INA219")
    try:
        battery = Ina219Battery(Ina219(bus, part.address), now, part.shunt_ohm)
    except OSError as error:
        bus.close()
        if isinstance(error, HardwareError):
            raise
        raise HardwareError(f"INA219: no answer at I²C address {part.address:#x}: {error}") from error
    battery.start()
    return battery
