"""A station's reboot command: the program begins anew in the same process, with all that it had stored."""

import re

import pytest
from mavutil_station import OpenStation
from programs import RunBoat

from companion.mavlink.dialect import dialect

pytestmark = pytest.mark.realtime
pytest_plugins = ("program_fixtures",)

OK, FAILED = 0, 4


def test_a_reboot_begins_the_program_anew_in_the_same_process(
    running_boat: RunBoat, open_station: OpenStation
) -> None:
    boat = running_boat("open", "--state", "state")
    station = open_station(boat.port)
    pid, said = boat.program.pid, len(boat.program.out)
    link = station.link
    link.mav.param_set_send(1, 1, b"WP_RADIUS", 3.25, 9)
    station.wait_for("PARAM_VALUE", lambda value: value.param_id == "WP_RADIUS")
    station.wait_for("SYSTEM_TIME", lambda now: now.time_boot_ms > 1500)
    link.mav.command_long_send(1, 1, dialect.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 0, 1, 0, 0, 0, 0, 0, 0)
    ack = station.wait_for("COMMAND_ACK")
    assert ack.result == OK
    again = boat.program.wait_for(r"on tcpin:127\.0\.0\.1:(\d+)$", after=said)
    boat.program.wait_for(r"^boat-sitl: ready", after=said)
    assert boat.program.pid == pid
    assert boat.program.is_running
    port = int(re.findall(r":(\d+)$", again[0])[-1])
    fresh = open_station(port)
    assert fresh.wait_for("SYSTEM_TIME").time_boot_ms < 15_000
    fresh.link.mav.param_request_read_send(1, 1, b"WP_RADIUS", -1)
    assert fresh.wait_for("PARAM_VALUE").param_value == 3.25
