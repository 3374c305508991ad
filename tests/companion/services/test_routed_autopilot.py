"""An autopilot that stations reach as a component of the boat, with a twin of Rover on its line."""

import pytest
from autopilot_bench import Plug
from boat_rig import DENIED, FAILED, OK, PLANNER, QGC, UNSUPPORTED, Peer, Rig
from twins.lines import HandClock

from companion.config.autopilot import AutopilotPart
from companion.config.boat_config import BoatConfig
from companion.mavlink.address import Address
from companion.mavlink.codec import Received
from companion.mavlink.dialect import Message, dialect
from companion.services.outbox import Origin, Outbox
from companion.services.routed_autopilot import RoutedAutopilot
from companion.vehicle.vehicle import Vehicle

COMPONENT = 25
ROVER = Address(1, COMPONENT)
VEHICLES = (dialect.MAV_TYPE_GROUND_ROVER, dialect.MAV_TYPE_SURFACE_BOAT)
ARM, SET_MODE = dialect.MAV_CMD_COMPONENT_ARM_DISARM, dialect.MAV_CMD_DO_SET_MODE
REBOOT, MAG_CAL = dialect.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, dialect.MAV_CMD_DO_START_MAG_CAL
MOTOR_TEST = dialect.MAV_CMD_DO_MOTOR_TEST


class Boat:
    """A boat with an autopilot on a line, and a station. told: what its station heard from the component."""

    def __init__(self, component: int = COMPONENT, config: dict[str, object] | None = None) -> None:
        self.clock = HandClock()
        part = AutopilotPart(url="tcpout:127.0.0.1:9", component=component)
        self.plug = Plug(self.clock, component=component)
        self.rig = Rig(
            config={"parts.autopilot": part, **(config or {})},
            autopilot=self.plug.line if component else None,
        )
        self.plug.plug_in()
        self.run(3.0)
        self.rig.peer.forget()

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / 0.02)):
            self.plug.run(0.02)
            self.rig.step()

    def ask(self, message: Message, peer: Peer | None = None, seconds: float = 0.3) -> list[Message]:
        """What the component answers to a station."""
        peer = peer or self.rig.peer
        heard(peer)
        peer.send(message)
        self.run(seconds)
        return [one.message for one in heard(peer) if one.sender == ROVER]

    def values(self, message: Message, peer: Peer | None = None) -> dict[str, Message]:
        """The parameters that the component tells a station in answer."""
        answers = self.ask(message, peer)
        return {one.param_id: one for one in answers if one.get_type() == "PARAM_VALUE"}

    def command(self, number: int, *params: float) -> list[int]:
        """The results of a command to the component."""
        values = [*params, *([0.0] * (7 - len(params)))]
        answers = self.ask(dialect.MAVLink_command_long_message(*ROVER, number, 0, *values))
        return [one.result for one in answers if one.get_type() == "COMMAND_ACK"]


class Line:
    """Satisfies `MavlinkPart`, of an autopilot that sends `messages`."""

    is_heard = False

    def __init__(self) -> None:
        self.messages: list[Message] = []

    def send(self, message: Message, sender: Address) -> None:
        pass

    def take_messages(self) -> list[Message]:
        return self.messages

    def close(self) -> None:
        pass


def heard(peer: Peer) -> list[Received]:
    return [one for chunk in peer.link.receive() for one in peer._decoder.feed(chunk)]


def param_set(name: str, value: float) -> Message:
    message: Message = dialect.MAVLink_param_set_message(*ROVER, name.encode(), value, 9)
    return message


def param_read(name: str) -> Message:
    message: Message = dialect.MAVLink_param_request_read_message(*ROVER, name.encode(), -1)
    return message


@pytest.fixture
def boat() -> Boat:
    return Boat()


def test_no_station_sees_a_second_vehicle_nor_its_telemetry(boat: Boat) -> None:
    boat.run(3.0)
    said = heard(boat.rig.peer)
    beats = [one for one in said if one.message.get_type() == "HEARTBEAT"]
    routed = [one.message for one in beats if one.sender == ROVER]
    assert len(routed) == 3
    assert {one.type for one in routed} == {dialect.MAV_TYPE_ONBOARD_CONTROLLER}
    assert {one.autopilot for one in routed} == {dialect.MAV_AUTOPILOT_INVALID}
    assert {one.sender for one in beats if one.message.type in VEHICLES} == {Address(1, 1)}
    assert {one.message.get_type() for one in said if one.sender == ROVER} == {"HEARTBEAT"}
    assert {one.sender.system for one in said} == {1}


def test_its_parameters_are_read_and_set_under_its_own_component(boat: Boat) -> None:
    told = boat.values(param_read("SERVO16_FUNCTION"))["SERVO16_FUNCTION"]
    assert (told.param_value, told.param_count) == (0.0, 1200)
    assert boat.values(param_set("RC_OVERRIDE_TIME", 0.3))["RC_OVERRIDE_TIME"].param_value == pytest.approx(
        0.3
    )
    assert boat.plug.rover.parameters["RC_OVERRIDE_TIME"] == pytest.approx(0.3)


def test_a_list_of_all_components_is_of_both(boat: Boat) -> None:
    boat.rig.peer.send(dialect.MAVLink_param_request_list_message(1, 0))
    boat.run(2.0)
    senders = {one.sender for one in heard(boat.rig.peer) if one.message.get_type() == "PARAM_VALUE"}
    assert senders == {Address(1, 1), ROVER}
    boat.rig.peer.send(dialect.MAVLink_param_request_list_message(1, 1))
    boat.run(2.0)
    senders = {one.sender for one in heard(boat.rig.peer) if one.message.get_type() == "PARAM_VALUE"}
    assert senders == {Address(1, 1)}


@pytest.mark.parametrize("number", [ARM, SET_MODE, MOTOR_TEST, dialect.MAV_CMD_SET_MESSAGE_INTERVAL])
def test_what_drives_it_or_changes_its_line_never_reaches_it(boat: Boat, number: int) -> None:
    assert boat.command(number, 1.0, 10.0) == [UNSUPPORTED]
    assert ("COMMAND_LONG", QGC.component) not in boat.plug.rover.heard


def test_no_stick_of_a_station_reaches_it(boat: Boat) -> None:
    boat.rig.peer.send(dialect.MAVLink_rc_channels_override_message(*ROVER, *([1900] * 18)))
    boat.rig.peer.send(dialect.MAVLink_manual_control_message(1, 1000, 1000, 1000, 1000, 0))
    boat.run(0.2)
    assert QGC.component not in {component for _, component in boat.plug.rover.heard}


def test_only_the_operator_changes_it_where_the_boat_listens_to_nobody_else() -> None:
    boat = Boat(config={"identity.only_operator": True, "identity.operator_system_id": PLANNER.system})
    before = boat.plug.rover.parameters["FS_ACTION"]
    boat.rig.peer.send(param_set("FS_ACTION", 0.0))
    boat.run(0.3)
    assert "PARAM_VALUE" not in {one.message.get_type() for one in heard(boat.rig.peer)}
    assert boat.plug.rover.parameters["FS_ACTION"] == before
    assert boat.command(MAG_CAL) == [DENIED]
    assert "FS_ACTION" in boat.values(param_read("FS_ACTION"))


def test_a_calibration_is_passed_on_and_its_progress_returns(boat: Boat) -> None:
    assert boat.command(MAG_CAL, 0.0, 1.0) == [OK]
    boat.plug.rover.send(boat.plug.rover.wire.mag_cal_progress_encode(0, 1, 2, 1, 40, [0] * 10, 0, 0, 0))
    boat.plug.rover.text(6, "Fitting")
    boat.plug.rover.text(4, "EKF3 lane switch 1")  # the boat tells it to everybody
    boat.run(0.2)
    names = [one.message for one in heard(boat.rig.peer) if one.sender == ROVER]
    told = {one.get_type() for one in names}
    assert {"MAG_CAL_PROGRESS", "STATUSTEXT"} <= told
    assert [one.text for one in names if one.get_type() == "STATUSTEXT"] == ["Fitting"]


def test_an_armed_boat_keeps_it_from_rebooting_and_calibrating(boat: Boat) -> None:
    boat.rig.run(5.0)
    assert boat.rig.arm(force=True) == OK
    assert boat.command(REBOOT, 1.0, 0.0, 0.0, 0.0, 0.0, 20190226.0) == [DENIED]
    assert boat.command(MAG_CAL) == [DENIED]
    assert "SERVO1_FUNCTION" in boat.values(param_read("SERVO1_FUNCTION"))


def test_answers_go_to_those_who_asked_and_to_them_for_a_minute(boat: Boat) -> None:
    other = boat.rig.connect(PLANNER)
    boat.ask(param_read("SERVO1_FUNCTION"))
    assert not [one for one in heard(other) if one.message.get_type() == "PARAM_VALUE"]
    to_planner = boat.plug.rover.wire.command_ack_encode(MAG_CAL, 0, 0, 0, *PLANNER)
    boat.plug.rover.send(to_planner)
    boat.run(0.2)
    assert not [one for one in heard(boat.rig.peer) if one.message.get_type() == "COMMAND_ACK"]
    assert "SERVO3_FUNCTION" in boat.values(param_read("SERVO3_FUNCTION"), other)


def test_a_minute_after_a_question_only_what_is_addressed_goes_on() -> None:
    line, outbox = Line(), Outbox()
    routed = RoutedAutopilot(COMPONENT, line, Vehicle(BoatConfig()), outbox)
    routed.handle(param_read("SERVO1_FUNCTION"), Origin(7, QGC), 10.0)
    for now_s, channels in ((70.0, [7, 7]), (70.1, [7])):
        line.messages = [
            dialect.MAVLink_param_value_message(b"SERVO1_FUNCTION", 73.0, 9, 1200, 0),
            dialect.MAVLink_command_ack_message(MAG_CAL, 0, 0, 0, *QGC),
            dialect.MAVLink_attitude_message(1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        ]
        routed.tick(now_s)
        assert [one.channel for one in outbox.drain()] == channels


def test_a_silent_autopilot_is_no_component_and_a_question_to_it_does_no_harm(boat: Boat) -> None:
    boat.plug.unplug()
    boat.run(2.0)
    heard(boat.rig.peer)
    assert boat.ask(param_read("SERVO1_FUNCTION"), seconds=2.0) == []
    assert boat.command(MAG_CAL) == [FAILED]


def test_it_is_hidden_unless_it_has_an_id(boat: Boat) -> None:
    hidden = Boat(component=0)
    assert hidden.ask(param_read("SERVO1_FUNCTION"), seconds=2.0) == []
    assert "SERVO1_FUNCTION" in boat.values(param_read("SERVO1_FUNCTION"))


@pytest.mark.parametrize("payload", [b"", bytes(range(251))])
def test_files_pass_both_ways_unchanged(boat: Boat, payload: bytes) -> None:
    whole = payload.ljust(251, b"\0")
    answers = boat.ask(dialect.MAVLink_file_transfer_protocol_message(0, *ROVER, whole))
    (answer,) = [one for one in answers if one.get_type() == "FILE_TRANSFER_PROTOCOL"]
    assert bytes(answer.payload) == whole
    assert (answer.target_system, answer.target_component) == QGC
