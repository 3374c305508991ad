"""A compass of a magnetometer and an inertial sensor on its bus, whose thread's steps the test calls."""

import math
from collections.abc import Callable
from pathlib import Path

import pytest

from companion.config.sensors import CompassPart
from companion.core.readings import HeadingReading
from companion.core.units import wrap_pi
from companion.hal.heading import magnetic_compass
from companion.hal.heading.magnetic_compass import MagneticCompass, open_magnetic_compass
from companion.sensors.compass.magnetic_field import FieldCorrector, MagneticCorrection
from twins.i2c import I2cDev, plug_in
from twins.inertial import Icm20948Twin, Lsm6dsTwin, Mpu6050Twin
from twins.lines import HandClock, known
from twins.magnetics import (
    Hmc5883lTwin,
    Lis3mdlTwin,
    MeasuringTwin,
    Qmc5883lTwin,
    Qmc5883pTwin,
    Scene,
    Triple,
)
from twins.pucks import Ak09916Twin, Ist8308Twin, Ist8310Twin, Rm3100Twin

MAGNETOMETERS: dict[str, type[MeasuringTwin]] = {
    "qmc5883l": Qmc5883lTwin,
    "qmc5883p": Qmc5883pTwin,
    "hmc5883l": Hmc5883lTwin,
    "lis3mdl": Lis3mdlTwin,
    "ist8310": Ist8310Twin,
    "ist8308": Ist8308Twin,
    "rm3100": Rm3100Twin,
    "ak09916": Ak09916Twin,
}
INERTIAL: dict[str, type[MeasuringTwin]] = {
    "mpu6050": Mpu6050Twin,
    "lsm6ds": Lsm6dsTwin,
    "icm20948": Icm20948Twin,
}
# Each part with one other: no driver knows what it is paired with
PAIRS = [
    ("qmc5883l", "mpu6050"),
    ("qmc5883p", "lsm6ds"),
    ("hmc5883l", "mpu6050"),
    ("lis3mdl", "lsm6ds"),
    ("ist8310", "mpu6050"),
    ("ist8308", "lsm6ds"),
    ("rm3100", "icm20948"),
    ("ak09916", "icm20948"),
]


class Bench:
    """A compass on its bus; its thread's steps are called by the test."""

    def __init__(
        self,
        monkeypatch: pytest.MonkeyPatch,
        tmp_path: Path,
        part: CompassPart | None = None,
        field_turned: Callable[[Triple], Triple] = lambda axes: axes,
        motion_turned: Callable[[Triple], Triple] = lambda axes: axes,
    ) -> None:
        self.part = part or CompassPart(driver="qmc5883l", imu="mpu6050")
        self.clock = HandClock()
        self.scene = Scene(self.clock)
        self.field = MAGNETOMETERS[self.part.driver](self.scene, field_turned)
        self.motion = INERTIAL.get(self.part.imu, Mpu6050Twin)(self.scene, motion_turned)
        if isinstance(self.field, Ak09916Twin) and isinstance(self.motion, Icm20948Twin):
            self.field.carrier = self.motion
        self.dev: I2cDev = plug_in(monkeypatch, tmp_path, {self.field.address: self.field})
        if self.part.imu != "none":
            self.dev.parts[self.motion.address] = self.motion
        self.corrector = FieldCorrector()
        self.corrector.correction = MagneticCorrection(offset=(0.001, 0.0, 0.0))
        monkeypatch.setattr(magnetic_compass.MagneticCompass, "start", lambda self: self)
        self.compass: MagneticCompass = open_magnetic_compass(
            self.part, self.clock, self.corrector, self.wait
        )

    def wait(self, seconds: float) -> None:
        """As the driver's thread does; the boat turns meanwhile."""
        self.scene.turn(seconds)
        self.clock.advance(seconds)

    def run(self, seconds: float) -> None:
        """Steps at the driver's period; the boat turns meanwhile."""
        for _ in range(round(seconds / 0.02)):
            self.scene.turn(0.02)
            self.clock.advance(0.02)
            assert 0.0 <= self.compass.step() <= 0.02

    @property
    def reading(self) -> HeadingReading:
        return known(self.compass.read())

    @property
    def error_deg(self) -> float:
        return math.degrees(wrap_pi(self.reading.heading_rad - math.radians(self.scene.heading_deg)))
