"""The driver of a magnetometer with gyro and accelerometer, on its bus, aboard the emulated boat. It
accelerates in turns, rolls in waves, has iron aboard, and steers by what the driver says.
"""

import math
import statistics
from pathlib import Path

import pytest
from boat_rig import HOME_ITEM, OK, Rig, waypoint
from twins.i2c import Part, plug_in
from twins.inertial import Mpu6050Twin
from twins.magnetics import Qmc5883lTwin, Scene

from companion.config.sensors import CompassPart
from companion.core.readings import HeadingReading
from companion.core.requests import ManualControl
from companion.core.units import wrap_pi
from companion.hal.heading.magnetic_compass import MagneticCompass, open_magnetic_compass
from companion.mavlink.dialect import dialect
from companion.sensors.compass.magnetic_field import FieldCorrector
from sitl.world.world import Truth, World

CMD = dialect
ROLL_DEG, ROLL_S, PITCH_DEG, PITCH_S = 5.0, 1.7, 2.0, 2.3  # of a metre's boat in small waves


class Aboard:
    """The compass as the boat reads it: one step of the driver's thread for each tick."""

    def __init__(self) -> None:
        self.world: World | None = None  # until the boat is afloat
        self.scene = Scene(self.now_s)
        self.scene.iron_mg, self.scene.gyro_bias_deg_s = (70.0, -40.0, 60.0), (1.5, -2.0, 2.5)
        self.corrector = FieldCorrector()
        self.driver: MagneticCompass | None = None
        self.before: Truth | None = None

    def now_s(self) -> float:
        return 0.0 if self.world is None else self.world.time_s

    def read(self) -> HeadingReading | None:
        if self.world is None or self.driver is None:
            return None
        truth, before = self.world.truth, self.before or self.world.truth
        self.before = truth
        if truth.time_s > before.time_s:
            self._move(truth, before)
            self.driver.step()
        return self.driver.read()

    def _move(self, truth: Truth, before: Truth) -> None:
        scene, dt_s, rate = self.scene, truth.time_s - before.time_s, truth.yaw_rate_rad_s
        scene.heading_deg, scene.yaw_rate_deg_s = math.degrees(truth.heading_rad), math.degrees(rate)
        scene.acceleration_m_s2 = (
            (truth.surge_m_s - before.surge_m_s) / dt_s - rate * truth.sway_m_s,
            (truth.sway_m_s - before.sway_m_s) / dt_s + rate * truth.surge_m_s,
            0.0,
        )
        roll, pitch = 2.0 * math.pi / ROLL_S, 2.0 * math.pi / PITCH_S
        scene.roll_deg = ROLL_DEG * math.sin(roll * truth.time_s)
        scene.roll_rate_deg_s = ROLL_DEG * roll * math.cos(roll * truth.time_s)
        scene.pitch_deg = PITCH_DEG * math.sin(pitch * truth.time_s)
        scene.pitch_rate_deg_s = PITCH_DEG * pitch * math.cos(pitch * truth.time_s)

    def close(self) -> None:
        if self.driver is not None:
            self.driver.close()


def error_deg(rig: Rig) -> float:
    heading = rig.boat.sensors.heading
    assert heading is not None
    return math.degrees(wrap_pi(heading.heading_rad - rig.world.truth.heading_rad))


def test_a_circle_afloat_is_accepted_and_a_square_sailed_by_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(MagneticCompass, "start", lambda self: self)
    aboard = Aboard()
    parts: dict[int, Part] = {0x0D: Qmc5883lTwin(aboard.scene), 0x68: Mpu6050Twin(aboard.scene)}
    plug_in(monkeypatch, tmp_path, parts)
    part = CompassPart(driver="qmc5883l", imu="mpu6050")
    aboard.driver = open_magnetic_compass(part, aboard.now_s, aboard.corrector)
    rig = Rig("open", "sensors.sonar.fitted=false", "seed=5", compass=aboard, field=aboard.corrector)
    aboard.world = rig.world
    rig.run(15.0)
    assert rig.set_mode(0) == OK
    assert rig.arm() == OK
    assert rig.ask(CMD.MAV_CMD_DO_START_MAG_CAL, 1.0, 0.0, 1.0) == OK
    while not rig.peer.said("MAG_CAL_REPORT"):
        rig.boat.vehicle.request(ManualControl(0.1, 0.35))
        rig.run(0.2)
        assert rig.now_s < 80.0
    (report,) = rig.peer.said("MAG_CAL_REPORT")[:1]
    assert report.cal_status == 4, rig.peer.texts
    assert report.fitness < 12.0
    rig.boat.vehicle.request(ManualControl(0.0, 0.0))
    rig.run(10.0)
    assert rig.set_mode(5) == OK
    square = [waypoint(20, 0), waypoint(20, 20), waypoint(0, 20)]
    rig.upload([HOME_ITEM, *square])
    assert rig.ask(CMD.MAV_CMD_MISSION_START) == OK
    errors, rates = [], []
    for _ in range(6000):
        rig.step()
        errors.append(error_deg(rig))
        reading, truth = rig.boat.sensors.compass, rig.world.truth
        assert reading is not None
        rates.append(math.degrees((reading.yaw_rate_rad_s or 0.0) - truth.yaw_rate_rad_s))
        if rig.mode != "AUTO":
            break
    assert rig.mode == "LOITER", rig.peer.texts
    assert math.sqrt(statistics.fmean(one * one for one in errors)) < 2.6  # measured: 1.3, and 3.1 at most
    assert max(map(abs, errors)) < 6.0
    assert abs(statistics.fmean(rates)) < 0.5
    assert not [text for text in rig.peer.texts if "Compass" in text and "lost" in text]
