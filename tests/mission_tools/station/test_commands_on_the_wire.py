"""What single requests are on the wire, by pymavlink's own constants."""

import math

import pytest
from pymavlink.dialects.v20 import all as peer

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message
from mission_tools.station.commands import Commands
from mission_tools.station.outcome import Outcome
from mission_tools.station.requests import BadRequestError, build_command, way_points

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


def test_only_what_may_be_done_twice_is_repeated_late_and_only_a_restart_needs_a_disarmed_boat() -> None:
    whats = ("arm", "check", "continue", "disarm", "hold", "pause", "restart", "return", "start", "stop")
    commands = {what: build_command(what, {}, MODES) for what in whats}
    assert [what for what in whats if commands[what].once] == ["continue", "pause", "restart", "start"]
    assert [what for what in whats if commands[what].disarmed] == ["restart"]
    assert [what for what in whats if not commands[what].steers] == ["arm", "check", "disarm", "restart"]


def test_the_emergency_stop_forces_the_disarming() -> None:
    sent = Line().ask("stop")
    assert sent.command == peer.MAV_CMD_COMPONENT_ARM_DISARM
    assert (sent.param1, sent.param2) == (0.0, 21196.0)


@pytest.mark.parametrize(
    ("what", "arguments"),
    [
        ("nonsense", {}),
        ("go", {}),
        ("go", {"lat": 1.0, "lon": math.nan}),
        ("go", {"lat": "1", "lon": 1.0}),
        ("go", {"lat": 1.0, "lon": True}),
        ("go", {"lat": 90.1, "lon": 0.0}),
        ("go", {"lat": 0.0, "lon": -180.1}),
        ("go", {"lat": 0.0, "lon": 0.0}),
        ("speed", {"m_s": 0.0}),
        ("speed", {"m_s": 50.1}),
        ("set_mode", {"mode": ["LOITER"]}),
        ("set_mode", {"mode": "FLY"}),
    ],
)
def test_a_request_without_what_it_needs_or_out_of_range_is_refused(
    what: str, arguments: dict[str, object]
) -> None:
    with pytest.raises(BadRequestError):
        build_command(what, arguments, MODES)


@pytest.mark.parametrize("speed_m_s", [0.1, 50.0])
def test_a_speed_over_ground_is_kept(speed_m_s: float) -> None:
    sent = Line().ask("speed", m_s=speed_m_s)
    assert (sent.param1, sent.param2, sent.param3) == (peer.SPEED_TYPE_GROUNDSPEED, speed_m_s, -1.0)


@pytest.mark.parametrize("points", [[], "north", [[1.0, 2.0, 3.0]], [[1.0, math.inf]], [[1.0, 2.0]] * 1001])
def test_a_way_of_no_or_odd_or_too_many_points_is_refused(points: object) -> None:
    with pytest.raises(BadRequestError):
        way_points({"points": points})
    assert way_points({"points": [[1.0, 2.0]] * 1000}) == [(20_000_000, 10_000_000)] * 1000
