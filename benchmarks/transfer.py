"""How fast does a mission go up and down over TCP loopback, with a plain pymavlink client?"""

import contextlib
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pymavlink import mavutil

from benchmarks.measure import Row, alone

_ROUNDS = 5
_ITEMS = 500


def rows() -> list[Row]:
    """Wall-clock seconds for a mission each way."""
    with _served_boat() as port:
        vehicle = mavutil.mavlink_connection(f"tcp:127.0.0.1:{port}", source_system=245)
        vehicle.wait_heartbeat(timeout=10)
        up = [_upload(vehicle) for _ in range(_ROUNDS)]
        down = [_download(vehicle) for _ in range(_ROUNDS)]
        vehicle.close()
    return [
        alone(f"upload of {_ITEMS} items over TCP on one machine", "s", up),
        alone(f"download of {_ITEMS} items", "s", down),
    ]


def _upload(vehicle: Any) -> float:  # noqa: ANN401  pymavlink is untyped
    send, target = vehicle.mav, (1, 1)
    began = time.perf_counter()
    send.mission_count_send(*target, _ITEMS, 0)
    while True:
        message = vehicle.recv_match(
            type=["MISSION_REQUEST_INT", "MISSION_REQUEST", "MISSION_ACK"], blocking=True, timeout=5
        )
        assert message is not None, "the boat fell silent"
        if message.get_type() == "MISSION_ACK":
            assert message.type == 0, f"refused with {message.type}"
            return time.perf_counter() - began
        lat = 500000000 + 100 * message.seq
        send.mission_item_int_send(*target, message.seq, 3, 16, 0, 1, 0, 0, 0, 0, lat, -12000000, 0, 0)


def _download(vehicle: Any) -> float:  # noqa: ANN401  pymavlink is untyped
    send, target = vehicle.mav, (1, 1)
    began = time.perf_counter()
    send.mission_request_list_send(*target, 0)
    assert vehicle.recv_match(type="MISSION_COUNT", blocking=True, timeout=5).count == _ITEMS
    for seq in range(_ITEMS):
        send.mission_request_int_send(*target, seq, 0)
        item = vehicle.recv_match(type="MISSION_ITEM_INT", blocking=True, timeout=5)
        assert item is not None
        assert item.seq == seq
    send.mission_ack_send(*target, 0, 0)
    return time.perf_counter() - began


@contextlib.contextmanager
def _served_boat() -> Iterator[int]:
    """An emulated boat as a process of its own: its TCP port."""
    program = str(Path(sys.executable).with_name("boat-sitl"))
    command = [program, "serve", "open", "--tcp", "0", "--no-udp"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        yield int(process.stdout.readline().partition("tcpin:127.0.0.1:")[2].partition(",")[0])
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(timeout=10)
