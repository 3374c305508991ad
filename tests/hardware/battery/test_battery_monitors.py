"""The battery monitors by their registers, through the real smbus2."""

from collections.abc import Callable

import pytest
from twins.battery import Ads1115Twin, Ina219Twin, Ina226Twin, Ina228Twin, MonitorTwin
from twins.i2c import Bno055Twin, I2cDev
from twins.lines import HandClock, known

from companion.config.sensors import BatteryPart
from companion.core.errors import HardwareError
from companion.core.readings import BatteryReading
from companion.hal.ads1115 import Ads1115
from companion.hal.battery import (
    INA219,
    INA226,
    INA228,
    AnalogMonitor,
    BatterySensor,
    ShuntChip,
    ShuntMonitor,
    open_battery_monitor,
)
from companion.hal.raspberry_pi import I2cBus

CHIPS = {"ina219": (Ina219Twin, INA219), "ina226": (Ina226Twin, INA226), "ina228": (Ina228Twin, INA228)}
ANALOG = BatteryPart(driver="ads1115")


class Bench:
    """A monitor with its twin on the bus."""

    def __init__(self, twin: MonitorTwin, chip: ShuntChip, bus: I2cBus, clock: HandClock) -> None:
        self.twin, self._chip, self._bus, self._clock = twin, chip, bus, clock

    def sensor(self, shunt_ohm: float = 0.1) -> BatterySensor:
        return BatterySensor(ShuntMonitor(self._chip, self._bus, 0x40, shunt_ohm), self._clock)

    def step(self, sensor: BatterySensor) -> BatteryReading:
        """Read until the part has had time to measure; the reading."""
        for _ in range(2):
            self._clock.advance(sensor.step())
        return known(sensor.read())


@pytest.fixture(params=CHIPS)
def bench(request: pytest.FixtureRequest, dev: I2cDev, bus: I2cBus, clock: HandClock) -> Bench:
    make, chip = CHIPS[request.param]
    twin = make(clock)
    dev.parts = {0x40: twin}
    return Bench(twin, chip, bus, clock)


def test_voltage_is_the_packs_and_current_that_of_the_shunt(bench: Bench) -> None:
    bench.twin.pack_v, bench.twin.shunt_v = 11.15, 0.06
    reading = bench.step(bench.sensor(0.01))
    assert reading.voltage_v == pytest.approx(11.15, abs=0.003)
    assert reading.current_a == pytest.approx(6.0, abs=1e-3)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_current_beyond_the_shunt_is_unknown(bench: Bench, sign: float) -> None:
    sensor = bench.sensor()
    limit_v = {Ina219Twin: 0.32, Ina226Twin: 0.08192, Ina228Twin: 0.16384}[type(bench.twin)]
    bench.twin.pack_v, bench.twin.shunt_v = 11.0, sign * 0.999 * limit_v
    assert bench.step(sensor).current_a == pytest.approx(sign * 9.99 * limit_v, rel=1e-4)
    bench.twin.shunt_v = sign * limit_v
    reading = bench.step(sensor)
    assert reading.current_a is None
    assert reading.voltage_v == pytest.approx(11.0, abs=0.33)


def test_a_part_whose_supply_dipped_is_set_up_again_and_reads_no_zeros(
    bench: Bench, clock: HandClock
) -> None:
    sensor = bench.sensor()
    before = bench.step(sensor)
    bench.twin.power_up()
    seen = []
    for _ in range(4):
        clock.advance(sensor.step())
        seen.append(sensor.read())
    assert {reading.voltage_v for reading in seen if reading} == {before.voltage_v}
    assert seen[0] is before
    assert seen[-1] is not None
    assert seen[-1].time_s > before.time_s


@pytest.mark.parametrize("driver", CHIPS)
def test_a_part_of_another_kind_is_told_in_one_line(dev: I2cDev, clock: HandClock, driver: str) -> None:
    dev.parts = {0x40: Bno055Twin()}
    part = BatteryPart(driver=driver)  # type: ignore[arg-type]
    name = driver.upper()
    with pytest.raises(HardwareError, match=f"{name}: the part at I²C address 0x40 is not an {name}"):
        open_battery_monitor(part, clock)


def test_an_ina226_is_not_taken_for_an_ina228_nor_written_to(dev: I2cDev, clock: HandClock) -> None:
    twin = Ina226Twin(clock)
    twin.put = pytest.fail  # type: ignore[method-assign,assignment]
    dev.parts = {0x40: twin}
    with pytest.raises(HardwareError, match="not an INA228"):
        open_battery_monitor(BatteryPart(driver="ina228"), clock)


# Divider and Hall sensor on an ADS1115


@pytest.fixture
def converter(dev: I2cDev, clock: HandClock) -> Ads1115Twin:
    twin = Ads1115Twin(clock)
    twin.inputs_v = [11.0 / 11.0, 1.65 + 5.0 * 0.0264, 0.0, 0.0]
    dev.parts = {0x48: twin}
    return twin


@pytest.fixture
def analog(converter: Ads1115Twin, bus: I2cBus, clock: HandClock) -> Callable[[BatteryPart], BatterySensor]:
    return lambda part: BatterySensor(AnalogMonitor(Ads1115(bus, 0x48, clock.advance), part), clock)


def read(sensor: BatterySensor) -> BatteryReading:
    sensor.step()
    return known(sensor.read())


def test_divider_and_hall_sensor_give_volts_and_amperes(
    analog: Callable[[BatteryPart], BatterySensor],
) -> None:
    reading = read(analog(ANALOG))
    assert reading.voltage_v == pytest.approx(11.0, abs=0.002)
    assert reading.current_a == pytest.approx(5.0, abs=0.005)


@pytest.mark.parametrize("hall_v", [0.0, 0.09, 3.6])
def test_a_broken_wire_at_the_hall_sensor_is_no_current(
    converter: Ads1115Twin, analog: Callable[[BatteryPart], BatterySensor], hall_v: float
) -> None:
    converter.supply_v = 5.0
    converter.inputs_v[1] = hall_v if hall_v < 3.0 else 4.2  # beyond the input's range
    reading = read(analog(ANALOG))
    assert reading.current_a is None
    assert reading.voltage_v == pytest.approx(11.0, abs=0.002)


def test_a_divider_beyond_the_range_and_a_hung_converter_are_faults(
    converter: Ads1115Twin, analog: Callable[[BatteryPart], BatterySensor], clock: HandClock
) -> None:
    sensor = analog(ANALOG)
    converter.supply_v, converter.inputs_v[0] = 5.0, 4.5
    with pytest.raises(HardwareError, match="beyond the input's range"):
        sensor.step()
    converter.inputs_v[0] = 1.0
    converter.is_hung = True
    began_s = clock()
    with pytest.raises(HardwareError, match="a conversion does not end"):
        sensor.step()
    assert clock() - began_s < 0.05
    converter.is_hung = False
    converter.power_up()
    assert read(sensor).voltage_v == pytest.approx(11.0, abs=0.002)
