"""What single requests are on the wire, by pymavlink's own constants."""

import math

import pytest
from pymavlink.dialects.v20 import all as peer

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message
from mission_tools.station.commands import REPEAT_S, Commands
from mission_tools.station.outcome import Outcome
from mission_tools.station.requests import BadRequestError, build_command

BOAT, OWN = Address(1, 1), Address(255, 190)
MODES = {"LOITER": 5, "RTL": 11}


class Line:
    """A station's commands, and what they send."""

    def __init__(self) -> None:
        self.sent: list[Message] = []
        self.answers: list[Outcome] = []
        self.commands = Commands(BOAT, OWN, self.sent.append)

    def ask(self, what: str, **arguments: object) -> Message:
        self.commands.ask(build_command(what, arguments, MODES), self.answers.append, 0.0)
        return self.sent[-1]


def test_go_is_a_reposition_at_the_usual_speed_that_changes_the_mode() -> None:
    sent = Line().ask("go", lat=50.0, lon=-1.2)
    assert sent.get_type() == "COMMAND_INT"
    assert sent.command == peer.MAV_CMD_DO_REPOSITION
    assert sent.frame == peer.MAV_FRAME_GLOBAL
    assert (sent.current, sent.autocontinue) == (0, 0)
    assert (sent.param1, sent.param2, sent.param3) == (-1.0, peer.MAV_DO_REPOSITION_FLAGS_CHANGE_MODE, 0.0)
    assert math.isnan(sent.param4)
    assert (sent.x, sent.y, sent.z) == (500_000_000, -12_000_000, 0.0)


def test_a_repeated_long_command_counts_up_its_confirmation() -> None:
    line = Line()
    first = line.ask("speed", m_s=0.7)
    assert (first.param1, first.param2, first.param3) == (peer.SPEED_TYPE_GROUNDSPEED, 0.7, -1.0)
    line.commands.poll(REPEAT_S)
    assert [one.confirmation for one in line.sent] == [0, 1]


def test_the_emergency_stop_forces_the_disarming() -> None:
    sent = Line().ask("stop")
    assert sent.command == peer.MAV_CMD_COMPONENT_ARM_DISARM
    assert (sent.param1, sent.param2) == (0.0, 21196.0)


@pytest.mark.parametrize(
    "place", [{"lat": 90.1, "lon": 0.0}, {"lat": 0.0, "lon": -180.1}, {"lat": 0.0, "lon": 0.0}]
)
def test_a_place_off_the_globe_or_at_its_zero_is_refused(place: dict[str, float]) -> None:
    with pytest.raises(BadRequestError):
        build_command("go", place, MODES)


@pytest.mark.parametrize(("speed_m_s", "is_sent"), [(0.0, False), (0.1, True), (50.0, True), (50.1, False)])
def test_a_speed_is_more_than_none_and_at_most_50_metres_a_second(speed_m_s: float, is_sent: bool) -> None:
    if is_sent:
        assert build_command("speed", {"m_s": speed_m_s}, MODES).params[1] == speed_m_s
    else:
        with pytest.raises(BadRequestError):
            build_command("speed", {"m_s": speed_m_s}, MODES)
