"""A running boat among strangers: silent connections, garbage, and stations that nobody here wrote."""

import asyncio
import contextlib
import socket

import pytest
from mavsdk.asyncio import ComponentType, Configuration, Mavsdk
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


async def answers_of_mavsdk(boat: socket.socket) -> tuple[int, int, int, int]:
    """What MAVSDK returns to a vehicle that announces itself and asks: time, number, system, component."""
    encoder, parser = dialect.MAVLink(None, 1, 1), dialect.MAVLink(None)
    parser.robust_parsing = True
    configuration = Configuration.create_with_component_type(ComponentType.GROUND_STATION)
    configuration.always_send_heartbeats = True
    async with Mavsdk(configuration) as mavsdk:
        await mavsdk.add_any_connection(f"udpout://127.0.0.1:{boat.getsockname()[1]}")
        boat.setblocking(False)
        station = None
        for _ in range(600):
            await asyncio.sleep(0.1)
            if station is not None:
                beat = encoder.heartbeat_encode(dialect.MAV_TYPE_SURFACE_BOAT, 3, 0, 0, 4)
                for message in (beat, encoder.ping_encode(123_456_789, 0xC0FFEE, 0, 0)):
                    boat.sendto(message.pack(encoder), station)
            with contextlib.suppress(BlockingIOError):
                while True:
                    data, station = boat.recvfrom(2048)
                    for message in parser.parse_buffer(data) or ():
                        if message.get_type() == "PING" and message.target_system:
                            target = message.target_system, message.target_component
                            return (message.time_usec, message.seq, *target)
    raise AssertionError("no PING came back")
