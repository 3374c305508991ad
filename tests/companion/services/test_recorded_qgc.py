"""What a real QGroundControl 4.4 sent, sent again to our boat, and held to what it makes of answers.

The recordings lie beside the repository; without them there is nothing to test.
"""

from collections.abc import Iterator
from pathlib import Path
from struct import unpack_from

import pytest
from boat_rig import QGC, Rig
from data_files import RECORDINGS

from companion.mavlink.dialect import Message, dialect
from companion.mavlink.framing import claimed_length

pytestmark = pytest.mark.slow

MOST_S = 40.0
ACCEPTED = 0
COMMANDS = ("COMMAND_LONG", "COMMAND_INT")
ANSWERED_BY = {"PARAM_SET": "PARAM_VALUE", "MISSION_REQUEST_LIST": "MISSION_COUNT"}


def sent_by_station(recording: Path) -> Iterator[tuple[float, bytes, Message]]:
    """Seconds since the beginning, frame and message of what the station sent."""
    log, at, began_us = recording.read_bytes(), 0, 0
    parser = dialect.MAVLink(None)
    while at + 8 < len(log):
        (stamp_us,) = unpack_from(">Q", log, at)
        began_us = began_us or stamp_us
        length = claimed_length(log, at + 8)
        frame = log[at + 8 : at + 8 + length]
        at += 8 + length
        message = parser.decode(bytearray(frame))
        if message.get_srcSystem() == QGC.system:
            yield (stamp_us - began_us) * 1e-6, frame, message


def answers_to(rig: Rig, at_s: float, frame: bytes) -> list[Message]:
    """What the boat says to a frame before its next tick."""
    while rig.now_s < at_s:
        rig.step()
    rig.peer.listen()
    assert rig.peer.link.send(frame)
    rig.receive()
    return rig.peer.listen()


@pytest.mark.parametrize("recording", RECORDINGS, ids=lambda path: path.stem)
def test_each_command_has_one_answer_and_what_it_asked_for_comes_behind(recording: Path) -> None:
    rig = Rig().ready()
    began_s, asked, brought = rig.now_s, 0, 0
    for at_s, frame, message in sent_by_station(recording):
        if at_s > MOST_S:
            break
        answers = answers_to(rig, began_s + at_s, frame)
        if message.get_type() not in COMMANDS:
            answer = ANSWERED_BY.get(message.get_type())
            assert answer is None or answer in {one.get_type() for one in answers}, message
            continue
        asked += 1
        places = [place for place, one in enumerate(answers) if one.get_type() == "COMMAND_ACK"]
        assert len(places) == 1, message
        ack = answers[places[0]]
        assert (ack.command, ack.target_system, ack.target_component) == (message.command, *QGC)
        if message.command == dialect.MAV_CMD_REQUEST_MESSAGE and ack.result == ACCEPTED:
            wanted = [place for place, one in enumerate(answers) if one.get_msgId() == int(message.param1)]
            assert wanted, f"{message} was accepted, and nothing came"
            assert places[0] < min(wanted), f"{message}: a client that waits for the answer misses it"
            brought += 1
    assert asked > 5
    assert brought > 0
    assert rig.boat.endpoint.faults == 0
