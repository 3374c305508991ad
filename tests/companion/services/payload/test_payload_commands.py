"""Payload commands by hand and as mission items: every parameter is checked against the boat's payload."""

import dataclasses
import math

import pytest
from boat_rig import DENIED, HOME_ITEM, OK, UNSUPPORTED, Rig, waypoint
from hypothesis import given
from hypothesis import strategies as st
from payload_rig import BAIT, GRIPPER, HORN, LIGHT, PUMP, SAMPLE, WINCH, PayloadRig

from companion.mavlink.dialect import dialect
from companion.mavlink.items import MissionItem, MissionResult
from companion.mavlink.transfer import Completed, Failed
from companion.payload.actions import ActionFault, SetServo
from companion.payload.fitted import FittedPayload
from companion.services.payload.rows import ROWS, read_action

CMD, NAN, INF = dialect, math.nan, math.inf
REJECTED_FOR_NOW = 1

ANSWERS = [
    (CMD.MAV_CMD_DO_SET_SERVO, (9, 1700), OK, ""),
    (CMD.MAV_CMD_DO_SET_SERVO, (9, 1000), OK, ""),
    (CMD.MAV_CMD_DO_SET_SERVO, (9, 2000), OK, ""),
    (CMD.MAV_CMD_DO_SET_SERVO, (9, 999), DENIED, "servo 9 (bait): 999 us, expected 1000 to 2000"),
    (CMD.MAV_CMD_DO_SET_SERVO, (9, 2001), DENIED, "servo 9 (bait): 2001 us, expected 1000 to 2000"),
    (CMD.MAV_CMD_DO_SET_SERVO, (9, NAN), DENIED, "parameter 2 is nan, expected a pulse width in us"),
    (CMD.MAV_CMD_DO_SET_SERVO, (9, INF), DENIED, "parameter 2 is inf, expected a pulse width in us"),
    (CMD.MAV_CMD_DO_SET_SERVO, (9.5, 1500), DENIED, "parameter 1 is 9.5, expected a servo channel"),
    (CMD.MAV_CMD_DO_SET_SERVO, (1, 1900), DENIED, "no servo 1, expected 9 (bait)"),
    (CMD.MAV_CMD_DO_SET_SERVO, (3, 1900), DENIED, "no servo 3, expected 9 (bait)"),
    (CMD.MAV_CMD_DO_REPEAT_SERVO, (9, 1700, 3, 1.0), OK, ""),
    (CMD.MAV_CMD_DO_REPEAT_SERVO, (9, 1700, 0, 1.0), DENIED, "parameter 3 is 0, expected a number of times"),
    (CMD.MAV_CMD_DO_REPEAT_SERVO, (9, 1700, 3, 0.0), DENIED, "parameter 4 is 0, expected a period of"),
    (CMD.MAV_CMD_DO_REPEAT_SERVO, (9, 1700, 3, NAN), DENIED, "parameter 4 is nan"),
    (CMD.MAV_CMD_DO_REPEAT_SERVO, (9, 2100, 3, 1.0), DENIED, "servo 9 (bait): 2100 us"),
    (CMD.MAV_CMD_DO_SET_RELAY, (0, 1), OK, ""),
    (CMD.MAV_CMD_DO_SET_RELAY, (1, 0), OK, ""),
    (CMD.MAV_CMD_DO_SET_RELAY, (0, 2), DENIED, "parameter 2 is 2, expected 0 or 1"),
    (CMD.MAV_CMD_DO_SET_RELAY, (15, 0), DENIED, "command 7 (sample): relay 15 off, expected on"),
    (CMD.MAV_CMD_DO_REPEAT_RELAY, (15, 2, 1.0), DENIED, "no relay 15, expected 0 (pump), 1 or 2"),
    (CMD.MAV_CMD_DO_SET_RELAY, (5, 1), DENIED, "no relay 5, expected 0 (pump), 1 or 2"),
    (CMD.MAV_CMD_DO_SET_RELAY, (-1, 1), DENIED, "parameter 1 is -1, expected a relay, from 0"),
    (CMD.MAV_CMD_DO_REPEAT_RELAY, (0, 2, 1.0), OK, ""),
    (CMD.MAV_CMD_DO_REPEAT_RELAY, (0, 2, 0.05), DENIED, "parameter 3 is 0.05, expected a period of"),
    (CMD.MAV_CMD_DO_REPEAT_RELAY, (2, 2, 10.0), DENIED, "horn 2: period 10 s, expected at most 4"),
    (CMD.MAV_CMD_DO_REPEAT_RELAY, (0, 1, 0.1), OK, ""),
    (CMD.MAV_CMD_DO_REPEAT_RELAY, (0, 1, 0.099), DENIED, "parameter 3 is 0.099"),
    (CMD.MAV_CMD_DO_REPEAT_RELAY, (0, 10000, 1.0), OK, ""),
    (CMD.MAV_CMD_DO_REPEAT_RELAY, (0, 10001, 1.0), DENIED, "parameter 2 is 10001"),
    (CMD.MAV_CMD_DO_GRIPPER, (1, 1), OK, ""),
    (CMD.MAV_CMD_DO_GRIPPER, (0, 0), OK, ""),
    (CMD.MAV_CMD_DO_GRIPPER, (2, 0), DENIED, "no gripper 2, expected 1"),
    (CMD.MAV_CMD_DO_GRIPPER, (1, 2), DENIED, "parameter 2 is 2, expected 0 release or 1 grab"),
    (CMD.MAV_CMD_DO_WINCH, (1, 1, 2.0), OK, ""),
    (CMD.MAV_CMD_DO_WINCH, (1, 1, 5.1), DENIED, "winch 1: 5.1 m, expected at most 5"),
    (CMD.MAV_CMD_DO_WINCH, (1, 1, NAN), DENIED, "parameter 3 is nan, expected a length of line in m"),
    (CMD.MAV_CMD_DO_WINCH, (0, 1, 5.1), DENIED, "winch 1: 5.1 m, expected at most 5"),
    (CMD.MAV_CMD_DO_WINCH, (1, 1, 2.0, -0.25), OK, ""),
    (CMD.MAV_CMD_DO_WINCH, (1, 1, 2.0, NAN), OK, ""),
    (CMD.MAV_CMD_DO_WINCH, (1, 1, 2.0, INF), DENIED, "winch 1: inf m/s, expected at most 0.5"),
    (CMD.MAV_CMD_DO_WINCH, (1, 2, 0, 0.5), OK, ""),
    (CMD.MAV_CMD_DO_WINCH, (1, 2, 0, -0.6), DENIED, "winch 1: -0.6 m/s, expected at most 0.5"),
    (CMD.MAV_CMD_DO_WINCH, (1, 2, 0, INF), DENIED, "parameter 4 is inf, expected a rate in m/s"),
    (CMD.MAV_CMD_DO_WINCH, (1, 4), DENIED, "parameter 2 is 4, expected one of 0 relax, 1 length"),
    (CMD.MAV_CMD_DO_WINCH, (1, 6), OK, ""),
    (CMD.MAV_CMD_ILLUMINATOR_ON_OFF, (1,), OK, ""),
    (CMD.MAV_CMD_ILLUMINATOR_ON_OFF, (NAN,), DENIED, "parameter 1 is nan, expected 0 or 1"),
    (CMD.MAV_CMD_DO_SEND_SCRIPT_MESSAGE, (7,), OK, ""),
    (CMD.MAV_CMD_DO_SEND_SCRIPT_MESSAGE, (8,), DENIED, "no command 8, expected 7 (sample)"),
    (CMD.MAV_CMD_DO_DIGICAM_CONTROL, (0, 0, 0, 0, 1), OK, ""),
    (CMD.MAV_CMD_DO_DIGICAM_CONTROL, (0, 0, 0, 0, 0), DENIED, "parameter 5 is 0, expected 1, to"),
    (CMD.MAV_CMD_IMAGE_START_CAPTURE, (0, 0, 1), OK, ""),
    (CMD.MAV_CMD_IMAGE_START_CAPTURE, (0, 2, 0), OK, ""),
    (CMD.MAV_CMD_IMAGE_START_CAPTURE, (0, 0, 3), DENIED, "parameter 2 is 0, expected an interval in s"),
    (CMD.MAV_CMD_IMAGE_START_CAPTURE, (0, 1, NAN), DENIED, "parameter 3 is nan, expected a number of images"),
    (CMD.MAV_CMD_IMAGE_STOP_CAPTURE, (), OK, ""),
    (CMD.MAV_CMD_DO_SET_CAM_TRIGG_DIST, (10,), OK, ""),
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
    rig.run(3.0)  # a repeated command would count as sent again
    assert rig.ask(number, *params) == result
    assert rig.boat.endpoint.faults == 0
    if text:
        name = dialect.enums["MAV_CMD"][number].name.removeprefix("MAV_CMD_")
        assert [line for line in rig.peer.texts if line.startswith(f"{name}: {text}")], rig.peer.texts


def test_every_payload_command_has_rows_here() -> None:
    assert set(ROWS) == {number for number, _, result, _ in ANSWERS if result == OK}


@pytest.mark.parametrize("number", sorted(ROWS))
def test_without_payload_every_payload_command_is_unsupported(number: int) -> None:
    rig = Rig()
    rig.step()
    assert rig.ask(number, 1, 1, 1, 1) == UNSUPPORTED
    assert any("this boat has no " in text for text in rig.peer.texts)


@given(st.sampled_from(sorted(ROWS)), st.lists(st.floats(width=32), min_size=7, max_size=7))
def test_any_parameters_are_an_action_or_a_fault(number: int, parameters: list[float]) -> None:
    fitted = FittedPayload(PayloadRig().config.payload, PayloadRig().config.camera)
    action = read_action(number, parameters, fitted)
    if isinstance(action, ActionFault):
        assert 1 <= action.parameter <= 7
        assert action.text
    if isinstance(action, SetServo):
        assert action.channel == 9
        assert 1000 <= action.width_us <= 2000


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


def test_skipping_does_not_take_invalid_parameters_of_fitted_payload() -> None:
    rig = PayloadRig("open", 'vehicle.mission.absent_payload="skip"').ready()
    end = rig.upload([HOME_ITEM, waypoint(20.0, 0.0), do(CMD.MAV_CMD_DO_SET_SERVO, 9, 2100)])
    assert isinstance(end, Failed)


def test_camera_items_are_skipped_aloud_without_a_camera() -> None:
    rig = PayloadRig(has_camera=False).ready()
    items = [HOME_ITEM, waypoint(20.0, 0.0), do(CMD.MAV_CMD_DO_SET_CAM_TRIGG_DIST, 5)]
    assert isinstance(rig.upload(items), Completed)
    assert any("item 2" in line and "is ignored" in line for line in rig.peer.texts), rig.peer.texts


def test_a_relay_is_repeated_and_returns_to_what_it_was() -> None:
    rig = PayloadRig()
    rig.step()
    rig.ask(CMD.MAV_CMD_DO_REPEAT_RELAY, 0, 3, 1.0)
    rig.run(5.0)
    began_s = rig.output(PUMP).history[1].time_s
    changes = [(round(one.time_s - began_s, 2), one.value) for one in rig.output(PUMP).history[1:]]
    assert changes == [(0.0, 1), (0.5, 0), (1.0, 1), (1.5, 0), (2.0, 1), (2.5, 0)]
    assert rig.ask(CMD.MAV_CMD_DO_SET_RELAY, 0, 1) == OK
    rig.ask(CMD.MAV_CMD_DO_REPEAT_RELAY, 0, 1, 1.0)
    rig.run(2.0)
    assert rig.values(PUMP)[-3:] == [1, 0, 1]


def test_a_new_action_replaces_a_repetition() -> None:
    rig = PayloadRig()
    rig.step()
    rig.ask(CMD.MAV_CMD_DO_REPEAT_SERVO, 9, 1900, 100, 1.0)
    rig.run(1.2)
    assert rig.values(BAIT) == [0, 1900, 1500, 1900]
    rig.ask(CMD.MAV_CMD_DO_SET_SERVO, 9, 1200)
    rig.run(10.0)
    assert rig.values(BAIT) == [0, 1900, 1500, 1900, 1200]


def test_a_horn_stops_by_itself_and_a_light_obeys_the_illuminator() -> None:
    rig = PayloadRig()
    rig.step()
    rig.ask(CMD.MAV_CMD_DO_SET_RELAY, 2, 1)
    rig.ask(CMD.MAV_CMD_ILLUMINATOR_ON_OFF, 1)
    rig.run(3.0)
    on, off = rig.output(HORN).history[1:]
    assert (on.value, off.value) == (1, 0)
    assert off.time_s - on.time_s == pytest.approx(2.0, abs=0.021)
    assert rig.values(LIGHT) == [0, 1]


def test_a_command_that_is_resent_because_its_answer_was_lost_runs_once() -> None:
    rig = PayloadRig()
    rig.step()
    assert rig.ask(CMD.MAV_CMD_DO_WINCH, 1, 1, 1.0) == OK
    rig.run(1.0)
    assert rig.ask(CMD.MAV_CMD_DO_WINCH, 1, 1, 1.0) == OK
    rig.run(6.0)
    start, stop = rig.output(WINCH).history[1:]
    assert stop.time_s - start.time_s == pytest.approx(2.0, abs=0.05)


def test_an_owners_command_runs_once_at_a_time_and_its_end_is_told() -> None:
    rig = PayloadRig()
    rig.step()
    program = rig.sim.programs[SAMPLE]
    program.run_s, program.outcome = 5.0, "exit code 3"
    assert rig.ask(CMD.MAV_CMD_DO_SEND_SCRIPT_MESSAGE, 7) == OK
    rig.run(3.0)
    assert rig.ask(CMD.MAV_CMD_DO_SEND_SCRIPT_MESSAGE, 7) == REJECTED_FOR_NOW
    rig.run(3.0)
    assert "DO_SEND_SCRIPT_MESSAGE: command 7 (sample): still running" in rig.peer.texts
    assert "Command 7 (sample): exit code 3" in rig.peer.texts
    assert len(program.starts) == 1


def test_an_owners_command_may_have_a_relay_that_starts_it() -> None:
    rig = PayloadRig()
    rig.step()
    assert rig.ask(CMD.MAV_CMD_DO_SET_RELAY, 15, 1) == OK
    rig.run(2.0)
    assert len(rig.sim.programs[SAMPLE].starts) == 1
    assert "Command 7 (sample): done" in rig.peer.texts


def test_safe_states_are_entered_at_start_disarming_and_link_loss() -> None:
    rig = PayloadRig("open", "vehicle.failsafe.gcs_timeout_s=5.0").ready()
    assert rig.values(PUMP) == [0]
    assert rig.values(GRIPPER) == []  # no signal before the first command
    rig.arm()
    rig.ask(CMD.MAV_CMD_DO_SET_RELAY, 0, 1)
    rig.ask(CMD.MAV_CMD_DO_SET_RELAY, 2, 1)
    rig.ask(CMD.MAV_CMD_DO_WINCH, 1, 1, 5.0)
    rig.run(0.5)
    rig.ask(CMD.MAV_CMD_COMPONENT_ARM_DISARM, 0)
    rig.run(0.1)
    assert rig.values(PUMP)[-1] == 1  # keeps
    assert rig.values(HORN)[-1] == 0
    assert rig.values(WINCH)[-1] == 0
    rig.peer.heartbeat()
    rig.run(0.5)
    rig.arm()
    rig.ask(CMD.MAV_CMD_DO_SET_RELAY, 2, 1)
    rig.ask(CMD.MAV_CMD_DO_SET_RELAY, 1, 0)
    rig.peer.heartbeat()
    rig.ask(CMD.MAV_CMD_DO_WINCH, 1, 1, 5.0)
    rig.until(lambda: bool(rig.boat.vehicle.failsafes.active), 10.0)
    rig.step(2)
    assert rig.values(HORN)[-1] == 0
    assert rig.values(LIGHT)[-1] == 1
    assert rig.values(WINCH)[-1] == 0


def test_an_output_that_does_not_answer_is_told_once_and_written_again() -> None:
    rig = PayloadRig()
    rig.step()
    rig.output(BAIT).fault = "no answer"
    assert rig.ask(CMD.MAV_CMD_DO_SET_SERVO, 9, 1800) == OK
    rig.run(5.0)
    assert [line for line in rig.peer.texts if "no answer" in line] == ["Servo 9 (bait): no answer"]
    rig.output(BAIT).fault = ""
    rig.run(1.1)
    assert rig.values(BAIT) == [0, 1800]
    assert "Servo 9 (bait): answers again" in rig.peer.texts


def test_telemetry_shows_servos_relays_and_winch() -> None:
    rig = PayloadRig()
    rig.step()
    rig.ask(CMD.MAV_CMD_DO_SET_SERVO, 9, 1800)
    rig.ask(CMD.MAV_CMD_DO_SET_RELAY, 1, 1)
    rig.ask(CMD.MAV_CMD_DO_WINCH, 1, 6)
    rig.run(1.0)

    def latest(name: str) -> object:
        rig.ask(CMD.MAV_CMD_REQUEST_MESSAGE, getattr(dialect, f"MAVLINK_MSG_ID_{name}"))
        return rig.peer.said(name)[-1]

    servos = latest("SERVO_OUTPUT_RAW")
    assert (servos.servo1_raw, servos.servo3_raw, servos.servo9_raw) == (1500, 1500, 1800)  # type: ignore[attr-defined]
    relays = latest("RELAY_STATUS")
    assert (relays.on, relays.present) == (0b010, 0b111)  # type: ignore[attr-defined]
    winch = latest("WINCH_STATUS")
    assert winch.status == dialect.MAV_WINCH_STATUS_HEALTHY | dialect.MAV_WINCH_STATUS_MOVING  # type: ignore[attr-defined]
    assert winch.speed == pytest.approx(-0.5)  # type: ignore[attr-defined]
    assert math.isnan(winch.line_length)  # type: ignore[attr-defined]
    rig.run(10.0)
    winch = latest("WINCH_STATUS")
    assert winch.line_length == 0.0  # type: ignore[attr-defined]
    assert winch.status & dialect.MAV_WINCH_STATUS_FULLY_RETRACTED  # type: ignore[attr-defined]


def test_a_stored_mission_whose_payload_is_gone_is_not_sailed() -> None:
    rig = PayloadRig().ready()
    items = [HOME_ITEM, waypoint(20.0, 0.0), do(CMD.MAV_CMD_DO_SET_SERVO, 9, 1500)]
    assert isinstance(rig.upload(items), Completed)
    rig.reboot()
    rig.step()
    assert rig.items() == tuple(items)
    rig.hardware = dataclasses.replace(rig.hardware, payload=None)
    rig.reboot()
    rig.run(40.0)
    assert rig.items() == ()
    assert any("this boat has no servo" in text for text in rig.peer.texts), rig.peer.texts
