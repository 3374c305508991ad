"""BNO055 and INA219 over twins that behave as the parts' own drivers do."""

import math
import sys
import types

import pytest
from hardware_twins import HandClock

from companion import parts
from companion.errors import HardwareError
from companion.hal.battery import Ina219Battery, open_ina219
from companion.hal.compass import Bno055Compass, open_bno055

NDOF, CONFIG = 0x0C, 0x00


class FakeBno055:
    """Measures only in NDOF mode; a dip of the supply sends it back to configuration mode, uncalibrated."""

    def __init__(self) -> None:
        self.mode = NDOF
        self.heading_deg = 90.0
        self.rate_rad_s = 0.1
        self.magnet = 3

    def brown_out(self) -> None:
        self.mode, self.magnet = CONFIG, 0

    @property
    def euler(self) -> tuple[float | None, float | None, float | None]:
        return (self.heading_deg, 1.0, 2.0) if self.mode == NDOF else (None, None, None)

    @property
    def gyro(self) -> tuple[float | None, float | None, float | None]:
        return (0.0, 0.0, self.rate_rad_s) if self.mode == NDOF else (None, None, None)

    @property
    def calibration_status(self) -> tuple[int, int, int, int]:
        return 3, 3, 3, self.magnet


class FakeIna219:
    """An 11.1 V pack behind a 0.1 Ω shunt."""

    def __init__(self) -> None:
        self.bus_voltage = 11.0
        self.shunt_voltage = 0.15
        self.current = 1500.0
        self.overflow = 0


def steps(compass: Bno055Compass, count: int) -> None:
    for _ in range(count):
        assert 0.0 < compass.step() < 0.1


def test_heading_and_rate_are_clockwise_and_corrected() -> None:
    part, clock = FakeBno055(), HandClock()
    compass = Bno055Compass(part, clock, correction_rad=math.radians(-3.0))
    assert compass.read() is None
    steps(compass, 2)
    reading = compass.read()
    assert reading is not None
    assert reading.time_s == clock()
    assert math.degrees(reading.heading_rad) == pytest.approx(87.0)
    assert reading.yaw_rate_rad_s == pytest.approx(-0.1)  # z is up: counter-clockwise is positive there


def test_no_heading_counts_before_the_magnetometer_is_calibrated() -> None:
    part = FakeBno055()
    part.magnet = 0
    compass = Bno055Compass(part, HandClock())
    steps(compass, 5)
    assert compass.read() is None
    part.magnet = 1
    steps(compass, 2)
    assert compass.read() is not None
    part.magnet, part.heading_deg = 0, 180.0
    steps(compass, 1)
    reading = compass.read()
    assert reading is not None
    assert abs(reading.heading_rad) == pytest.approx(math.pi)


def test_a_part_that_lost_its_mode_is_set_up_again_and_must_find_north_again() -> None:
    part, clock = FakeBno055(), HandClock()
    compass = Bno055Compass(part, clock)
    steps(compass, 2)
    before = compass.read()
    part.brown_out()
    clock.advance(1.0)
    part.heading_deg = 0.0
    steps(compass, 5)
    assert part.mode == NDOF
    assert compass.read() is before
    part.magnet = 2
    steps(compass, 2)
    after = compass.read()
    assert after is not None
    assert after.time_s == clock()


def test_a_heading_off_the_scale_is_ignored() -> None:
    part = FakeBno055()
    compass = Bno055Compass(part, HandClock())
    steps(compass, 2)
    before = compass.read()
    part.heading_deg = 4095.9
    steps(compass, 1)
    assert compass.read() is before


def test_the_packs_voltage_is_what_is_before_the_shunt() -> None:
    clock = HandClock()
    battery = Ina219Battery(FakeIna219(), clock)
    assert battery.read() is None
    battery.step()
    reading = battery.read()
    assert reading is not None
    assert reading.time_s == clock()
    assert reading.voltage_v == pytest.approx(11.15)
    assert reading.current_a == pytest.approx(1.5)


def test_a_current_beyond_the_shunt_is_unknown() -> None:
    part = FakeIna219()
    part.overflow = 1
    battery = Ina219Battery(part, HandClock())
    battery.step()
    reading = battery.read()
    assert reading is not None
    assert reading.current_a is None


def test_the_factories_read_the_parts_on_the_bus_they_find(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple[object, ...]] = []

    def made(part: object, *arguments: object) -> object:
        asked.append(arguments)
        return part

    board = types.SimpleNamespace(I2C=lambda: "bus")
    monkeypatch.setitem(sys.modules, "board", board)
    bno055 = types.SimpleNamespace(BNO055_I2C=lambda *arguments: made(FakeBno055(), *arguments))
    ina219 = types.SimpleNamespace(INA219=lambda *arguments: made(FakeIna219(), *arguments))
    monkeypatch.setitem(sys.modules, "adafruit_bno055", bno055)
    monkeypatch.setitem(sys.modules, "adafruit_ina219", ina219)
    open_bno055(parts.CompassPart(driver="bno055"), HandClock()).close()
    open_ina219(parts.BatteryPart(driver="ina219", address=0x41), HandClock()).close()
    assert asked == [("bus",), ("bus", 0x41)]


def test_a_missing_library_or_a_silent_part_is_told_in_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "board", None)
    with pytest.raises(
        HardwareError, match=r"BNO055: the Python module 'board' is missing; install mavboat\[pi\]"
    ):
        open_bno055(parts.CompassPart(), HandClock())

    def nobody() -> object:
        raise ValueError("No I2C device at address: 0x40")

    monkeypatch.setitem(sys.modules, "board", types.SimpleNamespace(I2C=nobody))
    monkeypatch.setitem(sys.modules, "adafruit_ina219", types.SimpleNamespace())
    with pytest.raises(HardwareError, match="INA219: nothing usable at I²C address 0x40"):
        open_ina219(parts.BatteryPart(), HandClock())
