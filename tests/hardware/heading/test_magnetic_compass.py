"""Magnetometers with a gyro and accelerometer, by their registers, through the real smbus2."""

import math
from collections.abc import Callable
from pathlib import Path

import pytest
from twins.magnetic_bench import PAIRS, Bench
from twins.magnetics import Triple

from companion.config.sensors import CompassPart, Mounting


@pytest.mark.parametrize(("driver", "imu"), PAIRS)
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
    for _ in range(20):
        bench.run(0.5)
        assert abs(bench.error_deg) < 1.5
    assert math.degrees(bench.reading.yaw_rate_rad_s or 0.0) == pytest.approx(20.0, abs=0.5)
    assert bench.reading.is_magnetic


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


def test_without_a_gyro_a_level_boat_has_a_heading_but_no_rate(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    bench = Bench(monkeypatch, tmp_path, CompassPart(driver="lis3mdl"))
    bench.scene.heading_deg = 200.0
    bench.run(1.0)
    assert abs(bench.error_deg) < 2.0
    assert bench.reading.yaw_rate_rad_s is None
    assert bench.reading.roll_rad is None
