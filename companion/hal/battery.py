"""Battery monitors. Those of Texas Instruments measure across a shunt, register by register as in their data
sheets: INA219 (SBOS448G), INA226 (SBOS547A) and INA228 (SBOSA20A). The other is an ADS1115 with a divider and
a Hall sensor.

The shunt voltage is divided by the resistance here: the parts' own calculation of current, power and charge
needs a calibration register that a supply dip clears, and then reports zero. So the charge accumulator of the
INA228 is not used either; the boat integrates the averages of all monitors in the same way.
"""

import logging
from collections.abc import Callable
from typing import Final, NamedTuple

from companion.config.sensors import BatteryPart
from companion.core.errors import HardwareError
from companion.core.readings import BatteryReading
from companion.hal import ads1115
from companion.hal.ads1115 import Ads1115
from companion.hal.background import BackgroundSensor
from companion.hal.raspberry_pi import I2cBus, Registers, open_i2c_part

_log = logging.getLogger(__name__)


class Register(NamedTuple):
    """A measurement: `steps` of `volt` each, above `shift` bits of status."""

    at: int
    volt: float
    length: int = 2
    shift: int = 0
    is_signed: bool = False

    def steps(self, data: bytes) -> int:
        """The measurement in steps."""
        return int.from_bytes(data, "big", signed=self.is_signed) >> self.shift


class ShuntChip(NamedTuple):
    """One kind of monitor.

    setup: registers of two bytes and their values. identity: register, mask and value; None: there is none.
    limit: shunt steps from which on the current is unknown. is_bus_behind_shunt: the bus voltage is measured
    at the load's end of the shunt.
    """

    name: str
    setup: tuple[tuple[int, int], ...]
    identity: tuple[tuple[int, int, int], ...]
    shunt: Register
    bus: Register
    limit: int
    is_bus_behind_shunt: bool = False

    def is_at(self, registers: Registers) -> bool:
        """Whether the part has this kind's numbers. Only reads. Raises OSError: nothing answers."""
        return all(registers.read_word(at) & mask == value for at, mask, value in self.identity)


# All measure shunt and bus in turn without a break, and average 64 pairs: 34 to 43 ms, many periods of the
# motors' PWM, and less than the period of reading.
INA219: Final = ShuntChip(
    "INA219",
    # 8.6.2.1: bus range 32 V, shunt range ±320 mV, 64 samples each
    ((0x00, 0x2000 | 0x1800 | 0x0700 | 0x0070 | 0x0007),),
    (),
    shunt=Register(0x01, 10e-6, is_signed=True),  # 8.6.3.1
    bus=Register(0x02, 4e-3, shift=3),  # 8.6.3.2
    limit=32000,
    is_bus_behind_shunt=True,
)
INA226: Final = ShuntChip(
    "INA226",
    # 7.6.1: bit 14 is fixed; 64 averages of 332 µs + 332 µs
    ((0x00, 0x4000 | 0b011 << 9 | 0b010 << 6 | 0b010 << 3 | 0b111),),
    ((0xFE, 0xFFFF, 0x5449), (0xFF, 0xFFF0, 0x2260)),  # 7.6.9, 7.6.10: "TI", and the die without its revision
    shunt=Register(0x01, 2.5e-6, is_signed=True),  # 7.6.2
    bus=Register(0x02, 1.25e-3),  # 7.6.3
    limit=0x7FFF,  # ±81.92 mV
)
INA228: Final = ShuntChip(
    "INA228",
    # 7.6.1.1: shunt range ±163.84 mV; 7.6.1.2: shunt and bus, 64 averages of 280 µs + 280 µs
    ((0x00, 0x0000), (0x01, 0xB << 12 | 3 << 9 | 3 << 6 | 3)),
    ((0x3E, 0xFFFF, 0x5449), (0x3F, 0xFFF0, 0x2280)),
    shunt=Register(0x04, 312.5e-9, length=3, shift=4, is_signed=True),  # 7.6.1.5
    bus=Register(0x05, 195.3125e-6, length=3, shift=4),  # 7.6.1.6
    limit=0x7FFFF,
)


class Measurement(NamedTuple):
    """Pack voltage, and current, positive while discharging; None beyond the range."""

    voltage_v: float
    current_a: float | None


class ShuntMonitor:
    """One part at one bus address. Vin+ is wired to the pack and Vin− to the load.

    The pack voltage is measured at Vin+; where the part measures it at Vin−, the shunt voltage is added.
    Beyond the shunt's range the current is unknown, not zero.
    """

    def __init__(self, chip: ShuntChip, bus: I2cBus, address: int, shunt_ohm: float) -> None:
        """Raises HardwareError: another kind of part is at the address; OSError: nothing answers."""
        self.bus = bus
        self._chip = chip
        self._registers = Registers(bus, address)
        self._shunt_ohm = shunt_ohm
        self._has_measured = False
        if is_it := chip.is_at(self._registers):
            self._set_up()
        if not is_it or not self._is_set_up():
            raise HardwareError(f"{chip.name}: the part at I²C address {address:#x} is not an {chip.name}")
        reach_a = chip.limit * chip.shunt.volt / shunt_ohm
        _log.info("%s: up to %.3g A with a shunt of %g ohm", chip.name, reach_a, shunt_ohm)

    def read(self) -> Measurement | None:
        """The latest average; None at the first call after opening or a supply dip: the part measures then.
        Raises OSError: it does not answer.
        """
        chip = self._chip
        if not self._is_set_up():
            self._set_up()
            return None
        if not self._has_measured:
            self._has_measured = True
            return None
        shunt = self._steps(chip.shunt)
        shunt_v, bus_v = shunt * chip.shunt.volt, self._steps(chip.bus) * chip.bus.volt
        is_known = -chip.limit < shunt < chip.limit
        voltage_v = bus_v + shunt_v if chip.is_bus_behind_shunt and is_known else bus_v
        return Measurement(voltage_v, shunt_v / self._shunt_ohm if is_known else None)

    def _is_set_up(self) -> bool:
        return all(self._registers.read_word(at) == value for at, value in self._chip.setup)

    def _set_up(self) -> None:
        self._has_measured = False
        for at, value in self._chip.setup:
            self._registers.write(at, *value.to_bytes(2, "big"))

    def _steps(self, register: Register) -> int:
        return register.steps(self._registers.read(register.at, register.length))


# Without a current a Hall sensor gives half its supply, one for a single direction 0.12 of it: 0.39 V at
# 3.3 V. An input below this is a broken wire, or a sensor without its supply
_LEAST_HALL_V: Final = 0.1


class AnalogMonitor:
    """Pack voltage by a resistive divider and current by a Hall sensor (ACS712, ACS758), on an ADS1115."""

    def __init__(self, converter: Ads1115, part: BatteryPart) -> None:
        self.bus = converter.bus
        self._converter = converter
        self._part = part

    def read(self) -> Measurement:
        """One conversion of each input. The current is None without a sensor, or beyond the input's range.
        Raises HardwareError: the pack's voltage is beyond the divider's range, or the converter hangs;
        OSError: it does not answer.
        """
        part = self._part
        input_v = self._converter.read_v(part.voltage_channel)
        if input_v is None:
            raise HardwareError("ADS1115: the divider's voltage is beyond the input's range")
        current_a = None
        if part.current_channel >= 0:
            hall_v = self._converter.read_v(part.current_channel)
            if hall_v is not None and hall_v >= _LEAST_HALL_V:
                current_a = (hall_v - part.zero_v) / part.volt_per_a
        return Measurement(input_v * part.divider, current_a)


_PERIOD_S: Final = 0.1
SHUNT_CHIPS: Final = {"ina219": INA219, "ina226": INA226, "ina228": INA228}
SHUNT_ADDRESSES: Final = (0x40, 0x41, 0x44, 0x45)  # A0 and A1 to ground or supply


Monitor = ShuntMonitor | AnalogMonitor


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
    Raises HardwareError: smbus2 is missing, there is no bus, or nothing answers at the address.
    """

    def create(bus: I2cBus) -> Monitor:
        if chip is None:
            return AnalogMonitor(ads1115.Ads1115(bus, address), part)
        return ShuntMonitor(chip, bus, address, part.shunt_ohm)

    chip = SHUNT_CHIPS.get(part.driver)
    address = part.address or (ads1115.ADDRESSES if chip is None else SHUNT_ADDRESSES)[0]
    return BatterySensor(open_i2c_part(part.driver.upper(), part.i2c_bus, address, create), now).start()
