"""A bare magnetometer beside steel and motor leads: calibrated afloat as QGroundControl asks for it, by
circles under the boat's own power, against the true heading.
"""

import math
import statistics
from pathlib import Path

import msgspec
import pytest
from boat_rig import BOAT, DENIED, FAILED, OK, Rig
from log_rig import of_kind, read_log
from sailing_rig import tells
from twins.qgc_compass import QgcCompassPage

from companion.core.modes import Mode
from companion.core.requests import ManualControl
from companion.core.storage import MemoryStorage
from companion.core.units import wrap_pi
from companion.log.records import HEADER
from companion.log.samples import motion
from companion.mavlink.dialect import dialect
from companion.sensors.compass.magnetic_field import MagneticCorrection

CMD = dialect
REJECTED_FOR_NOW, IN_PROGRESS, CANCELLED = 1, 5, 6
# Steel that turns the compass by up to 30°, and leads that turn it by 2° for each ampere
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


def fresh(*settings: str, storage: MemoryStorage | None = None) -> Rig:
    rig = Rig("open", *MAGNETOMETER, *settings, storage=storage)
    rig.run(6.0)
    return rig


def steer(rig: Rig, throttle: float, steering: float, seconds: float) -> list[float]:
    """By hand; the errors of the compass meanwhile, in degrees."""
    errors = []
    for _ in range(round(seconds / 0.2)):
        rig.boat.vehicle.request(ManualControl(throttle, steering))
        rig.run(0.2)
        heading = rig.boat.sensors.heading
        assert heading is not None
        errors.append(math.degrees(wrap_pi(heading.heading_rad - rig.world.truth.heading_rad)))
    return errors


def rms(errors: list[float]) -> float:
    return math.sqrt(statistics.fmean(error * error for error in errors))


def start(rig: Rig) -> None:
    """As QGroundControl does: a cancellation to see whether it is there, the threshold, the start."""
    assert rig.ask(CMD.MAV_CMD_DO_CANCEL_MAG_CAL) == OK
    rig.peer.send(dialect.MAVLink_param_set_message(*BOAT, b"COMPASS_CAL_FIT", 100.0, 9))
    rig.receive()
    assert rig.ask(CMD.MAV_CMD_DO_START_MAG_CAL, 1.0, 0.0, 1.0, 0.0, 0.0) == OK


def is_busy(rig: Rig) -> bool:
    """Whether the commands are looked after in every tick."""
    return rig.boat.endpoint._commands.is_busy


def test_circles_by_hand_from_qgroundcontrols_page_take_iron_and_motors_out(tmp_path: Path) -> None:
    rig = fresh(storage=MemoryStorage())
    page = QgcCompassPage(rig)
    needed_setup = page.needs_setup
    assert needed_setup
    assert rig.set_mode(Mode.MANUAL) == OK
    assert rig.arm() == OK
    assert rms(steer(rig, 0.2, 0.5, 15.0)) > 12.0
    page.press_ok()
    while not page.verdict:
        steer(rig, 0.2, 0.5, 1.0)
        page.listen()
        assert rig.now_s < 90.0
    assert page.verdict == "All compasses calibrated successfully", page.log
    assert page.bar == sorted(page.bar)
    assert page.bar[0] < 20.0
    assert page.bar[-1] > 80.0
    assert "Compass 0 calibration complete" in page.log
    (report,) = rig.peer.said("MAG_CAL_REPORT")[:1]
    assert (report.cal_status, report.compass_id, report.cal_mask, report.autosaved) == (4, 0, 1, 1)
    assert report.fitness < 8.0
    assert tells(rig, "Compass calibrated: error ")
    assert rms(steer(rig, 0.2, 0.5, 15.0)) < 2.0
    rig.run(6.0)
    assert 4 <= len(rig.peer.said("MAG_CAL_REPORT")) <= 6, "repeated for a lossy link"
    assert not page.needs_setup
    parameters = rig.boat.parameters
    values = {row.name: parameters.value(row) for row in parameters.rows}
    assert values["COMPASS_CAL_FIT"] == 16.0, "the page has given the limit back"
    assert values["COMPASS_OFS_X"] == pytest.approx(report.ofs_x, rel=1e-5)
    assert abs(values["COMPASS_OFS_X"]) > 20.0
    again = Rig("open", *MAGNETOMETER, storage=rig.storage)
    again.run(3.0)
    assert again.hardware.field is not None
    assert again.hardware.field.correction.offset[0] == pytest.approx(report.ofs_x, rel=1e-5)
    assert not again.boat.sensors.compass_fault()
    check_field(rig, tmp_path / "00001.bin")
    measure_motors(rig)
    assert rig.set_mode(Mode.LOITER) == OK
    rig.run(10.0)
    assert rig.boat.nav is not None
    off_rad = wrap_pi(rig.boat.nav.heading_rad - rig.world.truth.heading_rad)
    assert abs(math.degrees(off_rad)) < 5.0


def check_field(rig: Rig, path: Path) -> None:
    """The field that is told is the corrected one, and the log has both."""
    assert rig.ask(CMD.MAV_CMD_REQUEST_MESSAGE, dialect.MAVLINK_MSG_ID_RAW_IMU) == OK
    (imu,) = rig.peer.said("RAW_IMU")
    assert math.hypot(imu.xmag, imu.ymag) == pytest.approx(203.0, abs=20.0)
    assert imu.zmag > 300
    path.write_bytes(HEADER + b"".join(motion(rig.boat.take_snapshot())))
    (mag,) = of_kind(read_log(path), "MAG")
    field = rig.boat.sensors.compass.field_mg if rig.boat.sensors.compass else None
    assert field is not None
    assert mag.MagX - mag.OfsX - mag.MOX == pytest.approx(field[0], abs=30.0)  # but for soft iron


def measure_motors(rig: Rig) -> None:
    """At the pier: the field of their leads is taken out."""
    assert rig.set_mode(Mode.MANUAL) == OK
    steer(rig, 0.0, 0.0, 5.0)
    rig.world.hold_position()
    loud = rms(steer(rig, 0.8, 0.0, 6.0))
    steer(rig, 0.0, 0.0, 4.0)
    assert rig.ask(CMD.MAV_CMD_PREFLIGHT_CALIBRATION, 0, 0, 0, 0, 0, 1) == IN_PROGRESS
    for step in range(10):
        steer(rig, 0.08 * step, 0.0, 1.0)
    steer(rig, 0.0, 0.0, 4.0)
    acks = [one for one in rig.peer.said("COMMAND_ACK") if one.command == CMD.MAV_CMD_PREFLIGHT_CALIBRATION]
    assert acks[-1].result == OK
    assert tells(rig, "Compass: motors' field by current, up to ")
    quiet = rms(steer(rig, 0.8, 0.0, 6.0))
    rig.world.release()
    steer(rig, 0.0, 0.0, 4.0)
    assert loud > 3.0
    assert quiet < min(0.5 * loud, 2.0)


def test_uncalibrated_only_manual_arms_and_an_autopilot_mode_refuses_a_calibration_and_ends_one() -> None:
    rig = fresh()
    loiter, manual = rig.boat.vehicle.mode.LOITER, rig.boat.vehicle.mode.MANUAL
    rig.boat.vehicle.mode = loiter
    assert rig.arm() == FAILED
    assert tells(rig, "Arm: Compass: not calibrated: start its")
    assert rig.ask(CMD.MAV_CMD_PREFLIGHT_CALIBRATION, 0, 0, 0, 0, 0, 1) == FAILED
    assert "Compass: calibrate it before the motors' field is measured" in rig.peer.texts
    rig.boat.vehicle.mode = manual
    assert rig.arm() == OK
    start(rig)
    rig.boat.vehicle.mode = loiter
    rig.peer.forget()
    rig.run(0.5)
    (report,) = rig.peer.said("MAG_CAL_REPORT")
    assert report.cal_status == 5
    assert rig.peer.texts[-1] == "Compass not calibrated: mode LOITER"
    rig.boat.vehicle.mode = loiter
    assert rig.ask(CMD.MAV_CMD_DO_START_MAG_CAL, 1.0, 0.0, 1.0) == REJECTED_FOR_NOW
    reading = rig.boat.sensors.compass
    assert reading is not None
    rig.boat.sensors.compass = msgspec.structs.replace(reading, is_magnetic=False)  # of two antennas
    assert not rig.boat.sensors.compass_fault(), "a magnetometer in reserve"


def test_another_compass_is_denied_and_a_cancellation_ends_a_calibration_and_a_measurement() -> None:
    rig = fresh()
    assert rig.ask(CMD.MAV_CMD_DO_START_MAG_CAL, 2.0) == DENIED
    start(rig)
    assert is_busy(rig), "every reading counts"
    assert rig.ask(CMD.MAV_CMD_DO_CANCEL_MAG_CAL) == OK
    assert not is_busy(rig)
    rig.peer.forget()
    rig.run(3.0)
    assert not rig.peer.said("MAG_CAL_PROGRESS")
    assert not rig.peer.said("MAG_CAL_REPORT")
    assert rig.ask(CMD.MAV_CMD_DO_ACCEPT_MAG_CAL) == FAILED
    assert rig.hardware.field is not None
    rig.hardware.field.correction = MagneticCorrection(offset=(1.0, 2.0, 3.0))
    rig.set_mode(Mode.MANUAL)
    rig.boat.vehicle.armed = True
    assert rig.ask(CMD.MAV_CMD_PREFLIGHT_CALIBRATION, 0, 0, 0, 0, 0, 1) == IN_PROGRESS
    assert is_busy(rig)
    assert rig.ask(CMD.MAV_CMD_PREFLIGHT_CALIBRATION) == CANCELLED
    assert not is_busy(rig)
    assert rig.ask(CMD.MAV_CMD_PREFLIGHT_CALIBRATION, 0, 0, 0, 0, 0, 1) == IN_PROGRESS
    rig.peer.forget()
    rig.boat.vehicle.mode = rig.boat.vehicle.mode.LOITER
    rig.run(0.1)
    assert [one.result for one in rig.peer.said("COMMAND_ACK")] == [CANCELLED]


def test_a_result_waits_to_be_accepted_if_asked_to() -> None:
    rig = fresh()
    rig.set_mode(Mode.MANUAL)
    rig.arm()
    assert rig.hardware.field is not None
    assert rig.ask(CMD.MAV_CMD_DO_START_MAG_CAL, 0.0, 0.0, 0.0) == OK
    rig.peer.forget()
    while not rig.peer.said("MAG_CAL_REPORT"):
        steer(rig, 0.2, 0.5, 1.0)
        assert rig.now_s < 70.0, "no report"
    assert not rig.hardware.field.correction.is_calibrated
    assert rig.ask(CMD.MAV_CMD_DO_ACCEPT_MAG_CAL) == OK
    assert rig.hardware.field.correction.is_calibrated


def test_one_known_heading_calibrates_a_boat_that_cannot_be_turned() -> None:
    rig = fresh("sensors.compass.soft_iron_deg=0.0", "sensors.compass.motor_deg_per_a=0.0")
    true_deg = math.degrees(rig.world.truth.heading_rad)
    assert rig.ask(CMD.MAV_CMD_FIXED_MAG_CAL_YAW, true_deg, 1.0) == OK
    rig.set_mode(Mode.MANUAL)
    assert rig.arm() == OK
    assert rms(steer(rig, 0.2, 0.5, 12.0)) < 2.5
    assert rig.ask(CMD.MAV_CMD_FIXED_MAG_CAL_YAW, true_deg, 1.0) == REJECTED_FOR_NOW


def test_a_field_that_is_not_the_earths_does_not_arm() -> None:
    rig = fresh()
    field, reading, earth = rig.hardware.field, rig.boat.sensors.compass, rig.boat.sensors.earth.field
    assert field is not None
    assert reading is not None
    assert reading.field_mg is not None
    assert earth is not None
    x, y, _ = reading.field_mg
    for share, is_refused in ((0.5, True), (0.7, False), (1.4, False), (1.6, True)):
        field.correction = MagneticCorrection(offset=(share * earth.horizontal_mg - x, -y, 0.0))
        fault = rig.boat.sensors.compass_fault()
        assert bool(fault) is is_refused, fault
        if is_refused:
            assert fault.startswith(f"field of {share * earth.horizontal_mg:.0f} mG, not 2")
