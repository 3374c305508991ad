"""Magnetometers with a gyro and accelerometer that fail: range, supply, stuck values, silence."""

import logging
import math
from pathlib import Path

import pytest
from twins.i2c import plug_in
from twins.inertial import Lsm6dsTwin, Mpu6050Twin, OtherTwin
from twins.lines import HandClock
from twins.magnetic_bench import PAIRS, Bench
from twins.magnetics import Hmc5883lTwin, Qmc5883lTwin, Scene

from companion.config.sensors import CompassPart
from companion.core.errors import HardwareError
from companion.hal.heading.magnetic_compass import open_magnetic_compass
from companion.sensors.compass.magnetic_field import FieldCorrector


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Bench:
    return Bench(monkeypatch, tmp_path)


def test_a_field_out_of_range_is_not_used_and_the_gyro_bridges_two_seconds(bench: Bench) -> None:
    bench.run(12.0)
    bench.scene.yaw_rate_deg_s = 10.0
    bench.scene.iron_mg = (20000.0, 0.0, 0.0)
    bench.run(1.9)
    assert abs(bench.error_deg) < 1.0
    last = bench.reading.time_s
    bench.run(1.0)
    assert bench.reading.time_s - last < 0.2  # no heading without a field
    bench.scene.iron_mg = (0.0, 0.0, 0.0)
    bench.run(1.0)
    assert bench.reading.time_s == bench.clock()
    assert abs(bench.error_deg) < 1.0


@pytest.mark.parametrize(("driver", "imu"), PAIRS)
def test_parts_whose_supply_dipped_are_set_up_again(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, driver: str, imu: str
) -> None:
    bench = Bench(monkeypatch, tmp_path, CompassPart(driver=driver, imu=imu))  # type: ignore[arg-type]
    bench.run(12.0)
    for part in (bench.field, bench.motion):
        part.power_up()
        bench.run(2.0)
        assert bench.reading.time_s == pytest.approx(bench.clock(), abs=0.03)
        assert abs(bench.error_deg) < 1.5


@pytest.mark.parametrize("which", ["field", "motion"])
def test_a_part_that_repeats_one_value_is_not_believed_and_set_up_again(
    bench: Bench, caplog: pytest.LogCaptureFixture, which: str
) -> None:
    caplog.set_level(logging.WARNING)
    bench.run(2.0)
    part = bench.field if which == "field" else bench.motion
    part.is_stuck = True
    setups = part.setups
    bench.run(8.0)
    assert part.setups > setups
    if which == "field":
        assert bench.clock() - bench.reading.time_s > 1.0
    else:
        assert bench.reading.yaw_rate_rad_s is None
    assert "no new measurements; it is set up again" in caplog.text
    part.is_stuck = False
    bench.run(2.0)
    assert bench.reading.time_s == bench.clock()
    assert bench.reading.yaw_rate_rad_s is not None


def texts(bench: Bench) -> list[str]:
    return [one.text for one in bench.compass.take_texts()]


def test_a_magnetometer_that_does_not_answer_costs_the_heading_after_two_seconds(bench: Bench) -> None:
    bench.run(12.0)
    bench.scene.yaw_rate_deg_s = 10.0
    del bench.dev.parts[bench.field.address]
    bench.run(1.5)
    assert bench.reading.time_s == bench.clock()
    assert abs(bench.error_deg) < 1.0  # by the gyro
    bench.run(2.0)
    assert bench.clock() - bench.reading.time_s > 1.0
    assert texts(bench) == ["Compass: QMC5883L is silent: no heading"]
    bench.dev.parts[bench.field.address] = bench.field
    bench.run(2.0)
    assert bench.reading.time_s == bench.clock()
    assert abs(bench.error_deg) < 1.5
    assert texts(bench) == ["Compass: QMC5883L answers again"]


def test_an_inertial_sensor_that_does_not_answer_leaves_the_heading_of_a_level_boat(bench: Bench) -> None:
    bench.run(12.0)
    del bench.dev.parts[bench.motion.address]
    bench.run(3.0)
    assert bench.reading.time_s == bench.clock()
    assert bench.reading.yaw_rate_rad_s is None
    assert abs(bench.error_deg) < 2.0
    assert texts(bench) == ["Compass: MPU-6050 is silent: level, no turn rate"]
    bench.motion.power_up()
    bench.dev.parts[bench.motion.address] = bench.motion
    bench.run(12.0)
    assert bench.reading.yaw_rate_rad_s == pytest.approx(0.0, abs=0.02)
    assert texts(bench) == ["Compass: MPU-6050 answers again"]


def test_parts_that_are_missing_or_others_are_told_in_one_line(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    clock = HandClock()
    scene = Scene(clock)
    mpu = Mpu6050Twin(scene)
    dev = plug_in(monkeypatch, tmp_path, {0x68: mpu})
    part = CompassPart(driver="qmc5883l", imu="mpu6050")
    with pytest.raises(HardwareError, match=r"QMC5883L: no answer at I²C address 0xd: .*121"):
        open_magnetic_compass(part, clock, FieldCorrector())
    dev.parts = {0x1C: Hmc5883lTwin(scene), 0x68: mpu}
    lis = CompassPart(driver="lis3mdl")
    with pytest.raises(HardwareError, match="LIS3MDL: the part at I²C address 0x1c says 0x0, not 0x3d"):
        open_magnetic_compass(lis, clock, FieldCorrector())
    dev.parts[0x68] = OtherTwin(0x33)
    told = "MPU-6050: the part at I²C address 0x68 says 0x33, not 0x68, and measures no gravity"
    with pytest.raises(HardwareError, match=told):
        open_magnetic_compass(part, clock, FieldCorrector(), clock.advance)


@pytest.mark.parametrize(
    "chip_id",
    [0x68, 0x70, 0x98, 0x42],  # 0x42 is no part of the maker's: it is tried
)
def test_a_part_that_does_what_an_mpu_6050_does_is_taken_for_one(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, chip_id: int
) -> None:
    monkeypatch.setattr(Mpu6050Twin, "chip_id", chip_id)
    bench = Bench(monkeypatch, tmp_path)
    bench.scene.roll_deg = 10.0
    bench.run(1.0)
    assert math.degrees(bench.reading.roll_rad or 0.0) == pytest.approx(10.0, abs=0.5)
    assert abs(bench.error_deg) < 1.0
    has_force_filter = chip_id != 0x68
    assert bench.motion.map[0x1D] == (0x03 if has_force_filter else 0x00)


@pytest.mark.parametrize("chip_id", [0x69, 0x6A, 0x6B, 0x6C])
def test_each_part_of_the_lsm6ds_family_measures_roll(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, chip_id: int
) -> None:
    monkeypatch.setattr(Lsm6dsTwin, "chip_id", chip_id)
    bench = Bench(monkeypatch, tmp_path, CompassPart(driver="qmc5883l", imu="lsm6ds"))
    bench.scene.roll_deg = 10.0
    bench.run(1.0)
    assert math.degrees(bench.reading.roll_rad or 0.0) == pytest.approx(10.0, abs=0.5)


@pytest.mark.parametrize("chip_id", [0x00, 0xFF])
def test_a_bus_that_is_held_is_not_taken_for_a_part(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, chip_id: int
) -> None:
    monkeypatch.setattr(Mpu6050Twin, "chip_id", chip_id)
    with pytest.raises(HardwareError, match=f"says {chip_id:#x}, not 0x68"):
        Bench(monkeypatch, tmp_path)


@pytest.mark.parametrize(("misreads", "is_taken"), [(0, True), (2, True), (3, False)])
def test_the_number_of_a_qmc5883l_is_asked_three_times(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, misreads: int, is_taken: bool
) -> None:
    monkeypatch.setattr(Qmc5883lTwin, "misreads", misreads)
    if is_taken:
        assert Bench(monkeypatch, tmp_path).field.map[0x09], "set up after the wait that follows its reset"
    else:
        with pytest.raises(HardwareError, match="QMC5883L: the part at I²C address 0xd says 0x0, not 0xff"):
            Bench(monkeypatch, tmp_path)
