"""What single requests, texts and verdicts are on the wire, by pymavlink's own constants."""

import math
from typing import Any

import pytest
from pymavlink.dialects.v20 import all as peer

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from mission_tools.station.commands import REPEAT_S, Commands
from mission_tools.station.outcome import Outcome
from mission_tools.station.requests import BadRequestError, build_command
from mission_tools.station.texts import Text, Texts
from mission_tools.station.view import HANDLERS, View
from mission_tools.station.words import say

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


def chunk(number: int, text: str, *, of: int = 7) -> Any:  # noqa: ANN401 (a message)
    return dialect.MAVLink_statustext_message(4, text.encode(), of, number)


def test_chunks_of_fifty_characters_are_joined_up_to_the_first_shorter_one() -> None:
    texts = Texts(lambda text: True)
    assert texts.ingest(chunk(1, "b" * 49), 1.0, 0.0) == []
    assert texts.ingest(chunk(0, "a" * 50), 1.0, 0.0) == [Text(4, "a" * 50 + "b" * 49)]
    assert texts.ingest(chunk(0, "c" * 49), 1.0, 0.0) == [Text(4, "c" * 49)]
    assert [line.number for line in texts.lines] == [1, 2]


def test_a_text_whose_rest_does_not_come_is_told_after_a_second() -> None:
    texts = Texts(lambda text: True)
    assert texts.ingest(chunk(0, "a" * 50), 1.0, 0.0) == []
    assert texts.poll(1.9, 0.0) == []
    assert texts.poll(2.0, 0.0) == [Text(4, "a" * 50)]
    assert texts.poll(3.0, 0.0) == []


def view(**values: int) -> View:
    seen = View()
    build = dialect.MAVLink_sys_status_message
    HANDLERS[dialect.MAVLINK_MSG_ID_SYS_STATUS](seen, build(**(dict.fromkeys(build.fieldnames, 0) | values)))
    return seen


@pytest.mark.parametrize(
    ("has_heading", "share", "ok", "word"),
    [
        (False, None, False, "compass.none"),
        (False, 0.1, False, "compass.none"),
        (True, 1.0, False, "compass.none"),
        (True, 0.8, False, "compass.substitute"),
        (True, 0.79, True, "compass.good"),
        (True, None, True, "compass.good"),
    ],
)
def test_a_heading_is_good_while_the_boat_has_one_and_its_filter_trusts_the_compass(
    has_heading: bool, share: float | None, ok: bool, word: str
) -> None:
    seen = View()
    assert seen.compass() is None
    seen.has_heading, seen.heading_share = has_heading, share
    verdict = seen.compass()
    assert verdict is not None
    assert (verdict.ok, verdict.text) == (ok, say(word))


def test_a_percentage_is_0_to_100_and_a_current_not_negative() -> None:
    for told, percent in ((-1, None), (0, 0), (100, 100), (101, None)):
        battery = view(battery_remaining=told, current_battery=-1, voltage_battery=0xFFFF).battery
        assert battery is not None
        assert (battery.percent, battery.current_a, battery.voltage_v) == (percent, None, None)
    measured = view(current_battery=0, voltage_battery=11_400).battery
    assert measured is not None
    assert (measured.current_a, measured.voltage_v) == (0.0, 11.4)
