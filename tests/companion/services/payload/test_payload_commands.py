"""Payload commands by hand and as mission items: every parameter is checked against the boat's payload."""

import math

import pytest
from boat_rig import DENIED, HOME_ITEM, OK, Rig, waypoint
from hypothesis import given
from hypothesis import strategies as st
from payload_rig import PayloadRig

from companion.mavlink.dialect import dialect
from companion.mavlink.items import MissionItem, MissionResult
from companion.mavlink.transfer import Completed, Failed
from companion.payload.actions import (
    ActionFault,
    CaptureByDistance,
    MoveGripper,
    MoveWinch,
    RepeatRelay,
    RepeatServo,
    RunCommand,
    SetLights,
    SetRelay,
    SetServo,
    WinchMotion,
)
from companion.payload.fitted import FittedPayload
from companion.services.payload.rows import ROWS, read_action

CMD, NAN, INF = dialect, math.nan, math.inf

ANSWERS = [
    (CMD.MAV_CMD_DO_SET_SERVO, (9, 1700), OK, ""),
    (CMD.MAV_CMD_DO_SET_SERVO, (9, NAN), DENIED, "parameter 2 is nan, expected a pulse width in us"),
    (CMD.MAV_CMD_DO_SET_SERVO, (9.5, 1500), DENIED, "parameter 1 is 9.5, expected a servo channel"),
    (CMD.MAV_CMD_DO_SET_SERVO, (1, 1900), DENIED, "no servo 1, expected 9 (bait)"),
    (CMD.MAV_CMD_DO_REPEAT_SERVO, (9, 1700, 3, 1.0), OK, ""),
    (CMD.MAV_CMD_DO_REPEAT_SERVO, (9, 1700, 0, 1.0), DENIED, "parameter 3 is 0, expected a number of times"),
    (CMD.MAV_CMD_DO_REPEAT_SERVO, (9, 1700, 3, 0.0), DENIED, "parameter 4 is 0, expected a period of"),
    (CMD.MAV_CMD_DO_REPEAT_SERVO, (9, 1700, 3, NAN), DENIED, "parameter 4 is nan"),
    (CMD.MAV_CMD_DO_SET_RELAY, (0, 1), OK, ""),
    (CMD.MAV_CMD_DO_SET_RELAY, (0, 2), DENIED, "parameter 2 is 2, expected 0 or 1"),
    (CMD.MAV_CMD_DO_SET_RELAY, (5, 1), DENIED, "no relay 5, expected 0 (pump), 1 or 2"),
    (CMD.MAV_CMD_DO_SET_RELAY, (-1, 1), DENIED, "parameter 1 is -1, expected a relay, from 0"),
    (CMD.MAV_CMD_DO_REPEAT_RELAY, (0, 2, 1.0), OK, ""),
    (CMD.MAV_CMD_DO_REPEAT_RELAY, (0, 2, 0.05), DENIED, "parameter 3 is 0.05, expected a period of"),
    (CMD.MAV_CMD_DO_REPEAT_RELAY, (0, 1, 0.1), OK, ""),
    (CMD.MAV_CMD_DO_REPEAT_RELAY, (0, 1, 0.099), DENIED, "parameter 3 is 0.099"),
    (CMD.MAV_CMD_DO_REPEAT_RELAY, (0, 10000, 1.0), OK, ""),
    (CMD.MAV_CMD_DO_REPEAT_RELAY, (0, 10001, 1.0), DENIED, "parameter 2 is 10001"),
    (CMD.MAV_CMD_DO_REPEAT_RELAY, (0, 1, 86_401), DENIED, "parameter 3 is 86401"),
    (CMD.MAV_CMD_DO_REPEAT_RELAY, (-1, 1, 1.0), DENIED, "parameter 1 is -1, expected a relay, from 0"),
    (CMD.MAV_CMD_DO_GRIPPER, (1, 1), OK, ""),
    (CMD.MAV_CMD_DO_GRIPPER, (-1, 1), DENIED, "parameter 1 is -1, expected a gripper"),
    (CMD.MAV_CMD_DO_WINCH, (-1, 0), DENIED, "parameter 1 is -1, expected a winch"),
    (CMD.MAV_CMD_DO_GRIPPER, (1, 2), DENIED, "parameter 2 is 2, expected 0 release or 1 grab"),
    (CMD.MAV_CMD_DO_WINCH, (1, 1, 2.0), OK, ""),
    (CMD.MAV_CMD_DO_WINCH, (1, 1, NAN), DENIED, "parameter 3 is nan, expected a length of line in m"),
    (CMD.MAV_CMD_DO_WINCH, (1, 1, 2.0, -0.25), OK, ""),
    (CMD.MAV_CMD_DO_WINCH, (1, 1, 2.0, NAN), OK, ""),
    (CMD.MAV_CMD_DO_WINCH, (1, 2, 0, 0.5), OK, ""),
    (CMD.MAV_CMD_DO_WINCH, (1, 2, 0, INF), DENIED, "parameter 4 is inf, expected a rate in m/s"),
    (CMD.MAV_CMD_DO_WINCH, (1, 4), DENIED, "parameter 2 is 4, expected one of 0 relax, 1 length"),
    (CMD.MAV_CMD_DO_WINCH, (1, 6), OK, ""),
    (CMD.MAV_CMD_ILLUMINATOR_ON_OFF, (1,), OK, ""),
    (CMD.MAV_CMD_ILLUMINATOR_ON_OFF, (NAN,), DENIED, "parameter 1 is nan, expected 0 or 1"),
    (CMD.MAV_CMD_DO_SEND_SCRIPT_MESSAGE, (7,), OK, ""),
    (CMD.MAV_CMD_DO_SEND_SCRIPT_MESSAGE, (-1,), DENIED, "parameter 1 is -1, expected a command's number"),
    (CMD.MAV_CMD_DO_SEND_SCRIPT_MESSAGE, (0,), DENIED, "no command 0"),
    (CMD.MAV_CMD_DO_DIGICAM_CONTROL, (0, 0, 0, 0, 1), OK, ""),
    (CMD.MAV_CMD_DO_DIGICAM_CONTROL, (0, 0, 0, 0, 2), DENIED, "parameter 5 is 2, expected 1, to"),
    (CMD.MAV_CMD_IMAGE_START_CAPTURE, (0, 0, 1), OK, ""),
    (CMD.MAV_CMD_IMAGE_START_CAPTURE, (0, 2, 0), OK, ""),
    (CMD.MAV_CMD_IMAGE_START_CAPTURE, (0, 0, 3), DENIED, "parameter 2 is 0, expected an interval in s"),
    (CMD.MAV_CMD_IMAGE_START_CAPTURE, (0, 1, NAN), DENIED, "parameter 3 is nan, expected a number of images"),
    (CMD.MAV_CMD_IMAGE_STOP_CAPTURE, (), OK, ""),
    (CMD.MAV_CMD_DO_SET_CAM_TRIGG_DIST, (10,), OK, ""),
    (CMD.MAV_CMD_DO_SET_CAM_TRIGG_DIST, (0,), OK, ""),
    (CMD.MAV_CMD_DO_SET_CAM_TRIGG_DIST, (100_001,), DENIED, "parameter 1 is 100001"),
    (CMD.MAV_CMD_DO_SET_CAM_TRIGG_DIST, (-1,), DENIED, "parameter 1 is -1, expected a distance in m"),
]  # fmt: skip


@pytest.fixture(scope="module")
def rig() -> PayloadRig:
    rig = PayloadRig()
    rig.step()
    return rig


@pytest.mark.parametrize(("number", "params", "result", "text"), ANSWERS)
def test_a_command_is_answered_and_its_fault_named(
    rig: PayloadRig, number: int, params: tuple[float, ...], result: int, text: str
) -> None:
    rig.run(1.5)  # as long as an image takes
    assert rig.ask(number, *params) == result
    assert rig.boat.endpoint.faults == 0
    if text:
        name = dialect.enums["MAV_CMD"][number].name.removeprefix("MAV_CMD_")
        assert [line for line in rig.peer.texts if line.startswith(f"{name}: {text}")], rig.peer.texts


def test_every_payload_command_has_rows_here() -> None:
    assert set(ROWS) == {number for number, _, result, _ in ANSWERS if result == OK}


@given(st.sampled_from(sorted(ROWS)), st.lists(st.floats(width=32), min_size=7, max_size=7))
def test_any_parameters_are_an_action_or_a_fault(
    rig: PayloadRig, number: int, parameters: list[float]
) -> None:
    action = read_action(number, parameters, FittedPayload(rig.config.payload, rig.config.camera))
    if isinstance(action, ActionFault):
        assert 1 <= action.parameter <= 7
        assert action.text
    if isinstance(action, SetServo):
        assert action.number == 9
        assert 1000 <= action.width_us <= 2000


@pytest.mark.parametrize(
    ("number", "params", "action"),
    [
        (CMD.MAV_CMD_DO_REPEAT_SERVO, (9, 1700, 3, 1.0), RepeatServo(9, 1700, 3, 1.0)),
        (CMD.MAV_CMD_DO_SET_RELAY, (0, 1), SetRelay(0, True)),
        (CMD.MAV_CMD_DO_SET_RELAY, (0, 0), SetRelay(0, False)),
        (CMD.MAV_CMD_DO_REPEAT_RELAY, (0, 2, 1.5), RepeatRelay(0, 2, 1.5)),
        (CMD.MAV_CMD_DO_GRIPPER, (1, 0), MoveGripper(1, False)),
        (CMD.MAV_CMD_DO_GRIPPER, (1, 1), MoveGripper(1, True)),
        (CMD.MAV_CMD_DO_WINCH, (1, 0, 2.0, 0.5), MoveWinch(1, WinchMotion.RELAX)),
        (CMD.MAV_CMD_DO_WINCH, (1, 1, 2.0, -0.25), MoveWinch(1, WinchMotion.LENGTH, 2.0, 0.25)),
        (CMD.MAV_CMD_DO_WINCH, (1, 1, 2.0, NAN), MoveWinch(1, WinchMotion.LENGTH, 2.0)),
        (CMD.MAV_CMD_DO_WINCH, (1, 2, 2.0, -0.5), MoveWinch(1, WinchMotion.RATE, 0.0, -0.5)),
        (CMD.MAV_CMD_ILLUMINATOR_ON_OFF, (1,), SetLights(True)),
        (CMD.MAV_CMD_ILLUMINATOR_ON_OFF, (0,), SetLights(False)),
        (CMD.MAV_CMD_DO_SEND_SCRIPT_MESSAGE, (7,), RunCommand(7)),
        (CMD.MAV_CMD_DO_SET_CAM_TRIGG_DIST, (9, 0, 1), CaptureByDistance(9, True)),
        (CMD.MAV_CMD_DO_SET_CAM_TRIGG_DIST, (9,), CaptureByDistance(9, False)),
    ],
)
def test_parameters_are_the_action_that_they_name(
    rig: PayloadRig, number: int, params: tuple[float, ...], action: object
) -> None:
    padded = (*params, *[0.0] * (7 - len(params)))
    assert read_action(number, padded, FittedPayload(rig.config.payload, rig.config.camera)) == action


def do(command: int, *params: float) -> MissionItem:
    """An item as QGroundControl sends it: frame 2, the fifth parameter in x."""
    p = [*params, *[0.0] * (7 - len(params))]
    return MissionItem(2, command, 0, 1, p[0], p[1], p[2], p[3], int(p[4]), int(p[5]), p[6])


@pytest.mark.parametrize(
    ("item", "result", "text"),
    [
        (do(CMD.MAV_CMD_DO_SET_SERVO, 3, 1900), MissionResult.INVALID_PARAM1, "no servo 3, expected 9"),
        (do(CMD.MAV_CMD_DO_SET_SERVO, 9, 2100), MissionResult.INVALID_PARAM2, "2100 us, expected 1000"),
        (do(CMD.MAV_CMD_DO_SET_SERVO, 9, NAN), MissionResult.INVALID_PARAM2, "parameter 2 is nan"),
        (do(CMD.MAV_CMD_DO_REPEAT_RELAY, 0, 1, 0), MissionResult.INVALID_PARAM3, "parameter 3 is 0"),
        (do(CMD.MAV_CMD_DO_WINCH, 1, 2, 0, 9), MissionResult.INVALID_PARAM4, "9 m/s, expected at most 0.5"),
        (do(CMD.MAV_CMD_DO_DIGICAM_CONTROL), MissionResult.INVALID_PARAM5_X, "parameter 5 is 0"),
    ],
)  # fmt: skip
def test_a_mission_with_an_item_that_the_boat_cannot_do_is_refused_by_name(
    item: MissionItem, result: MissionResult, text: str
) -> None:
    rig = PayloadRig().ready()
    end = rig.upload([HOME_ITEM, waypoint(20.0, 0.0), item])
    assert isinstance(end, Failed)
    assert end.result == result
    assert any("item 2" in line and text in line for line in rig.peer.texts), rig.peer.texts
    assert rig.items() == ()


def test_an_item_for_absent_payload_is_refused_or_skipped_aloud_as_configured() -> None:
    items = [HOME_ITEM, waypoint(20.0, 0.0), do(CMD.MAV_CMD_DO_SET_SERVO, 9, 1500)]
    rig = Rig().ready()
    end = rig.upload(items)
    assert isinstance(end, Failed)
    assert end.result == MissionResult.UNSUPPORTED
    assert any("item 2" in line and "this boat has no servo" in line for line in rig.peer.texts)
    rig = Rig("open", 'vehicle.mission.absent_payload="skip"').ready()
    assert isinstance(rig.upload(items), Completed)
    assert any("item 2" in line and "is ignored" in line for line in rig.peer.texts), rig.peer.texts
    assert rig.items() == tuple(items)
