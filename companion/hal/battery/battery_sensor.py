"""The battery monitor: one of the chips, read in a thread."""

from collections.abc import Callable
from typing import Final, Protocol

from companion.config.parts.battery import BatteryPart
from companion.core.readings import BatteryReading
from companion.hal import ads1115
from companion.hal.background import BackgroundSensor
from companion.hal.battery.analog_monitor import AnalogMonitor
from companion.hal.battery.shunt_monitor import INA219, INA226, INA228, Measurement, ShuntMonitor
from companion.hal.raspberry_pi import I2cBus, open_i2c_part

_PERIOD_S: Final = 0.1
_SHUNT_CHIPS: Final = {"ina219": INA219, "ina226": INA226, "ina228": INA228}
_SHUNT_ADDRESS: Final = 0x40  # A0 and A1 to ground


class Monitor(Protocol):
    """A part on the bus."""

    bus: I2cBus

    def read(self) -> Measurement | None:
        """The latest measurement, None if there is none yet.

        Raises:
            HardwareError, OSError: it does not answer.
        """


class BatterySensor(BackgroundSensor[BatteryReading]):
    """Reads a monitor in a thread. Satisfies `companion.hal.interfaces.Battery`."""

    def __init__(self, monitor: Monitor, now: Callable[[], float]) -> None:
        super().__init__(self.step, "battery monitor", now, monitor.bus.close)
        self._monitor = monitor

    def step(self) -> float:
        """Read the part once; returns the seconds to wait before the next reading."""
        measured = self._monitor.read()
        if measured is not None:
            self._latest = BatteryReading(self._now(), measured.voltage_v, measured.current_a)
        return _PERIOD_S


def open_battery_monitor(part: BatteryPart, now: Callable[[], float]) -> BatterySensor:
    """Open the monitor on the Pi's I²C bus and start reading.

    Raises:
        HardwareError: smbus2 is missing, there is no bus, or nothing answers at the address.
    """

    def create(bus: I2cBus) -> Monitor:
        if chip is None:
            return AnalogMonitor(ads1115.Ads1115(bus, address), part)
        return ShuntMonitor(chip, bus, address, part.shunt_ohm)

    chip = _SHUNT_CHIPS.get(part.driver)
    address = part.address or (ads1115.ADDRESS if chip is None else _SHUNT_ADDRESS)
    return BatterySensor(open_i2c_part(part.driver.upper(), part.i2c_bus, address, create), now).start()
