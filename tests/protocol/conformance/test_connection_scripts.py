"""QGroundControl connects: every step of every version is answered, once, and in time."""

import pytest
from client_habits import in_no_hurry
from pymavlink.dialects.v20 import all as dialect
from qgc_scripts import SCRIPTS, Script
from script_player import play
from station_client import OpenClient
from vehicle_line import PERFECT

from sitl.radio.channel import Quality

pytest_plugins = ("conformance_fixtures",)

LIMIT_S = 1.0
INSISTED_ON = (
    *("FRAME_CLASS", "RCMAP_ROLL", "RCMAP_PITCH", "RCMAP_THROTTLE", "RCMAP_YAW", "MODE_CH", "COMPASS_DEC"),
    *(f"RC{channel}_{end}" for channel in range(1, 5) for end in ("MIN", "MAX", "TRIM")),
    *(f"MODE{position}" for position in range(1, 7)),
    *(f"COMPASS_{name}{number}" for name in ("DEV_ID", "USE") for number in ("", "2", "3")),
    *(f"COMPASS_OFS{number}_{axis}" for number in ("", "2", "3") for axis in "XYZ"),
    *(f"INS_ACCOFFS_{axis}" for axis in "XYZ"),
    *("BATT_MONITOR", "BATT_CAPACITY", "ARMING_REQUIRE", "ARMING_CHECK"),
)


@pytest.mark.realtime
@pytest.mark.parametrize("script", SCRIPTS[-1:], ids=lambda script: script.habits.name)
def test_a_station_is_connected_and_asks_nothing_twice(live_client: OpenClient, script: Script) -> None:
    station = live_client(in_no_hurry(script.habits))
    done = play(script, station)
    asked = sum(station.asked.values())
    print(f"{script.habits.name}: {asked} requests answered in {done.total_s:.3f} s")  # noqa: T201
    assert station.asked_again.total() == 0
    assert set(done.plans) == {0, 1, 2}
    missing = [name for name in INSISTED_ON if name not in done.parameters]
    assert missing == []
    assert "WP_SPEED" in done.parameters or "WPNAV_SPEED" in done.parameters


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.habits.name)
def test_by_the_boats_own_clock_too(client: OpenClient, script: Script) -> None:
    station = client(script.habits, PERFECT)
    done = play(script, station)
    assert done.total_s < LIMIT_S
    assert station.asked_again.total() == 0


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.habits.name)
def test_a_version_is_told_its_capabilities_on_a_bad_line_too(client: OpenClient, script: Script) -> None:
    station = client(script.habits, Quality(0.2, delay_s=0.03, jitter_s=0.04, duplication=0.05), seed=3)
    is_version = dialect.MAVLINK_MSG_ID_AUTOPILOT_VERSION
    answers = [
        station.command(dialect.MAV_CMD_REQUEST_MESSAGE, float(is_version), brings=is_version)
        for _ in range(10)
    ]
    told = [answer.message for answer in answers if answer is not None and answer.message is not None]
    assert told
    capabilities = told[0].capabilities
    for needed in ("MISSION_INT", "COMMAND_INT", "MAVLINK2", "MISSION_FENCE", "MISSION_RALLY"):
        assert capabilities & getattr(dialect, f"MAV_PROTOCOL_CAPABILITY_{needed}")
