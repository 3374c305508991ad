"""What a fault makes of any sensor's readings: missing, late or garbled."""

import math

from companion.core.readings import BatteryReading
from sitl.world.sampling import generator
from sitl.world.sensors.fault import SensorFault

READINGS = [BatteryReading(0.1 * number, 12.0 + 0.1 * number, 1.0) for number in range(40)]


def fault(kind: str, size: float) -> SensorFault[BatteryReading]:
    return SensorFault(kind, size, 0.0, 0.0, generator(1, "fault"))


def outputs(kind: str, size: float) -> list[BatteryReading | None]:
    faulty = fault(kind, size)
    return [faulty.output_at(reading, reading.time_s) for reading in READINGS]


def test_a_slow_sensor_gives_every_so_many_readings_and_a_silent_one_none() -> None:
    assert [one for one in outputs("slow", 10.0) if one] == READINGS[9::10]
    assert set(outputs("off", 0.0)) == {None}


def test_an_intermittent_sensor_is_silent_in_the_first_half_of_its_period() -> None:
    assert [one is not None for one in outputs("intermittent", 2.0)] == ([False] * 10 + [True] * 10) * 2


def test_a_delayed_sensor_says_what_was_and_stamps_it_as_new() -> None:
    late = outputs("delayed", 1.0)
    assert late[:10] == [None] * 10
    assert [(one.time_s, one.voltage_v) for one in late[11:] if one] == [
        (now.time_s, then.voltage_v) for now, then in zip(READINGS[11:], READINGS[1:], strict=False)
    ]


def test_a_corrupt_reading_has_a_field_garbled_or_is_old() -> None:
    none, every = fault("corrupt", 0.0), fault("corrupt", 1.0)
    assert all(none.corrupt(one, voltage_v=50.0, current_a=80.0) is one for one in READINGS)
    garbled = [every.corrupt(one, voltage_v=50.0, current_a=80.0) for one in READINGS]
    assert [one.time_s for one in garbled] == [one.time_s for one in READINGS]
    volts = [one.voltage_v for one in garbled]
    assert all(math.isnan(one) or -50.0 <= one <= 50.0 for one in volts)
    assert sum(volt != one.voltage_v for volt, one in zip(volts, READINGS, strict=True)) > 20
    assert {-50.0, 0.0} & set(volts)
    changed = [
        (one.voltage_v != was.voltage_v, one.current_a != was.current_a)
        for one, was in zip(garbled, READINGS, strict=True)
    ]
    assert changed.count((True, True)) > 5
    assert changed.count((True, False)) + changed.count((False, True)) > 5
