"""INA219 battery monitor on I²C, from its data sheet (Texas Instruments SBOS448G, December 2015).

The shunt voltage is divided by the resistance here: the part's own calculation of current and power (8.5.2)
needs a calibration register that a supply dip clears, and then reports zero.
"""

import struct
from collections.abc import Callable
from typing import Final, NamedTuple

from companion.config import parts
from companion.core.errors import HardwareError
from companion.hal.background import BackgroundSensor
from companion.hal.raspberry_pi import I2cBus, open_i2c_part
from companion.sensors.readings import BatteryReading

ADDRESS: Final = 0x40
# Register 0: bus range 32 V, shunt range ±320 mV, both averaged over 64 samples (34 ms each: many periods of
# the motors' PWM), measuring without a break
CONFIGURATION: Final = 0x2000 | 0x1800 | 0x0700 | 0x0070 | 0x0007
_CONFIGURATION_AT, _SHUNT_AT, _BUS_AT = 0, 1, 2
_SHUNT_V: Final = 10e-6  # 8.6.3.1
_BUS_V: Final = 4e-3  # 8.6.3.2, behind three bits of status
_SHUNT_LIMIT: Final = 32000  # 320 mV
_PERIOD_S: Final = 0.1


class Ina219Sample(NamedTuple):
    """bus_v: behind the shunt. shunt_v: across it, None beyond its range."""

    bus_v: float
    shunt_v: float | None


class Ina219:
    """Registers of the part at one bus address."""

    def __init__(self, bus: I2cBus, address: int = ADDRESS) -> None:
        """Raises:
        HardwareError: the part does not keep its configuration, so it is not an INA219.
        """
        self.bus = bus
        self._address = address
        self._configure()
        if self._read(_CONFIGURATION_AT) != CONFIGURATION:
            raise HardwareError(f"INA219: the part at I²C address {address:#x} is not an INA219")

    def read(self) -> Ina219Sample:
        """The latest measurement; the configuration is restored after a supply dip.

        Raises:
            OSError: it does not answer.
        """
        if self._read(_CONFIGURATION_AT) != CONFIGURATION:
            self._configure()
        shunt, bus = self._read(_SHUNT_AT), self._read(_BUS_AT)
        if shunt >= 0x8000:
            shunt -= 0x10000
        is_in_range = abs(shunt) < _SHUNT_LIMIT
        return Ina219Sample((bus >> 3) * _BUS_V, shunt * _SHUNT_V if is_in_range else None)

    def _configure(self) -> None:
        self.bus.write_i2c_block_data(
            self._address, _CONFIGURATION_AT, list(struct.pack(">H", CONFIGURATION))
        )

    def _read(self, register: int) -> int:
        high, low = self.bus.read_i2c_block_data(self._address, register, 2)
        return high << 8 | low


class Ina219Battery(BackgroundSensor[BatteryReading]):
    """Satisfies `companion.hal.interfaces.Battery`.

    Vin+ is wired to the pack and Vin− to the load: discharge is positive, and the pack voltage is the bus
    voltage (behind the shunt) plus the shunt voltage. Beyond the shunt's range (3.2 A at 0.1 Ω) the current
    is unknown, not zero, and the voltage is that of the bus.
    """

    def __init__(self, part: Ina219, now: Callable[[], float], shunt_ohm: float = 0.1) -> None:
        super().__init__(self.step, "battery monitor", now, part.bus.close)
        self._part = part
        self._shunt_ohm = shunt_ohm

    def step(self) -> float:
        """Read the part once; returns the seconds to wait before the next reading."""
        bus_v, shunt_v = self._part.read()
        if shunt_v is None:
            self._latest = BatteryReading(self._now(), bus_v, None)
        else:
            self._latest = BatteryReading(self._now(), bus_v + shunt_v, shunt_v / self._shunt_ohm)
        return _PERIOD_S


def open_ina219(part: parts.BatteryPart, now: Callable[[], float]) -> Ina219Battery:
    """Open the monitor on the Pi's I²C bus and start reading.

    Raises:
        HardwareError: smbus2 is missing, there is no bus, or nothing answers at the address.
    """
    return open_i2c_part(
        "INA219", part.address, lambda bus: Ina219Battery(Ina219(bus, part.address), now, part.shunt_ohm)
    ).start()
