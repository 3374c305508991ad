"""`boat-sitl serve` as a process: how it begins, how it ends, and what it will not do."""

import re
import signal
import socket
import time
from pathlib import Path

import pytest
from mavutil_station import OpenStation, zigzag
from patience import MOMENT_S
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
        socket.create_connection(("127.0.0.1", boat.port), timeout=MOMENT_S)


def test_a_port_that_is_taken_is_wrong_usage_and_explained(
    running_boat: RunBoat, run_program: RunProgram
) -> None:
    boat = running_boat("open")
    ended = run_program("boat-sitl", "serve", "open", "--tcp", str(boat.port), "--no-udp").wait()
    assert (ended.code, ended.out) == (2, "")
    assert re.fullmatch(rf"boat-sitl: tcpin:127\.0\.0\.1:{boat.port}: cannot listen .*\n", ended.err)
    assert "another program has this port" in ended.err
    assert "ss -tulpn" in ended.err
    assert "--tcp" in ended.err


def test_a_restart_keeps_the_mission_and_calls_from_the_same_port(
    run_program: RunProgram, open_station: OpenStation, tmp_path: Path
) -> None:
    """As a ground station sees it: the same address, and the plan that it still shows."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    missions, sources = [], []
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listener:
        listener.bind(("127.0.0.1", 0))
        listener.settimeout(MOMENT_S)
        place = f"127.0.0.1:{listener.getsockname()[1]}"
        for start in range(2):
            program = run_program(
                *("boat-sitl", "serve", "open", "--tcp", str(port), "--udp", place),
                environment={"XDG_STATE_HOME": str(tmp_path / "kept")},
            )
            program.wait_for(r"logs are kept in (.*/kept/mavboat/open-\d+) \(--state none forgets them\)$")
            program.wait_for(r"^boat-sitl: ready")
            sources.append(listener.recvfrom(65535)[1])
            station = open_station(port)
            if start == 0:
                assert station.upload(zigzag(2)) == 0
            missions.append(len(station.download()))
            station.close()
            program.send(signal.SIGINT)
            assert program.wait().code == 0
    assert sources[0] == sources[1]
    assert missions == [3, 3]


def test_it_listens_on_this_machine_only(running_boat: RunBoat) -> None:
    boat = running_boat("open")
    # Anything of 127/8 reaches a server that listens on every address
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.2", boat.port), timeout=MOMENT_S)


def test_time_runs_as_fast_as_it_was_told(running_boat: RunBoat, open_station: OpenStation) -> None:
    station = open_station(running_boat("open", "--speedup", "10").port)
    began_s = time.monotonic()
    station.drain()  # what was sent before may have waited to be read
    first_ms = station.wait_for("SYSTEM_TIME").time_boot_ms
    station.wait_for("SYSTEM_TIME", lambda now: now.time_boot_ms > first_ms + 20_000)
    assert time.monotonic() - began_s > 1.5  # two seconds, or more where the machine is busy
