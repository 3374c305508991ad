"""`boat-sitl serve` as a process: how it begins, how it ends, and what it will not do."""

import re
import signal
import socket
from pathlib import Path

import pytest
from mavutil_station import OpenStation, zigzag
from patience import MOMENT_S
from programs import RunBoat, RunProgram
from pymavlink.dialects.v20 import all as dialect

pytestmark = pytest.mark.realtime
pytest_plugins = ("program_fixtures",)


def test_it_keeps_its_port_listens_on_this_machine_and_ends_with_0_in_the_middle_of_an_upload(
    running_boat: RunBoat, run_program: RunProgram, open_station: OpenStation
) -> None:
    boat = running_boat("open")
    with pytest.raises(ConnectionRefusedError):  # 127/8 reaches a server that listens on every address
        socket.create_connection(("127.0.0.2", boat.port), timeout=MOMENT_S)
    second = run_program("boat-sitl", "serve", "open", "--tcp", str(boat.port), "--no-udp").wait()
    assert (second.code, second.out) == (2, "")
    assert re.fullmatch(rf"boat-sitl: tcpin:127\.0\.0\.1:{boat.port}: cannot listen .*\n", second.err)
    assert all(word in second.err for word in ("another program has this port", "ss -tulpn", "--tcp"))
    station = open_station(boat.port)
    station.offer(3)
    station.give(zigzag(2), [0])
    boat.program.send(signal.SIGTERM)
    ended = boat.program.wait()
    assert (ended.code, ended.err) == (0, "")
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.1", boat.port), timeout=MOMENT_S)


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


def test_a_reboot_begins_the_program_anew_in_the_same_process(
    running_boat: RunBoat, open_station: OpenStation
) -> None:
    boat = running_boat("open", "--state", "state")
    station = open_station(boat.port)
    pid, said = boat.program.pid, len(boat.program.out)
    link = station.link
    link.mav.param_set_send(1, 1, b"WP_RADIUS", 3.25, 9)
    station.wait_for("PARAM_VALUE", lambda value: value.param_id == "WP_RADIUS")
    station.wait_for("SYSTEM_TIME", lambda now: now.time_boot_ms > 1500)
    link.mav.command_long_send(1, 1, dialect.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 0, 1, 0, 0, 0, 0, 0, 0)
    ack = station.wait_for("COMMAND_ACK")
    assert ack.result == dialect.MAV_RESULT_ACCEPTED
    again = boat.program.wait_for(r"on tcpin:127\.0\.0\.1:(\d+)$", after=said)
    boat.program.wait_for(r"^boat-sitl: ready", after=said)
    assert boat.program.pid == pid
    assert boat.program.is_running
    port = int(re.findall(r":(\d+)$", again[0])[-1])
    fresh = open_station(port)
    assert fresh.wait_for("SYSTEM_TIME").time_boot_ms < 15_000
    fresh.link.mav.param_request_read_send(1, 1, b"WP_RADIUS", -1)
    assert fresh.wait_for("PARAM_VALUE").param_value == 3.25
