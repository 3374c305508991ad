"""A boat that obeys its operator alone, as other stations meet it."""

import struct

import pytest
from boat_rig import BOAT, DENIED, OK, Rig, waypoint

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.items import MissionResult, MissionType
from companion.mavlink.transfer import Failed

CMD = dialect
ENFORCED: dict[str, object] = {"identity.operator_system_id": 255, "identity.only_operator": True}
STRANGER, ABOARD = Address(42, 190), Address(1, 191)


@pytest.fixture
def rig() -> Rig:
    return Rig(config=ENFORCED).ready()


def ftp(opcode: int, data: bytes = b"/files/x") -> Message:
    payload = struct.pack("<HBBBBBBI", 1, 0, opcode, len(data), 0, 0, 0, 0) + data
    message: Message = dialect.MAVLink_file_transfer_protocol_message(0, *BOAT, payload.ljust(251, b"\0"))
    return message


COMMANDS = [
    (CMD.MAV_CMD_COMPONENT_ARM_DISARM, (1.0,)),
    (CMD.MAV_CMD_DO_SET_MODE, (1.0, 15.0)),
    (CMD.MAV_CMD_DO_MOTOR_TEST, (1.0, 0.0, 20.0, 5.0)),
    (CMD.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, (1.0,)),
]


@pytest.mark.parametrize(("number", "params"), COMMANDS)
def test_a_strangers_command_is_denied_and_the_operators_is_not(
    rig: Rig, number: int, params: tuple[float, ...]
) -> None:
    stranger, before = rig.connect(STRANGER), rig.fingerprint()
    assert rig.ask(number, *params, peer=stranger) == DENIED
    assert rig.fingerprint() == before
    assert not rig.boat.motor_test.is_running
    assert rig.ask(number, *params) != DENIED


def test_a_stranger_may_ask_and_see(rig: Rig) -> None:
    stranger = rig.connect(STRANGER)
    assert rig.ask(CMD.MAV_CMD_REQUEST_MESSAGE, 148.0, peer=stranger) == OK
    assert rig.ask(CMD.MAV_CMD_SET_MESSAGE_INTERVAL, 30.0, 1e6, peer=stranger) == OK
    assert rig.ask(CMD.MAV_CMD_RUN_PREARM_CHECKS, peer=stranger) == OK
    stranger.send(dialect.MAVLink_param_request_read_message(*BOAT, b"WP_RADIUS", -1))
    stranger.send(dialect.MAVLink_mission_request_list_message(*BOAT, 0))
    stranger.send(ftp(4, b"@PARAM/param.pck"))
    rig.run(0.1)
    assert stranger.said("PARAM_VALUE")
    assert stranger.said("MISSION_COUNT")
    assert bytes(stranger.said("FILE_TRANSFER_PROTOCOL")[0].payload)[3] == 128


def test_nothing_that_a_stranger_sends_changes_the_boat(rig: Rig) -> None:
    stranger, before = rig.connect(STRANGER), rig.fingerprint()
    ack = rig.answer_to(dialect.MAVLink_set_mode_message(1, 1, 15), "COMMAND_ACK", stranger)
    assert (ack.command, ack.result) == (CMD.MAV_CMD_DO_SET_MODE, DENIED)
    ack = rig.answer_to(dialect.MAVLink_mission_clear_all_message(*BOAT, 1), "MISSION_ACK", stranger)
    assert (ack.type, ack.mission_type) == (MissionResult.DENIED, 1)
    value = rig.answer_to(
        dialect.MAVLink_param_set_message(*BOAT, b"SYSID_ENFORCE", 0.0, 2), "PARAM_VALUE", stranger
    )
    assert value.param_value == 1.0
    outcome = rig.upload([waypoint(0.0, 0.0, command=5100)], stranger, MissionType.RALLY)
    assert isinstance(outcome, Failed)
    assert outcome.result is MissionResult.DENIED
    stranger.send(dialect.MAVLink_mission_set_current_message(*BOAT, 0))
    stranger.send(dialect.MAVLink_setup_signing_message(*BOAT, bytes(range(32)), 5))
    rig.run(0.2)
    assert rig.fingerprint() == before
    assert rig.boat.endpoint.faults == 0
    told = [text for text in rig.peer.texts if "refused" in text]
    assert told == ["Station 42 refused: not the operator (SYSID_ENFORCE)"]


@pytest.mark.parametrize(
    "config",
    [
        {},
        {"identity.operator_system_id": 255},  # says whose silence counts, no more
        {"identity.only_operator": True},  # any ground station is the operator
    ],
)
def test_without_both_settings_any_station_may_command(config: dict[str, object]) -> None:
    rig = Rig(config=config).ready()
    assert rig.ask(CMD.MAV_CMD_COMPONENT_ARM_DISARM, 1.0, peer=rig.connect(STRANGER)) == OK
