"""Commands and parameters on good lines and bad: all is answered, nothing done twice or pretended."""

import math

import pytest
from client_habits import CLIENTS, PATIENT, QGC_50, Habits
from pymavlink.dialects.v20 import all as dialect
from station_client import OpenClient

from sitl.radio.channel import Quality

pytest_plugins = ("conformance_fixtures",)

ACCEPTED, DENIED, UNSUPPORTED, FAILED = 0, 2, 3, 4
HOLD, MANUAL = 4.0, 0.0
CHANGES_THE_TEST = {  # what would end the vehicle or change what comes after
    dialect.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN,
    dialect.MAV_CMD_DO_FLIGHTTERMINATION,
    dialect.MAV_CMD_PREFLIGHT_STORAGE,
    dialect.MAV_CMD_SET_MESSAGE_INTERVAL,
}
COMMANDS = sorted(set(dialect.enums["MAV_CMD"]) - CHANGES_THE_TEST - {dialect.MAV_CMD_ENUM_END})
BAD = Quality(0.2, delay_s=0.03, jitter_s=0.04, duplication=0.1)


def test_every_command_that_there_is_has_an_answer(client: OpenClient) -> None:
    station = client(QGC_50)
    silent = [number for number in COMMANDS if station.command(number) is None]
    assert silent == []


def test_parameters_that_are_no_numbers_are_answered_too(client: OpenClient) -> None:
    station = client(QGC_50)
    for value in (math.nan, -1e38):
        silent = [number for number in COMMANDS if station.command(number, *[value] * 7) is None]
        assert silent == []


def test_a_message_is_asked_for_and_comes_or_is_refused_at_once(client: OpenClient) -> None:
    station = client(QGC_50)
    for number in sorted(dialect.mavlink_map):
        began_s = station.line.now_s
        answer = station.command(dialect.MAV_CMD_REQUEST_MESSAGE, float(number), brings=number)
        assert answer is not None
        if answer.result == ACCEPTED:
            assert answer.message is not None, f"{dialect.mavlink_map[number].msgname} was promised"
        assert station.line.now_s - began_s < 0.5


@pytest.mark.parametrize("habits", CLIENTS, ids=lambda habits: habits.name)
def test_a_mode_is_changed_and_the_heartbeat_says_so_at_once(client: OpenClient, habits: Habits) -> None:
    station = client(habits)
    for mode in (MANUAL, HOLD):
        answer = station.command(dialect.MAV_CMD_DO_SET_MODE, 1.0, mode)
        assert answer is not None
        assert answer.result == ACCEPTED
        began_s = station.line.now_s
        assert station.hear_one("HEARTBEAT", 1.3, custom_mode=mode)
        assert station.line.now_s - began_s < 0.5


def test_a_mode_that_there_is_not_is_refused_and_said(client: OpenClient) -> None:
    station = client(QGC_50)
    answer = station.command(dialect.MAV_CMD_DO_SET_MODE, 1.0, 99.0)
    assert answer is not None
    assert answer.result in (DENIED, FAILED, UNSUPPORTED)
    station.hear(lambda _: False, 1.0)
    assert station.texts


@pytest.mark.parametrize("loss", [0.05, 0.4])
@pytest.mark.parametrize("habits", CLIENTS, ids=lambda habits: habits.name)
def test_the_parameter_list_is_whole_or_the_client_knows_that_it_is_not(
    client: OpenClient, habits: Habits, loss: float
) -> None:
    truth = client(PATIENT).parameters()
    assert truth is not None
    station = client(habits, Quality(loss, delay_s=0.02, jitter_s=0.03, duplication=0.05), seed=4)
    values = station.parameters()
    assert values is None or values == truth
    assert values is not None or loss >= 0.2


@pytest.mark.parametrize("habits", CLIENTS, ids=lambda habits: habits.name)
def test_a_parameter_is_set_and_told_also_on_a_bad_line(client: OpenClient, habits: Habits) -> None:
    station = client(habits, BAD, seed=2)
    name, before = "CRUISE_SPEED", client(PATIENT).parameters()
    assert before is not None
    told = []
    for value in (1.5, 1.75):
        told.append(station.set_parameter(name, value))
        station.hear(lambda _: False, 1.0)  # a copy that comes late is nobody's fault
    after = client(PATIENT).parameters()
    assert after is not None
    assert told == [1.5, 1.75]
    assert after[name] == told[-1]
    assert {key: value for key, value in after.items() if before[key] != value}.keys() <= {
        name,
        "WP_SPEED",
        "WPNAV_SPEED",
    }
    client(PATIENT).set_parameter(name, before[name])


def test_a_parameter_out_of_range_is_answered_with_the_value_that_stays(client: OpenClient) -> None:
    station = client(QGC_50)
    before = station.parameters()
    assert before is not None
    for value in (-1e9, 1e9, math.nan):
        assert station.set_parameter("CRUISE_SPEED", value) == before["CRUISE_SPEED"]
    assert station.parameters() == before
