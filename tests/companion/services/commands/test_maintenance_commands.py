"""Commands of the workshop, as a station gives them to a boat in the water."""

import math

import pytest
from boat_rig import FAILED, HOME_ITEM, OK, UNSUPPORTED, Peer, Rig, waypoint

from companion.core.readings import HeadingReading
from companion.mavlink.dialect import dialect

CMD = dialect
LEFT, RIGHT, BOTH, TURN = 3, 4, 1, 2
PERCENT, PWM = 0, 1
REJECTED_FOR_NOW, IN_PROGRESS, CANCELLED = 1, 5, 6


class Gyro:
    """A compass whose readings the test sets; every tick a new one."""

    def __init__(self, heading_rad: float = 0.0, rate_rad_s: float | None = 0.0) -> None:
        self.heading_rad = heading_rad
        self.rate_rad_s = rate_rad_s
        self.time_s = 0.0

    def read(self) -> HeadingReading:
        self.time_s += 0.02
        return HeadingReading(self.time_s - 0.02, self.heading_rad, self.rate_rad_s)

    def close(self) -> None:
        """Nothing to let go."""


def motors(rig: Rig) -> tuple[float, float]:
    return rig.world._motors.left, rig.world._motors.right


def results(peer: Peer, number: int) -> list[int]:
    return [int(ack.result) for ack in peer.said("COMMAND_ACK") if ack.command == number]


def wants_restart(rig: Rig) -> bool:
    return rig.boat.wants_restart


def value(rig: Rig, name: str) -> float:
    index = rig.boat.parameters.index_of(name)
    assert index is not None
    return rig.boat.parameters.value(rig.boat.parameters.rows[index])


@pytest.fixture
def rig() -> Rig:
    """A boat that could be armed, with a mission."""
    rig = Rig().ready()
    rig.upload([HOME_ITEM, waypoint(40.0, 0.0), waypoint(40.0, 40.0)])
    return rig


@pytest.mark.parametrize(
    ("motor", "left", "right"), [(LEFT, 0.3, 0.0), (RIGHT, 0.0, 0.3), (BOTH, 0.3, 0.3), (TURN, 0.3, -0.3)]
)
def test_a_motor_turns_for_as_long_as_asked_and_no_other_does(
    rig: Rig, motor: int, left: float, right: float
) -> None:
    assert rig.ask(CMD.MAV_CMD_DO_MOTOR_TEST, motor, PERCENT, 30.0, 9.0) == OK
    assert len(rig.peer.texts) == 1
    assert rig.ask(CMD.MAV_CMD_DO_MOTOR_TEST, motor, PERCENT, 30.0, 2.0) == OK
    assert rig.peer.texts == [], "a station goes on with it several times a second"
    rig.run(1.9)
    assert motors(rig) == pytest.approx((left, right))
    assert not rig.boat.vehicle.armed
    assert rig.boat.endpoint._commands.is_busy, "looked after in every tick"
    rig.run(0.2)
    assert motors(rig) == (0.0, 0.0)
    assert not rig.boat.endpoint._commands.is_busy


@pytest.mark.parametrize(
    ("number", "params"),
    [
        (CMD.MAV_CMD_DO_MOTOR_TEST, (LEFT, PERCENT, 0.0, 0.0)),
        (CMD.MAV_CMD_COMPONENT_ARM_DISARM, (0.0, 21196.0)),
        (CMD.MAV_CMD_COMPONENT_ARM_DISARM, (1.0,)),
        (CMD.MAV_CMD_DO_SET_MODE, (1.0, 5.0)),
        (CMD.MAV_CMD_DO_FLIGHTTERMINATION, (1.0,)),
    ],
)
def test_anything_else_that_is_asked_ends_a_motor_test(
    rig: Rig, number: int, params: tuple[float, ...]
) -> None:
    rig.ask(CMD.MAV_CMD_DO_MOTOR_TEST, BOTH, PERCENT, 50.0, 20.0)
    rig.run(1.0)
    assert motors(rig) == (0.5, 0.5)
    rig.ask(number, *params)
    if not rig.boat.vehicle.armed:
        assert motors(rig) == (0.0, 0.0)  # before the next tick
    rig.step(15)
    assert motors(rig) == (0.0, 0.0)


def test_the_gyro_is_calibrated_in_a_while_and_its_bias_is_kept() -> None:
    gyro = Gyro(rate_rad_s=0.02)
    rig = Rig(compass=gyro)
    rig.run(1.0)
    rig.peer.forget()
    rig.peer.command(CMD.MAV_CMD_PREFLIGHT_CALIBRATION, 1)
    rig.run(2.5)
    assert set(results(rig.peer, CMD.MAV_CMD_PREFLIGHT_CALIBRATION)) == {IN_PROGRESS}
    progress = [ack.progress for ack in rig.peer.said("COMMAND_ACK")]
    assert progress == sorted(progress)
    assert progress[-1] > 50
    rig.run(1.0)
    assert results(rig.peer, CMD.MAV_CMD_PREFLIGHT_CALIBRATION)[-1] == OK
    assert "Gyro calibrated" in rig.peer.texts
    assert [said.param_id for said in rig.peer.said("PARAM_VALUE")] == ["INS_GYROFFS_Z"]
    assert value(rig, "INS_GYROFFS_Z") == pytest.approx(0.02, rel=1e-3)
    rig.run(0.1)
    assert rig.boat.nav is not None
    reading = rig.boat.sensors.heading
    assert reading is not None
    assert reading.yaw_rate_rad_s == pytest.approx(0.0, abs=1e-6)
    assert rig.boat.nav.yaw_rate_rad_s == pytest.approx(0.0, abs=1e-3)  # the fresh filter estimates a bias
    rig.reboot()
    assert value(rig, "INS_GYROFFS_Z") == pytest.approx(0.02, rel=1e-3)


@pytest.mark.parametrize(
    ("rate_rad_s", "text"),
    [(0.21, "Gyro: the boat moved, not calibrated"), (None, "Gyro: the compass measures no yaw rate")],
)
def test_a_gyro_that_turns_or_measures_nothing_keeps_its_bias(rate_rad_s: float | None, text: str) -> None:
    rig = Rig(compass=Gyro(rate_rad_s=rate_rad_s))
    rig.run(1.0)
    assert rig.ask(CMD.MAV_CMD_PREFLIGHT_CALIBRATION, 1) == IN_PROGRESS
    rig.run(3.5)
    assert results(rig.peer, CMD.MAV_CMD_PREFLIGHT_CALIBRATION)[-1] == FAILED
    assert text in rig.peer.texts
    assert value(rig, "INS_GYROFFS_Z") == 0.0


def test_a_station_may_calibrate_a_radio_that_is_fitted_for_ten_minutes_while_disarmed() -> None:
    rig = Rig("open", "sensors.rc.fitted=true").ready()
    radio = rig.boat.vehicle.manual_input.rc
    assert rig.ask(CMD.MAV_CMD_PREFLIGHT_CALIBRATION, 1, 0, 0, 1) == UNSUPPORTED  # one thing at a time
    assert radio.calibrated_until_s < rig.now_s
    assert rig.ask(CMD.MAV_CMD_PREFLIGHT_CALIBRATION, 0, 0, 0, 1) == OK
    assert radio.calibrated_until_s == pytest.approx(rig.now_s + 600.0, abs=0.1)
    assert rig.ask(CMD.MAV_CMD_PREFLIGHT_CALIBRATION) == OK
    assert radio.calibrated_until_s < rig.now_s
    assert rig.ask(CMD.MAV_CMD_COMPONENT_ARM_DISARM, 1.0, 2989.0) == OK
    assert rig.ask(CMD.MAV_CMD_PREFLIGHT_CALIBRATION, 0, 0, 0, 1) == REJECTED_FOR_NOW


def test_a_calibration_can_be_given_up_and_ends_when_the_boat_is_armed() -> None:
    rig = Rig(compass=Gyro()).ready()
    rig.ask(CMD.MAV_CMD_PREFLIGHT_CALIBRATION, 1)
    assert rig.ask(CMD.MAV_CMD_PREFLIGHT_CALIBRATION, 0) == CANCELLED
    rig.peer.forget()
    rig.run(5.0)
    assert not results(rig.peer, CMD.MAV_CMD_PREFLIGHT_CALIBRATION)
    assert "Gyro calibrated" not in rig.peer.texts
    rig.ask(CMD.MAV_CMD_PREFLIGHT_CALIBRATION, 1)
    rig.arm()
    rig.run(1.0)
    assert results(rig.peer, CMD.MAV_CMD_PREFLIGHT_CALIBRATION) == [CANCELLED]
    assert rig.ask(CMD.MAV_CMD_PREFLIGHT_CALIBRATION, 1) == REJECTED_FOR_NOW


def test_the_compass_is_trimmed_to_the_heading_that_the_operator_gives() -> None:
    rig = Rig(compass=Gyro(heading_rad=math.radians(100.0)))
    rig.run(1.0)
    assert rig.ask(CMD.MAV_CMD_FIXED_MAG_CAL_YAW, 90.0) == OK
    rig.run(4.0)
    assert rig.boat.nav is not None
    assert math.degrees(rig.boat.nav.heading_rad) == pytest.approx(90.0, abs=0.5)
    assert value(rig, "HDG_TRIM") == pytest.approx(-10.0, abs=0.01)
    assert rig.ask(CMD.MAV_CMD_FIXED_MAG_CAL_YAW, 90.0) == OK
    assert value(rig, "HDG_TRIM") == pytest.approx(-10.0, abs=0.01)
    assert rig.arm() == OK
    assert rig.ask(CMD.MAV_CMD_FIXED_MAG_CAL_YAW, 80.0) == REJECTED_FOR_NOW
    assert value(rig, "HDG_TRIM") == pytest.approx(-10.0, abs=0.01)
    assert "Compass: disarm first" in rig.peer.texts


def test_parameters_go_back_to_the_boats_file_and_stay_there(rig: Rig) -> None:
    default = value(rig, "WP_RADIUS")
    rig.boat.parameters.set("WP_RADIUS", default + 1.0)
    rig.step()  # which says so
    rig.arm()
    assert rig.ask(CMD.MAV_CMD_PREFLIGHT_STORAGE, 2) == REJECTED_FOR_NOW
    rig.ask(CMD.MAV_CMD_COMPONENT_ARM_DISARM, 0)
    assert rig.ask(CMD.MAV_CMD_PREFLIGHT_STORAGE, 1) == OK
    assert value(rig, "WP_RADIUS") == default + 1.0
    assert rig.ask(CMD.MAV_CMD_PREFLIGHT_STORAGE, 2) == OK
    assert [said.param_id for said in rig.peer.said("PARAM_VALUE")] == ["WP_RADIUS"]
    assert value(rig, "WP_RADIUS") == default
    rig.reboot()
    assert value(rig, "WP_RADIUS") == default


def test_a_restart_is_asked_of_the_program_once_the_answer_is_out_and_never_while_armed(rig: Rig) -> None:
    rig.arm()
    assert rig.ask(CMD.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1) == FAILED
    rig.run(2.0)
    assert not wants_restart(rig)
    rig.ask(CMD.MAV_CMD_COMPONENT_ARM_DISARM, 0)
    assert rig.ask(CMD.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1) == OK
    rig.step()
    assert not wants_restart(rig)
    rig.run(1.0)
    assert wants_restart(rig)
    rig.reboot()
    rig.step()
    assert not wants_restart(rig)


def test_pause_keeps_station_and_continue_goes_on_with_what_was_paused(rig: Rig) -> None:
    rig.arm()
    rig.ask(CMD.MAV_CMD_MISSION_START)
    rig.run(3.0)
    assert rig.ask(CMD.MAV_CMD_DO_PAUSE_CONTINUE, 0) == OK
    assert rig.mode == "LOITER"
    assert rig.ask(CMD.MAV_CMD_DO_PAUSE_CONTINUE, 1) == OK
    assert rig.mode == "AUTO"


def test_a_resent_start_does_not_begin_the_mission_anew(rig: Rig) -> None:
    rig.arm()
    assert rig.ask(CMD.MAV_CMD_MISSION_START, 1) == OK
    rig.run(0.5)
    rig.boat.vehicle.progress.set_current(2)
    assert rig.ask(CMD.MAV_CMD_MISSION_START, 1) == OK
    assert rig.boat.vehicle.progress.current_seq == 2
    rig.run(2.1)
    assert rig.ask(CMD.MAV_CMD_MISSION_START, 1) == OK
    assert rig.boat.vehicle.progress.current_seq == 1


def test_a_start_repeated_after_something_else_happened_is_meant(rig: Rig) -> None:
    rig.arm()
    rig.ask(CMD.MAV_CMD_MISSION_START, 1)
    rig.set_mode(4)
    assert rig.ask(CMD.MAV_CMD_MISSION_START, 1) == OK
    assert rig.mode == "AUTO"


def test_a_command_given_anew_whose_first_frame_is_lost_is_no_repetition_of_the_earlier_one(
    rig: Rig,
) -> None:
    def set_mode(number: int, repetition: int) -> int:
        rest = [1, number, *[0.0] * 5]
        message = dialect.MAVLink_command_long_message(1, 1, CMD.MAV_CMD_DO_SET_MODE, repetition, *rest)
        return int(rig.answer_to(message, "COMMAND_ACK").result)

    hold, rtl = 4, 11
    rig.arm()
    assert [set_mode(number, 0) for number in (hold, rtl)] == [OK, OK]
    assert set_mode(hold, 1) == OK
    assert rig.mode == "HOLD"


def test_a_late_repetition_does_not_undo_what_another_station_has_commanded(rig: Rig) -> None:
    def send(repetition: int) -> int:
        command = CMD.MAV_CMD_NAV_RETURN_TO_LAUNCH
        message = dialect.MAVLink_command_long_message(1, 1, command, repetition, *[0.0] * 7)
        return int(rig.answer_to(message, "COMMAND_ACK").result)

    rig.arm()
    rig.run(1.0)
    assert send(1) == OK  # the first got lost
    assert rig.mode == "RTL"
    rig.run(3.0)
    rig.set_mode(4)
    assert send(2) == OK, "it is acknowledged"
    assert rig.mode == "HOLD"
    assert send(1) == OK, "this one is no repetition: its count has not grown"
    assert rig.mode == "RTL"
    rig.set_mode(4)
    rig.run(16.0)
    assert send(9) == OK
    assert rig.mode == "RTL"


def test_pre_arm_checks_are_run_and_told_when_asked() -> None:
    rig = Rig(config={"arming.battery_min_v": 50.0})
    rig.run(1.0)
    assert rig.ask(CMD.MAV_CMD_RUN_PREARM_CHECKS) == OK
    assert any(text.startswith("PreArm: Battery") for text in rig.peer.texts)
    rig.arm(force=True)
    assert rig.ask(CMD.MAV_CMD_RUN_PREARM_CHECKS) == REJECTED_FOR_NOW
