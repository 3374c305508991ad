"""Telemetry logs of links, read back by pymavlink."""

from pathlib import Path

import pytest
from boat_rig import PLANNER
from log_rig import MemorySink, OpenRig
from pymavlink import mavutil

from companion.log.logbook import TelemetryLog
from companion.log.store import LogFile
from companion.mavlink.address import Address
from companion.mavlink.dialect import dialect

pytest_plugins = ("log_fixtures",)


def read_tlog(path: Path) -> list[object]:
    """Every message of a telemetry log."""
    link = mavutil.mavlink_connection(str(path))
    messages = []
    while (message := link.recv_match()) is not None:
        messages.append(message)
    link.close()
    return messages


def telemetry(files: tuple[LogFile, ...]) -> list[str]:
    return [file.name for file in files if file.name.endswith(".tlog")]


def test_what_both_sides_said_is_in_the_links_log_with_its_time(open_rig: OpenRig, tmp_path: Path) -> None:
    rig = open_rig(tmp_path, keeps_telemetry=True)
    rig.run(0.5)
    rig.peer.heartbeat()
    rig.run(2.0)
    rig.ask(dialect.MAV_CMD_REQUEST_MESSAGE, 148.0)
    rig.boat.close()
    (name,) = telemetry(rig.store.files)
    messages = read_tlog(tmp_path / name)
    heard = [(m.get_srcSystem(), m.get_type()) for m in messages]  # type: ignore[attr-defined]
    assert (1, "HEARTBEAT") in heard
    assert (1, "ATTITUDE") in heard
    assert (
        heard.index((255, "HEARTBEAT")) < heard.index((255, "COMMAND_LONG")) < heard.index((1, "COMMAND_ACK"))
    )
    assert not any(kind == "BAD_DATA" for _, kind in heard)
    times = [m._timestamp for m in messages]  # type: ignore[attr-defined]
    assert times == sorted(times)
    assert times[-1] == pytest.approx(rig.boat.take_snapshot().unix_s, abs=0.1)


def test_each_link_has_a_log_of_its_own_that_ends_with_it(open_rig: OpenRig, tmp_path: Path) -> None:
    rig = open_rig(tmp_path, keeps_telemetry=True)
    other = rig.connect(PLANNER)
    rig.run(1.0)
    assert len(telemetry(rig.store.files)) == 2
    other.link.close()
    rig.run(0.1)
    rig.store.erase()
    assert len(telemetry(rig.store.files)) == 1  # that of the link which is still there


def test_no_more_than_so_many_are_kept_at_a_time(open_rig: OpenRig, tmp_path: Path) -> None:
    rig = open_rig(tmp_path, keeps_telemetry=True)
    for number in range(30):
        rig.connect(Address(100 + number, 1))
    rig.run(0.2)
    assert len(telemetry(rig.store.files)) == 16


def test_frames_are_handed_over_each_second_and_when_there_are_many() -> None:
    sink = MemorySink()
    log = TelemetryLog(sink, lambda: 7)
    log.add(b"first")
    log.tick(0.0)
    log.add(b"second")
    log.tick(0.98)
    assert sink.blocks == [(7).to_bytes(8, "big") + b"first"]
    log.tick(1.0)
    assert sink.blocks[1].endswith(b"second")
    for _ in range(29):
        log.add(bytes(280))
    log.add(b"last")
    assert len(sink.blocks[2]) == 29 * (8 + 280)
