"""A running boat among strangers: silent connections, garbage, and stations that nobody here wrote."""

import contextlib
import socket

import pytest
from mavutil_station import OpenStation
from patience import MOMENT_S
from programs import RunBoat
from pymavlink.dialects.v20 import all as dialect

pytestmark = pytest.mark.realtime
pytest_plugins = ("program_fixtures",)

SILENT = 200
GARBAGE_BYTES = 3_000_000  # which silenced the boat for 25 s, when they were magic bytes


def test_silent_connections_and_magic_bytes_keep_no_station_from_the_boat(
    running_boat: RunBoat, open_station: OpenStation
) -> None:
    boat = running_boat("open")
    first = open_station(boat.port, 255)
    first.mav.heartbeat_send(dialect.MAV_TYPE_GCS, dialect.MAV_AUTOPILOT_INVALID, 0, 0, 0)
    with contextlib.ExitStack() as hanging_up:
        for _ in range(SILENT):
            hanging_up.enter_context(socket.create_connection(("127.0.0.1", boat.port), timeout=MOMENT_S))
        flood = hanging_up.enter_context(socket.create_connection(("127.0.0.1", boat.port), timeout=MOMENT_S))
        for magic in (b"\xfd", b"\xfe"):
            flood.sendall(magic * (GARBAGE_BYTES // 2))
        late = open_station(boat.port, 254)
        for station in (first, late):
            station.drain()
            assert station.command(dialect.MAV_CMD_DO_SET_MODE, 1.0, 0.0) == dialect.MAV_RESULT_ACCEPTED
            station.wait_for("ATTITUDE")
