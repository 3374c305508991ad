"""The whole endpoint: a ground station's connection in order, and frames that mean harm."""

import json
import logging
import random
from collections.abc import Iterator
from pathlib import Path

import pytest
from boat_rig import BOAT, HOME_ITEM, OK, QGC, Peer, Rig, waypoint

from companion.mavlink.dialect import dialect

pytestmark = pytest.mark.slow

TABLE = json.loads((Path(__file__).parents[2] / "vectors" / "frames.json").read_text(encoding="utf-8"))
FRAMES = 6_000


def test_a_fault_of_ours_is_counted_logged_once_and_stops_nothing(
    caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    rig = Rig()
    rig.step()
    handlers = rig.boat.endpoint._handlers
    monkeypatch.setitem(handlers, dialect.MAVLINK_MSG_ID_PARAM_SET, lambda m, o, t: 1 / 0)
    with caplog.at_level(logging.ERROR):
        for _ in range(3):
            rig.peer.send(dialect.MAVLink_param_set_message(*BOAT, b"HDG_KP", 3.0, 9))
            rig.step()
    assert rig.boat.endpoint.faults == 3
    assert len(caplog.records) == 1
    assert rig.ask(dialect.MAV_CMD_REQUEST_MESSAGE, 148) == OK


def test_a_fault_in_telemetry_stops_neither_boat_nor_heartbeat(
    caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    rig = Rig().ready()
    monkeypatch.setattr(rig.boat.endpoint._telemetry, "tick", lambda now: 1 / 0)
    rig.peer.forget()
    with caplog.at_level(logging.ERROR):
        rig.run(3.0)
    assert len(rig.peer.said("HEARTBEAT")) == 3
    assert rig.boat.endpoint.faults == 150
    assert len(caplog.records) == 1


@pytest.mark.parametrize("busy", ["", "_missions", "_commands", "_listings", "_files", "_logs"])
def test_services_are_served_in_every_tick_while_one_is_busy_and_else_ten_times_a_second(
    busy: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    rig = Rig().ready()
    served: list[float] = []
    monkeypatch.setattr(rig.boat.endpoint._heartbeat, "tick", served.append)
    if busy:
        monkeypatch.setattr(type(getattr(rig.boat.endpoint, busy)), "is_busy", property(lambda _: True))
    rig.run(0.2)
    served.clear()
    rig.run(1.0)
    assert len(served) == 50 if busy else 8 <= len(served) <= 10


def test_a_message_that_cannot_be_packed_is_counted_and_others_are_sent(
    caplog: pytest.LogCaptureFixture,
) -> None:
    rig = Rig()
    rig.step()
    with caplog.at_level(logging.ERROR):
        for _ in range(2):
            rig.boat.endpoint.outbox.broadcast(dialect.MAVLink_message_interval_message(30, 2**40))
        rig.step()
    (channel,) = rig.boat.channels.open.values()
    assert channel.faults == 2
    assert len(caplog.records) == 1
    assert rig.ask(dialect.MAV_CMD_REQUEST_MESSAGE, 148) == OK


def hostile(rng: random.Random) -> Iterator[bytes]:
    """Noise, frames whose bits were flipped without mending the CRC, and pieces."""
    seeds = [bytes.fromhex(row["hex"]) for row in TABLE if "message" in row]
    while True:
        frame = bytearray(rng.choice(seeds))
        match rng.randrange(4):
            case 0:
                yield rng.randbytes(rng.randint(1, 300))
            case 1:
                yield bytes(frame[: rng.randrange(1, len(frame))])
            case _:
                head = 10 if frame[0] == 0xFD else 6
                at = rng.randrange(head, head + frame[1] + 2)  # payload or CRC: never a valid frame again
                frame[at] ^= 1 << rng.randrange(8)
                yield bytes(frame)


@pytest.mark.parametrize("is_datagram", [True, False], ids=["datagrams", "stream"])
def test_hostile_frames_change_nothing_but_counters(is_datagram: bool) -> None:
    rng = random.Random(7)
    rig = Rig(config={"failsafe.gcs_enabled": False}).sail(waypoint(400.0, 0.0), waypoint(400.0, 400.0))
    peer: Peer = rig.connect(QGC, is_datagram)
    rig.receive()
    before = rig.fingerprint()
    frames = hostile(rng)
    counters = rig.boat.channels.open[2].counters
    for n in range(FRAMES):
        assert peer.link.send(next(frames))
        if n % 15 == 14:
            rig.step()
            peer.link.receive()
            rig.peer.link.receive()
    assert rig.fingerprint() == before
    assert rig.boat.endpoint.faults == 0
    assert rig.boat.vehicle.armed
    assert counters.bad_crc > 600
    assert counters.bad_frames > counters.bad_crc
    assert rig.world.truth.north_m > 4.0  # all the while it has sailed on
    for _ in range(2):  # ends whatever seemed to have begun on a stream
        peer.link.send(bytes(300))
    assert rig.ask(dialect.MAV_CMD_REQUEST_MESSAGE, 148, peer=peer) == OK
    assert rig.items()[0] == HOME_ITEM
