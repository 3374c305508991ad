"""What a recorded QGroundControl said, said again to our boat: each request that wants an answer gets one."""

import struct
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest
from client_habits import QGC_44
from data_files import RECORDINGS
from pymavlink.dialects.v20 import all as dialect
from station_client import OpenClient
from vehicle_line import Message

pytest_plugins = ("conformance_fixtures",)

MOST_S = 60.0  # of each recording; what follows is heartbeats
ANSWERS = {
    "COMMAND_LONG": "COMMAND_ACK",
    "COMMAND_INT": "COMMAND_ACK",
    "MISSION_REQUEST_LIST": "MISSION_COUNT",
    "PARAM_REQUEST_LIST": "PARAM_VALUE",
    "FILE_TRANSFER_PROTOCOL": "FILE_TRANSFER_PROTOCOL",
}


def said_by_the_station(recording: Path) -> Iterator[tuple[float, bytes, Message]]:
    """Seconds since the beginning, frame and message of what the station sent."""
    log, at, began_us = recording.read_bytes(), 0, 0
    codec = dialect.MAVLink(None)
    while at + 8 < len(log):
        (stamp_us,) = struct.unpack_from(">Q", log, at)
        began_us = began_us or stamp_us
        length = log[at + 9] + (12 if log[at + 8] == 0xFD else 8)
        frame = log[at + 8 : at + 8 + length]
        at += 8 + length
        message = codec.decode(bytearray(frame))
        if message.get_srcSystem() == QGC_44.address.system:
            yield (stamp_us - began_us) * 1e-6, frame, message


@pytest.mark.parametrize("recording", RECORDINGS, ids=lambda path: path.stem)
def test_every_request_of_a_recorded_session_is_answered(client: OpenClient, recording: Path) -> None:
    station = client(QGC_44)
    station.hear(lambda _: False, 1.0)
    began_s = station.line.now_s
    wanted: Counter[str] = Counter()
    silent: list[str] = []
    for at_s, frame, message in said_by_the_station(recording):
        if at_s > MOST_S:
            break
        station.hear(lambda _: False, max(0.0, began_s + at_s - station.line.now_s))
        station.line.send_bytes(frame)
        if (answer := ANSWERS.get(message.get_type())) is None:
            continue
        wanted[answer] += 1
        if station.hear_one(answer, 1.0) is None:
            silent.append(str(message))
    assert wanted["COMMAND_ACK"] > 5
    assert silent == []
