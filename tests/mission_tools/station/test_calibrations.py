"""Calibrations from the page, on real boats, to their ends and through broken links."""

import math

import pytest
from boat_rig import OK, Rig
from shore_rig import Shore

from companion.core.requests import ManualControl
from companion.mavlink.dialect import dialect
from mission_tools.station.messages import Calibration
from mission_tools.station.setup.calibrations import NOTHING_TO_KEEP, UNDER_WAY

MANUAL, HOLD, LOITER = 0, 4, 5
MAGNETOMETER = (
    "sensors.compass.magnetometer_mg=203.0",
    "sensors.compass.hard_iron_deg=25.0",
    "sensors.compass.soft_iron_deg=5.0",
    "sensors.compass.motor_deg_per_a=2.0",
    "sensors.compass.declination_deg=2.0",
    "sensors.compass.bias_deg=0.0",
    "sensors.compass.turn_tilt_share=0.0",
    "sensors.sonar.fitted=false",
    "vehicle.parts.compass.correction_rad=0.0",
    "vehicle.parts.compass.declination_rad=0.0349",
    "seed=4",
)


def shore_of(*settings: str, loss: float = 0.0) -> Shore:
    shore = Shore(Rig("open", *settings), loss=loss, seed=2)
    shore.until(lambda: bool(shore.boats.names()), 20.0)
    shore.run(6.0)
    return shore


def state(shore: Shore) -> Calibration:
    calibration = shore.snapshot().calibration
    assert calibration is not None
    return calibration


def parameter(rig: Rig, name: str) -> float:
    """A value as stations see it."""
    (value,) = [rig.boat.parameters.value(row) for row in rig.boat.parameters.rows if row.name == name]
    return value


def circle(shore: Shore, seconds: float = 60.0) -> list[int]:
    """The boat turns; the progress shown."""
    (rig,) = shore.rigs
    shown: list[int] = []
    for _ in range(round(seconds / 0.2)):
        rig.boat.vehicle.request(ManualControl(0.2, 0.5))
        shore.run(0.2)
        shown += [percent for percent in [state(shore).percent] if percent is not None]
        if state(shore).state in ("waiting", "failed"):
            break
    return shown


def sail_by_hand(shore: Shore) -> None:
    """Another station's hand arms in MANUAL, so that the boat turns by its own power."""
    (rig,) = shore.rigs
    assert rig.set_mode(MANUAL) == OK
    assert rig.arm() == OK
    shore.run(1.5)


def test_the_compass_is_calibrated_with_progress_and_its_result_kept_when_asked() -> None:
    shore = shore_of(*MAGNETOMETER, loss=0.3)
    (rig,) = shore.rigs
    answer = shore.ask("calibrate_compass")
    assert answer.ok, answer
    assert state(shore).state == "running"
    sail_by_hand(shore)
    shown = circle(shore)
    assert state(shore).state == "waiting", state(shore)
    assert shown == sorted(shown)
    assert shown[0] < 20
    assert len(set(shown)) > 8
    shore.run(4.0)  # the text may come before the report, which the boat repeats
    error, offset = state(shore).error_mg, state(shore).offset_mg
    assert error is not None
    assert error < 16.0
    assert offset is not None
    assert math.hypot(*offset[:2]) > 30.0  # the boat's iron
    assert parameter(rig, "COMPASS_OFS_X") == 0.0  # not before it is kept
    assert rig.boat.vehicle.armed
    assert shore.ask("disarm").ok
    shore.run(2.5)
    assert shore.ask("calibrate_accept").ok
    assert state(shore).state == "done"
    assert parameter(rig, "COMPASS_OFS_X") == pytest.approx(offset[0], abs=0.1)
    assert shore.ask("calibrate_accept").text == NOTHING_TO_KEEP
    shore.ends[0].loss = 0.0
    measure_the_motors_field(shore)


def measure_the_motors_field(shore: Shore) -> None:
    """By motor tests of a calibrated boat."""
    assert shore.ask("calibrate_motor_field").ok
    for press, percent in enumerate((15.0, 30.0, 50.0, 30.0, 15.0)):
        for number in range(10):
            held_s = number * 0.3
            shore.send("motor", {"motor": "both", "percent": percent, "press": f"{press}", "held_s": held_s})
            shore.run(0.3)
    assert state(shore).state == "running"
    assert shore.ask("motor_stop").ok
    shore.until(lambda: state(shore).state == "done", 8.0)
    assert state(shore).text.startswith("Compass: motors' field by current")
    assert parameter(shore.rigs[0], "COMPASS_MOTCT") == 2.0


def test_the_gyro_is_calibrated_in_three_seconds() -> None:
    shore = shore_of("sensors.compass.gyro_bias_deg_s=1.5")
    (rig,) = shore.rigs
    assert shore.ask("calibrate_gyro").ok
    shore.until(lambda: state(shore).state == "done", 5.0)
    assert state(shore).text == "Gyro calibrated"
    assert parameter(rig, "INS_GYROFFS_Z") == pytest.approx(math.radians(1.5), abs=0.01)


def test_a_boat_that_moves_does_not_calibrate_its_gyro() -> None:
    shore = shore_of()
    (rig,) = shore.rigs
    assert shore.ask("calibrate_gyro").ok
    shore.run(0.5)
    assert rig.ask(dialect.MAV_CMD_DO_MOTOR_TEST, 2, 0, 60.0, 10.0) == OK
    shore.until(lambda: state(shore).state == "failed", 8.0)
    assert state(shore).text == "Gyro: the boat moved, not calibrated"


def test_the_thrusters_calibration_needs_an_armed_boat_that_keeps_its_place() -> None:
    shore = Shore(Rig("open", "sensors.sonar.fitted=false")).ready()
    answer = shore.ask("calibrate_thrusters")
    assert (answer.ok, answer.text) == (False, "Thruster calibration: arm first")
    assert shore.ask("arm").ok
    assert shore.ask("calibrate_thrusters").text == "Thruster calibration: choose LOITER first"
    assert shore.ask("hold").ok
    shore.run(5.0)
    answer = shore.ask("calibrate_thrusters")
    assert answer.ok, answer
    shore.run(12.0)
    assert state(shore).state == "running"
    assert state(shore).percent
    assert shore.ask("calibrate_gyro").text == "The boat is armed: disarm it first."
    assert shore.ask("calibrate_heading").text == UNDER_WAY
    assert shore.ask("calibrate_cancel").ok
    assert state(shore).state == "cancelled"
    assert not shore.rigs[0].boat.calibration.is_running


def test_the_thrusters_calibration_that_the_boat_ends_is_told_with_its_reason() -> None:
    shore = Shore(Rig("open", "sensors.sonar.fitted=false")).ready()
    assert shore.ask("arm").ok
    assert shore.ask("hold").ok
    shore.run(5.0)
    assert shore.ask("calibrate_thrusters").ok
    shore.run(5.0)
    assert shore.ask("return").ok
    shore.until(lambda: state(shore).state == "failed", 5.0)
    assert state(shore).text.startswith("Thruster calibration aborted: ")
