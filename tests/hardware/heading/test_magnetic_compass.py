"""Magnetometers with a gyro and accelerometer, by their registers, through the real smbus2."""

import math
from collections.abc import Callable
from pathlib import Path

import pytest
from twins.i2c import plug_in
from twins.inertial import Mpu6050Twin
from twins.lines import HandClock
from twins.magnetic_bench import INERTIAL, MAGNETOMETERS, Bench
from twins.magnetics import Qmc5883lTwin, Scene, Triple

from companion.config.parts import CompassPart, Mounting
from companion.hal.heading.magnetic_compass import open_magnetic_compass
from companion.sensors.compass.magnetic_field import BY_CURRENT, FieldCorrector, MagneticCorrection, MotorLoad


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Bench:
    return Bench(monkeypatch, tmp_path)


@pytest.mark.parametrize("driver", MAGNETOMETERS)
@pytest.mark.parametrize("imu", INERTIAL)
def test_every_pair_of_parts_finds_the_heading_of_a_boat_that_heels_or_turns(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, driver: str, imu: str
) -> None:
    part = CompassPart(driver=driver, imu=imu)  # type: ignore[arg-type]
    bench = Bench(monkeypatch, tmp_path, part)
    bench.scene.heading_deg, bench.scene.roll_deg, bench.scene.pitch_deg = 70.0, 12.0, -5.0
    bench.run(12.0)
    assert abs(bench.error_deg) < 1.5
    assert math.degrees(bench.reading.roll_rad or 0.0) == pytest.approx(12.0, abs=0.5)
    assert math.degrees(bench.reading.pitch_rad or 0.0) == pytest.approx(-5.0, abs=0.5)
    bench = Bench(monkeypatch, tmp_path, part)
    bench.run(12.0)
    bench.scene.yaw_rate_deg_s = 20.0
    for _ in range(40):
        bench.run(0.5)
        assert abs(bench.error_deg) < 1.5
    assert math.degrees(bench.reading.yaw_rate_rad_s or 0.0) == pytest.approx(20.0, abs=0.5)
    assert bench.reading.is_magnetic


def test_the_field_is_reported_before_correction_in_body_axes(bench: Bench) -> None:
    bench.scene.heading_deg, bench.scene.iron_mg, bench.scene.noise_mg = 90.0, (30.0, -20.0, 10.0), 0.2
    bench.corrector.correction = MagneticCorrection(offset=(-30.0, 20.0, -10.0))
    bench.run(2.0)
    assert bench.reading.field_mg == pytest.approx((30.0, -220.0, 450.0), abs=2.0)
    assert abs(bench.error_deg) < 0.5


def test_the_field_of_the_motors_is_taken_out_by_their_current(bench: Bench) -> None:
    bench.scene.heading_deg = 0.0
    correction = MagneticCorrection((0.001, 0.0, 0.0), motor=(0.0, -8.0, 0.0), motor_source=BY_CURRENT)
    bench.corrector.correction = correction
    bench.scene.iron_mg = (0.0, 40.0, 0.0)  # of 5 A
    bench.run(5.0)
    assert bench.error_deg == pytest.approx(-11.3, abs=1.0)
    bench.corrector.load = MotorLoad(0.5, 5.0)
    bench.run(30.0)
    assert abs(bench.error_deg) < 1.0


def yawed(axes: Triple) -> Triple:
    """Of a board whose arrow points to starboard: ahead is its left."""
    x, y, z = axes  # ahead, port, up
    return -y, x, z


def overturned(axes: Triple) -> Triple:
    """Of a board rolled upside down: port is its right."""
    x, y, z = axes
    return x, -y, -z


@pytest.mark.parametrize(
    ("turned", "mounting"),
    [(yawed, Mounting(yaw_deg=90)), (overturned, Mounting(roll_deg=180))],
)
def test_boards_are_mounted_in_any_direction_each_its_own(
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    turned: Callable[[Triple], Triple],
    mounting: Mounting,
) -> None:
    for part, field_turned, motion_turned in (
        (CompassPart(driver="qmc5883l", imu="mpu6050", mounting=mounting), turned, lambda axes: axes),
        (CompassPart(driver="qmc5883l", imu="mpu6050", imu_mounting=mounting), lambda axes: axes, turned),
    ):
        bench = Bench(monkeypatch, tmp_path, part, field_turned, motion_turned)
        bench.scene.heading_deg, bench.scene.roll_deg, bench.scene.yaw_rate_deg_s = 40.0, 6.0, 0.0
        bench.run(11.0)
        assert abs(bench.error_deg) < 1.5
        assert math.degrees(bench.reading.roll_rad or 0.0) == pytest.approx(6.0, abs=0.5)
        bench.scene.roll_deg, bench.scene.yaw_rate_deg_s = 0.0, 15.0
        bench.run(5.0)
        assert math.degrees(bench.reading.yaw_rate_rad_s or 0.0) == pytest.approx(15.0, abs=1.0)


def test_a_large_bias_of_the_gyro_is_learned_within_ten_seconds(bench: Bench) -> None:
    bench.scene.gyro_bias_deg_s = (6.0, -15.0, 18.0)
    bench.run(10.0)
    assert abs(bench.error_deg) < 2.0
    assert abs(math.degrees(bench.reading.yaw_rate_rad_s or 0.0)) < 1.5
    assert abs(math.degrees(bench.reading.roll_rad or 0.0)) < 1.5


def test_a_bias_that_drifts_as_the_part_warms_up_is_followed(bench: Bench) -> None:
    bench.run(10.0)
    for step in range(120):  # ten degrees warmer, at 0.16 °/s for each (PS-MPU-6000A-00, 6.1)
        drift = 1.6 * step / 120.0
        bench.scene.gyro_bias_deg_s = (drift, drift, drift)
        bench.run(1.0)
        assert abs(bench.error_deg) < 4.0
    assert abs(math.degrees(bench.reading.yaw_rate_rad_s or 0.0)) < 1.2


def test_a_long_turn_does_not_tip_the_horizon_and_so_the_heading(bench: Bench) -> None:
    bench.run(15.0)
    rate_deg_s, speed_m_s = 25.0, 1.6
    bench.scene.yaw_rate_deg_s = rate_deg_s
    bench.scene.acceleration_m_s2 = (0.0, speed_m_s * math.radians(rate_deg_s), 0.0)  # to the centre
    for _ in range(60):
        bench.run(0.5)
        assert abs(bench.error_deg) < 4.0  # the apparent vertical is off by 4°, and 2.2 times that in heading


def test_without_a_gyro_a_level_boat_has_a_heading_but_no_rate(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    bench = Bench(monkeypatch, tmp_path, CompassPart(driver="lis3mdl"))
    bench.scene.heading_deg = 200.0
    bench.run(1.0)
    assert abs(bench.error_deg) < 2.0
    assert bench.reading.yaw_rate_rad_s is None
    assert bench.reading.roll_rad is None


def test_the_correction_is_added(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    part = CompassPart(driver="qmc5883l", imu="mpu6050", correction_rad=math.radians(-7.0))
    bench = Bench(monkeypatch, tmp_path, part)
    bench.run(3.0)
    assert bench.error_deg == pytest.approx(-7.0, abs=1.0)


def test_a_magnetometer_behind_the_mpu_is_connected_through(bench: Bench) -> None:
    assert isinstance(bench.motion, Mpu6050Twin)
    assert bench.motion.is_bypassed


def test_the_thread_ends_with_the_compass(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    clock = HandClock()
    plug_in(monkeypatch, tmp_path, {0x0D: Qmc5883lTwin(Scene(clock))})
    compass = open_magnetic_compass(CompassPart(driver="qmc5883l"), clock, FieldCorrector())
    assert compass._background._thread.is_alive()
    compass.close()
    compass.close()
    assert not compass._background._thread.is_alive()
