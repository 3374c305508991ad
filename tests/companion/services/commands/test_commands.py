"""COMMAND_LONG and COMMAND_INT as stations send them; every answer must come before the next tick."""

import math

import pytest
from boat_rig import DENIED, FAILED, HOME_ITEM, OK, UNSUPPORTED, Rig, waypoint
from hypothesis import given, settings
from hypothesis import strategies as st

from companion.mavlink.dialect import dialect
from companion.services.commands.dispatcher import CommandService
from companion.services.commands.vehicle import REGIONS_OF_INTEREST
from companion.services.payload.rows import ROWS as PAYLOAD_ROWS

pytestmark = pytest.mark.slow

CMD = dialect
NAN = math.nan
E7 = 10_000_000
REJECTED_FOR_NOW, IN_PROGRESS = 1, 5


@pytest.fixture
def rig() -> Rig:
    """A boat that could be armed and has a mission of three items."""
    rig = Rig().ready()
    rig.upload([HOME_ITEM, waypoint(40.0, 0.0), waypoint(40.0, 40.0), waypoint(0.0, 40.0)])
    return rig


ROWS = [
    (CMD.MAV_CMD_COMPONENT_ARM_DISARM, (1,), OK),
    (CMD.MAV_CMD_COMPONENT_ARM_DISARM, (0,), OK),
    (CMD.MAV_CMD_COMPONENT_ARM_DISARM, (2,), DENIED),
    (CMD.MAV_CMD_DO_SET_MODE, (1, 10), OK),
    (CMD.MAV_CMD_DO_SET_MODE, (1, 16), FAILED),
    (CMD.MAV_CMD_DO_SET_MODE, (0, 4), DENIED),
    (CMD.MAV_CMD_DO_SET_MODE, (1, 4.5), DENIED),
    (CMD.MAV_CMD_MISSION_START, (), OK),
    (CMD.MAV_CMD_MISSION_START, (2,), OK),
    (CMD.MAV_CMD_MISSION_START, (4,), FAILED),
    (CMD.MAV_CMD_MISSION_START, (-1,), DENIED),
    (CMD.MAV_CMD_DO_SET_MISSION_CURRENT, (2,), OK),
    (CMD.MAV_CMD_DO_SET_MISSION_CURRENT, (4,), DENIED),
    (CMD.MAV_CMD_DO_CHANGE_SPEED, (1, 1.5), OK),
    (CMD.MAV_CMD_DO_CHANGE_SPEED, (1, 0), DENIED),
    (CMD.MAV_CMD_DO_CHANGE_SPEED, (1, -1), OK),
    (CMD.MAV_CMD_DO_CHANGE_SPEED, (1, -2), OK),
    (CMD.MAV_CMD_DO_CHANGE_SPEED, (2, 1), DENIED),
    (CMD.MAV_CMD_DO_CHANGE_SPEED, (1, NAN), DENIED),
    (CMD.MAV_CMD_DO_SET_HOME, (1,), OK),
    (CMD.MAV_CMD_DO_SET_HOME, (0, 0, 0, 0, 50.001, -1.2), OK),
    (CMD.MAV_CMD_DO_SET_HOME, (0,), DENIED),
    (CMD.MAV_CMD_DO_SET_HOME, (0, 0, 0, 0, NAN, -1.2), DENIED),
    (CMD.MAV_CMD_DO_REPOSITION, (-1, 1, 0, NAN, 50.001, -1.2), OK),
    (CMD.MAV_CMD_DO_REPOSITION, (-1, 0, 0, NAN, 50.001, -1.2), FAILED),
    (CMD.MAV_CMD_DO_REPOSITION, (-1, 1, 0, NAN, 0.0, 0.0), DENIED),
    (CMD.MAV_CMD_NAV_RETURN_TO_LAUNCH, (), OK),
    (CMD.MAV_CMD_NAV_LOITER_UNLIM, (), OK),
    (CMD.MAV_CMD_REQUEST_MESSAGE, (148,), OK),
    (CMD.MAV_CMD_REQUEST_MESSAGE, (280,), UNSUPPORTED),
    (CMD.MAV_CMD_REQUEST_MESSAGE, (NAN,), UNSUPPORTED),
    (CMD.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES, (1,), OK),
    (CMD.MAV_CMD_SET_MESSAGE_INTERVAL, (245, 1_000_000), OK),
    (CMD.MAV_CMD_SET_MESSAGE_INTERVAL, (233, 1_000_000), UNSUPPORTED),
    (CMD.MAV_CMD_SET_MESSAGE_INTERVAL, (30, NAN), UNSUPPORTED),
    (CMD.MAV_CMD_SET_MESSAGE_INTERVAL, (NAN, 0), DENIED),
    (CMD.MAV_CMD_GET_MESSAGE_INTERVAL, (30,), OK),
    (CMD.MAV_CMD_GET_MESSAGE_INTERVAL, (0,), OK),
    (CMD.MAV_CMD_GET_MESSAGE_INTERVAL, (70000,), DENIED),
    (CMD.MAV_CMD_GET_MESSAGE_INTERVAL, (-1,), DENIED),
    (CMD.MAV_CMD_PREFLIGHT_CALIBRATION, (), OK),
    (CMD.MAV_CMD_PREFLIGHT_CALIBRATION, (1,), IN_PROGRESS),
    (CMD.MAV_CMD_PREFLIGHT_CALIBRATION, (0, 1), UNSUPPORTED),
    (CMD.MAV_CMD_DO_AUTOTUNE_ENABLE, (0,), OK),
    (CMD.MAV_CMD_DO_AUTOTUNE_ENABLE, (1, 4), REJECTED_FOR_NOW),
    (CMD.MAV_CMD_DO_AUTOTUNE_ENABLE, (1, 2), DENIED),
    (CMD.MAV_CMD_DO_AUTOTUNE_ENABLE, (2,), DENIED),
    (CMD.MAV_CMD_USER_1, (0,), OK),
    (CMD.MAV_CMD_USER_1, (1, 40), REJECTED_FOR_NOW),
    (CMD.MAV_CMD_USER_1, (1, -40), DENIED),
    (CMD.MAV_CMD_USER_2, (0,), OK),
    (CMD.MAV_CMD_USER_2, (1, 40), REJECTED_FOR_NOW),
    (CMD.MAV_CMD_USER_2, (1, -40), DENIED),
    (CMD.MAV_CMD_USER_2, (2,), DENIED),
    (CMD.MAV_CMD_BATTERY_RESET, (1, 100), OK),
    (CMD.MAV_CMD_BATTERY_RESET, (NAN, 100), DENIED),
    (CMD.MAV_CMD_BATTERY_RESET, (1, 101), DENIED),
    (CMD.MAV_CMD_DO_CANCEL_MAG_CAL, (), UNSUPPORTED),
    (CMD.MAV_CMD_DO_START_MAG_CAL, (1, 0, 1), UNSUPPORTED),
    (CMD.MAV_CMD_FIXED_MAG_CAL_YAW, (90,), OK),
    (CMD.MAV_CMD_FIXED_MAG_CAL_YAW, (NAN,), DENIED),
    (CMD.MAV_CMD_DO_MOTOR_TEST, (3, 0, 20, 1), OK),
    (CMD.MAV_CMD_DO_MOTOR_TEST, (1, 1, 1600, 1), OK),
    (CMD.MAV_CMD_DO_MOTOR_TEST, (5, 0, 20, 1), DENIED),
    (CMD.MAV_CMD_DO_MOTOR_TEST, (3, 2, 20, 1), DENIED),
    (CMD.MAV_CMD_DO_MOTOR_TEST, (3, 0, 101, 1), DENIED),
    (CMD.MAV_CMD_DO_MOTOR_TEST, (3, 0, 20, -1), DENIED),
    (CMD.MAV_CMD_DO_MOTOR_TEST, (3, 0, 20, math.inf), DENIED),
    (CMD.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, (0,), OK),
    (CMD.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, (1,), OK),
    (CMD.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, (2,), UNSUPPORTED),
    (CMD.MAV_CMD_PREFLIGHT_STORAGE, (1,), OK),
    (CMD.MAV_CMD_PREFLIGHT_STORAGE, (2,), OK),
    (CMD.MAV_CMD_PREFLIGHT_STORAGE, (7,), DENIED),
    (CMD.MAV_CMD_INJECT_FAILURE, (4, 1, 0), OK),
    (CMD.MAV_CMD_INJECT_FAILURE, (4, 99, 0), UNSUPPORTED),
    (CMD.MAV_CMD_INJECT_FAILURE, (NAN, 1, 0), DENIED),
    (CMD.MAV_CMD_DO_FLIGHTTERMINATION, (1,), OK),
    (CMD.MAV_CMD_DO_FLIGHTTERMINATION, (0,), DENIED),
    (CMD.MAV_CMD_DO_PAUSE_CONTINUE, (0,), OK),
    (CMD.MAV_CMD_DO_PAUSE_CONTINUE, (1,), OK),
    (CMD.MAV_CMD_DO_PAUSE_CONTINUE, (2,), DENIED),
    (CMD.MAV_CMD_DO_FENCE_ENABLE, (0,), OK),
    (CMD.MAV_CMD_DO_FENCE_ENABLE, (1,), FAILED),
    (CMD.MAV_CMD_DO_SET_GLOBAL_ORIGIN, (0, 0, 0, 0, 50.0, -1.2), FAILED),
    (CMD.MAV_CMD_DO_SET_GLOBAL_ORIGIN, (), DENIED),
    (CMD.MAV_CMD_DO_SET_SERVO, (1, 1500), UNSUPPORTED),
    (CMD.MAV_CMD_DO_SET_REVERSE, (1,), UNSUPPORTED),
    (CMD.MAV_CMD_IMAGE_START_CAPTURE, (1,), UNSUPPORTED),
    (CMD.MAV_CMD_REQUEST_CAMERA_INFORMATION, (1,), UNSUPPORTED),
    (CMD.MAV_CMD_DO_SEND_BANNER, (), OK),
    (CMD.MAV_CMD_RUN_PREARM_CHECKS, (), OK),
    (CMD.MAV_CMD_GET_HOME_POSITION, (), OK),
    (CMD.MAV_CMD_DO_SET_MISSION_CURRENT, (-1, 1), OK),
    (CMD.MAV_CMD_DO_SET_MISSION_CURRENT, (-2,), DENIED),
    (CMD.MAV_CMD_REQUEST_PROTOCOL_VERSION, (1,), UNSUPPORTED),
    (65535, (), UNSUPPORTED),
]


TAKEN = [row for row in ROWS if row[2] in (OK, IN_PROGRESS)]


@pytest.mark.parametrize(("number", "params", "result"), TAKEN, ids=str)
def test_a_command_is_answered_at_once_as_its_row_says(
    rig: Rig, number: int, params: tuple[float, ...], result: int
) -> None:
    assert rig.ask(number, *params) == result
    assert rig.boat.endpoint.faults == 0


def test_what_is_refused_is_answered_at_once_and_changes_nothing(rig: Rig) -> None:
    before = rig.fingerprint()
    for number, params, result in ROWS:
        if result not in (OK, IN_PROGRESS):
            assert rig.ask(number, *params) == result, (number, params)
    assert rig.fingerprint() == before
    assert rig.boat.endpoint.faults == 0


def test_every_command_of_the_table_has_a_row_here_that_is_accepted(rig: Rig) -> None:
    table = rig.boat.endpoint._commands._table
    assert isinstance(rig.boat.endpoint._commands, CommandService)
    refused_plainly = {
        *PAYLOAD_ROWS,  # without payload; with one, see test_payload_commands.py
        CMD.MAV_CMD_DO_SET_GLOBAL_ORIGIN,
        CMD.MAV_CMD_DO_CANCEL_MAG_CAL,
        CMD.MAV_CMD_DO_START_MAG_CAL,
        *REGIONS_OF_INTEREST,  # see test_qgc_plans.py
    }
    assert set(table) - refused_plainly == {number for number, _, result in ROWS if result == OK}


KNOWN = sorted({number for number, _, _ in ROWS[:-4]})


@settings(max_examples=15)
@given(st.sampled_from(KNOWN), st.lists(st.floats(width=32), min_size=4, max_size=4), st.data())
def test_any_parameters_of_a_known_command_do_no_harm(
    number: int, params: list[float], data: st.DataObject
) -> None:
    rig = Rig()
    rig.run(0.2)
    x, y = (data.draw(st.integers(-(2**31), 2**31 - 1)) for _ in "xy")
    rig.peer.command_int(number, *params, x=x, y=y, frame=data.draw(st.integers(0, 21)))
    rig.run(0.5)
    results = [ack.result for ack in rig.peer.said("COMMAND_ACK")]
    assert len(results) == 1 or results[0] == IN_PROGRESS
    assert rig.boat.endpoint.faults == 0
    assert all(channel.faults == 0 for channel in rig.boat.channels.open.values())


def test_command_int_carries_its_place_in_integers(rig: Rig) -> None:
    rig.peer.forget()
    rig.peer.command_int(192, 1.5, 1, 0, NAN, x=50 * E7 + 9000, y=-12_000_000, frame=6)
    rig.receive()
    assert [ack.result for ack in rig.peer.said("COMMAND_ACK")] == [OK]
    vehicle = rig.boat.vehicle
    assert vehicle.modes.guided.target is not None
    assert vehicle.modes.guided.target.lat_deg == 50.0009
    assert (vehicle.mode.name, vehicle.speed_m_s) == ("GUIDED", 1.5)


def test_a_refused_arming_fails_and_says_why() -> None:
    rig = Rig(config={"arming.battery_min_v": 50.0})
    rig.run(1.0)
    assert rig.arm() == FAILED
    (text,) = [one for one in rig.peer.said("STATUSTEXT") if str(one.text).startswith("Arm: ")]
    assert "is below 50.0 V" in str(text.text)
    assert text.severity == dialect.MAV_SEVERITY_CRITICAL
    assert not rig.boat.vehicle.armed
    assert rig.arm(force=True) == OK
    assert rig.boat.vehicle.armed


@pytest.mark.parametrize("magic", [0.0, 21196.0])
def test_disarming_cuts_the_motors_before_the_next_tick(rig: Rig, magic: float) -> None:
    rig.arm()
    rig.ask(CMD.MAV_CMD_MISSION_START)
    rig.run(2.0)
    motors = rig.world._motors
    assert motors.left > 0.2
    assert rig.ask(CMD.MAV_CMD_COMPONENT_ARM_DISARM, 0.0, magic) == OK
    assert (motors.left, motors.right) == (0.0, 0.0)
    text = "Disarmed by emergency stop" if magic else "Disarmed by command"
    assert text in rig.peer.texts
    rig.run(0.5)
    assert (motors.left, motors.right) == (0.0, 0.0)


def test_intervals_are_set_read_and_given_back(rig: Rig) -> None:
    def interval_us(message_id: int) -> int:
        assert rig.ask(CMD.MAV_CMD_GET_MESSAGE_INTERVAL, message_id) == OK
        (answer,) = rig.peer.said("MESSAGE_INTERVAL")
        assert answer.message_id == message_id
        return int(answer.interval_us)

    assert interval_us(30) == 250_000
    rig.ask(CMD.MAV_CMD_SET_MESSAGE_INTERVAL, 30, 100_000)
    assert interval_us(30) == 100_000
    rig.ask(CMD.MAV_CMD_SET_MESSAGE_INTERVAL, 30, -1)
    assert interval_us(30) == -1
    rig.ask(CMD.MAV_CMD_SET_MESSAGE_INTERVAL, 30, 0)
    assert interval_us(30) == 250_000
    rig.ask(CMD.MAV_CMD_SET_MESSAGE_INTERVAL, 30, 1e30)
    assert interval_us(30) == 2**31 - 128
    assert interval_us(233) == 0
