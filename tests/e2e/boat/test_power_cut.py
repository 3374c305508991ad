"""The power goes in mid-upload: after the restart the boat holds the old mission or the new one, whole.

One folder for the boat's memory goes through all the cuts, as on a real boat.
"""

from pathlib import Path

import pytest
from mavutil_station import OpenStation, Place, zigzag
from programs import RunBoat
from pymavlink.dialects.v20 import all as dialect

pytestmark = pytest.mark.realtime
pytest_plugins = ("program_fixtures",)

WAYPOINTS = 31
ITEMS = WAYPOINTS + 1  # and home


def mission(number: int) -> list[Place]:
    """As long as every other, and different from it at every single waypoint."""
    return zigzag(WAYPOINTS, north_e7=1000 + number)


def test_a_mission_survives_power_cuts_at_every_stage_of_an_upload(
    running_boat: RunBoat, open_station: OpenStation, tmp_path: Path
) -> None:
    memory = tmp_path / "memory"
    boat = running_boat("open", "--state", str(memory))
    station = open_station(boat.port)
    held = mission(0)
    assert station.upload(held) == dialect.MAV_MISSION_ACCEPTED
    # How many items are given before the cut; with all of them, whether the boat's answer is waited for
    cuts = [(0, False), (ITEMS - 1, False), (ITEMS, False), (ITEMS, True)]
    for number, (given, is_answered) in enumerate(cuts, start=1):
        new = mission(number)
        station.offer(ITEMS)
        station.give(new, range(given))
        if is_answered:
            assert station.wait_for("MISSION_ACK").type == dialect.MAV_MISSION_ACCEPTED
            station.mav.param_set_send(1, 1, b"CRUISE_SPEED", 1.25, dialect.MAV_PARAM_TYPE_REAL32)
            station.wait_for("PARAM_VALUE", lambda value: value.param_id == "CRUISE_SPEED")
        boat.program.kill()
        boat = running_boat("open", "--state", str(memory))
        station = open_station(boat.port)
        after = station.download()
        assert after[1:] in (held[1:], new[1:]), f"a mixture after {given} items"
        if given < ITEMS:
            assert after[1:] == held[1:], f"{given} items of {ITEMS} have replaced the mission"
        if is_answered:
            assert after[1:] == new[1:], "what was acknowledged is gone"
            assert station.parameters()["CRUISE_SPEED"] == 1.25, "so is a parameter that was answered"
        held = after
