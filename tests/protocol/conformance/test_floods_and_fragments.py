"""What a careless or broken station does to a vehicle: floods, half messages, a socket that nobody reads."""

import random
import socket

import pytest
from client_habits import PATIENT, QGC_50, in_no_hurry
from patience import MOMENT_S
from pymavlink.dialects.v20 import all as dialect
from station_client import OpenClient, StationClient, item_message
from test_transfer_speed import FAST, zigzag

pytest_plugins = ("conformance_fixtures",)


def is_well(station: StationClient) -> bool:
    """Whether the vehicle answers as if nothing had happened."""
    version = dialect.MAVLINK_MSG_ID_AUTOPILOT_VERSION
    answer = station.command(dialect.MAV_CMD_REQUEST_MESSAGE, float(version), brings=version)
    return answer is not None and answer.message is not None


def test_a_flood_of_requests_is_survived_and_the_next_station_is_served(client: OpenClient) -> None:
    flood, other = client(QGC_50), client(PATIENT)
    rng = random.Random(1)
    for number in range(1000):
        kind = rng.randrange(4)
        if kind == 0:
            flood.send(dialect.MAVLink_param_request_list_message(*flood.vehicle))
        elif kind == 1:
            flood.send(dialect.MAVLink_mission_request_list_message(*flood.vehicle, rng.randrange(3)))
        elif kind == 2:
            flood.send(
                dialect.MAVLink_mission_count_message(*flood.vehicle, rng.randrange(9), rng.randrange(3))
            )
        else:
            flood.send(
                dialect.MAVLink_command_long_message(*flood.vehicle, rng.randrange(16, 700), 0, *[1.0] * 7)
            )
        if number % 20 == 0:
            flood.line.listen(flood.line.now_s + 0.02)
    other.hear(lambda _: False, 10.0)
    assert is_well(other)
    other.command(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 0.0, 21196.0)
    assert other.upload(zigzag(10)) == dialect.MAV_MISSION_ACCEPTED


def test_an_upload_goes_on_amid_noise_and_half_frames(client: OpenClient) -> None:
    station, rng = client(FAST), random.Random(2)
    items = zigzag(30)
    whole = bytes(item_message(items[3], 3, station.vehicle, 0).pack(dialect.MAVLink(None, 255, 190)))
    station.send(dialect.MAVLink_mission_count_message(*station.vehicle, len(items), 0))
    wanted = ("MISSION_REQUEST", "MISSION_REQUEST_INT", "MISSION_ACK")
    while (message := station.hear(lambda m: m.get_type() in wanted, 10.0)) is not None:
        if message.get_type() == "MISSION_ACK":
            break
        station.line.send_bytes(rng.randbytes(rng.randint(1, 200)))
        station.line.send_bytes(whole[: rng.randint(1, len(whole) - 1)])
        station.send(item_message(items[message.seq], message.seq, station.vehicle, 0))
    assert message is not None
    assert message.type == dialect.MAV_MISSION_ACCEPTED


def test_a_station_that_leaves_in_mid_upload_leaves_the_old_plan(client: OpenClient) -> None:
    first, second = client(FAST), client(PATIENT)
    old = zigzag(6)
    assert first.upload(old) == dialect.MAV_MISSION_ACCEPTED
    first.send(dialect.MAVLink_mission_count_message(*first.vehicle, 100, 0))
    first.hear(lambda m: m.get_type().startswith("MISSION_REQUEST"), 2.0)
    first.send(item_message(old[0], 0, first.vehicle, 0))
    held = second.download()
    assert held is not None
    assert held[1:] == old[1:]


@pytest.mark.realtime
def test_a_socket_that_nobody_reads_keeps_nobody_else_waiting(live_client: OpenClient, live_url: str) -> None:
    if not live_url.startswith("tcp:"):
        pytest.skip("only a TCP server has slow readers")
    host, port = live_url.removeprefix("tcp:").rsplit(":", 1)
    with socket.create_connection((host, int(port)), timeout=MOMENT_S) as deaf:
        deaf.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        packer = dialect.MAVLink(None, 255, 190)
        for stream in (1, 2, 3, 6, 10, 11, 12):
            ask = dialect.MAVLink_request_data_stream_message(1, 1, stream, 50, 1)
            deaf.sendall(bytes(ask.pack(packer)))
        deaf.settimeout(0.2)
        listing = bytes(dialect.MAVLink_param_request_list_message(1, 1).pack(packer))
        for _ in range(2000):
            try:
                deaf.sendall(listing)
            except TimeoutError:
                break
        other = live_client(in_no_hurry(FAST))
        assert other.hear(lambda m: m.get_type() == "HEARTBEAT", MOMENT_S) is not None
        assert is_well(other)
        assert other.upload(zigzag(100)) == dialect.MAV_MISSION_ACCEPTED
