"""Plans and parameters move whole over TCP on this machine, and fast over a radio of 57,600 baud."""

from dataclasses import replace

import pytest
from client_habits import QGC_50, in_no_hurry
from pymavlink.dialects.v20 import all as dialect
from station_client import Item, OpenClient, StationClient
from vehicle_line import Who

from sitl.radio.channel import Quality

pytest_plugins = ("conformance_fixtures",)

RADIO = Quality(bandwidth_bytes_s=5760.0, backlog_s=5.0)
ITEM_BYTES = 49  # a waypoint's frame, trailing zeros cut
FAST = replace(QGC_50, name="loopback", address=Who(245, 190), item_wait_s=2.0, patience_s=5.0)


def zigzag(count: int) -> list[Item]:
    """Home and waypoints."""
    return [Item(16, 0, 500000000, -12000000)] + [
        Item(16, 3, 500000000 + 50 * n, -12000000 + 500 * (n % 2), 50.0) for n in range(1, count)
    ]


def timed_transfers(station: StationClient, count: int) -> tuple[float, float]:
    """Seconds up and down."""
    items = zigzag(count)
    began_s = station.line.now_s
    assert station.upload(items) == dialect.MAV_MISSION_ACCEPTED
    uploaded_s = station.line.now_s
    held = station.download()
    assert held is not None
    assert held[1:] == items[1:]
    return uploaded_s - began_s, station.line.now_s - uploaded_s


@pytest.mark.realtime
def test_a_plan_goes_up_and_down_over_loopback(live_client: OpenClient) -> None:
    station = live_client(in_no_hurry(FAST))
    up_s, down_s = timed_transfers(station, 500)
    print(f"500 items over TCP: up {up_s:.3f} s, down {down_s:.3f} s")  # noqa: T201


@pytest.mark.realtime
def test_the_whole_parameter_list_comes_without_asking_for_any(live_client: OpenClient) -> None:
    station = live_client(in_no_hurry(FAST))
    station.heartbeat()
    began_s = station.line.now_s
    values = station.parameters()
    assert values is not None
    print(f"{len(values)} parameters over TCP in {station.line.now_s - began_s:.3f} s")  # noqa: T201
    assert station.asked["parameter"] == 0


@pytest.mark.parametrize("talks", [False, True], ids=["quiet", "with telemetry"])
def test_a_radio_is_kept_busy_by_a_transfer(client: OpenClient, talks: bool) -> None:
    station = client(replace(FAST, name="radio"), RADIO)
    if not talks:
        station.send(dialect.MAVLink_request_data_stream_message(*station.vehicle, 0, 1, 0))
    line = station.line
    station.hear(lambda _: False, 5.0)
    sent, heard = line.sent_bytes, line.heard_bytes
    up_s, down_s = timed_transfers(station, 200)
    room_s = up_s + down_s
    share = 200 * (ITEM_BYTES / up_s + ITEM_BYTES / down_s) / 2.0 / RADIO.bandwidth_bytes_s
    both = (line.sent_bytes - sent + line.heard_bytes - heard) / (room_s * RADIO.bandwidth_bytes_s)
    print(  # noqa: T201
        f"200 items, 57,600 baud: up {up_s:.2f} s, down {down_s:.2f} s; items fill {share:.0%} of their way,"
        f" all traffic together {both:.0%} of one way"
    )
    assert both >= 0.7
    assert share >= (0.4 if talks else 0.7)
