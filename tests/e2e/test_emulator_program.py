"""`boat-sitl serve` as a process: how it begins, how it ends, and what it will not do."""

import re
import signal
import socket
import time

import pytest
from mavutil_station import OpenStation, zigzag
from programs import RunBoat, RunProgram

pytestmark = pytest.mark.realtime
pytest_plugins = ("program_fixtures",)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_ends_it_with_0_while_a_station_is_on_the_line(
    running_boat: RunBoat, open_station: OpenStation, number: signal.Signals
) -> None:
    boat = running_boat("open")
    station = open_station(boat.port)
    station.offer(3)
    station.give(zigzag(2), [0])  # in the middle of an upload
    boat.program.send(number)
    ended = boat.program.wait()
    assert (ended.code, ended.err) == (0, "")
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.1", boat.port), timeout=1.0)


def test_a_port_that_is_taken_is_no_link(running_boat: RunBoat, run_program: RunProgram) -> None:
    boat = running_boat("open")
    ended = run_program("boat-sitl", "serve", "open", "--tcp", str(boat.port), "--no-udp").wait()
    assert (ended.code, ended.out) == (3, "")
    assert re.fullmatch(rf"boat-sitl: tcpin:127\.0\.0\.1:{boat.port}: cannot listen .*\n", ended.err)


def test_it_listens_on_this_machine_only(running_boat: RunBoat) -> None:
    boat = running_boat("open")
    # Anything of 127/8 reaches a server that listens on every address
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.2", boat.port), timeout=1.0)


def test_time_runs_as_fast_as_it_was_told(running_boat: RunBoat, open_station: OpenStation) -> None:
    station = open_station(running_boat("open", "--speedup", "10").port)
    first_ms = station.wait_for("SYSTEM_TIME").time_boot_ms
    began_s = time.monotonic()
    station.wait_for("SYSTEM_TIME", lambda now: now.time_boot_ms > first_ms + 20_000, timeout_s=20.0)
    # Two seconds, were nothing else going on; a busy machine may take longer, but none less
    assert 1.5 < time.monotonic() - began_s < 10.0
