"""The JSON interface for ArduPilot's simulator: packets, lines, lockstep, and a small autopilot of ours."""

import json
import math
import socket
import struct
import threading
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from patience import MOMENT_S

from companion.core.errors import ConfigError, LinkError
from companion.core.units import wrap_pi
from sitl.physics.backend import Backend
from sitl.physics.json_interface import parse_servos
from sitl.physics.udp_server import PhysicsServer
from sitl.scenarios.scenario import load_scenario
from sitl.world.scenario import Scenario

# A packet byte by byte as the interface's description has it: magic 18458, 50 Hz, frame 7, then 16 pulses
PACKET = bytes.fromhex("1a48 3200 07000000 d007 dc05 e803" + " dc05" * 13)
CENTRE = 1500


def packet(
    frame: int, left: int = CENTRE, right: int = CENTRE, rate_hz: int = 50, channels: int = 16
) -> bytes:
    """Servo outputs 1 and 3 set, the others in the middle."""
    pulses = [left, CENTRE, right] + [CENTRE] * (channels - 3)
    magic = 18458 if channels == 16 else 29569
    return struct.pack(f"<HHI{channels}H", magic, rate_hz, frame, *pulses)


@pytest.fixture
def scenario() -> Scenario:
    """Open water, no weather."""
    return load_scenario("open")


def state(line: bytes | None) -> dict[str, Any]:
    """What a line says."""
    assert line is not None
    assert line.startswith(b"\n")
    assert line.endswith(b"\n")
    assert line.count(b"\n") == 2
    told: dict[str, Any] = json.loads(line)
    return told


@pytest.mark.parametrize("pulse_us", [0, 700, 65535])
def test_no_pulse_or_an_impossible_one_stops_the_motor(pulse_us: int) -> None:
    servos = parse_servos(packet(1, pulse_us))
    assert servos is not None
    assert servos.share(1) == 0.0


@given(st.binary(max_size=120))
def test_anything_else_is_no_packet_and_never_raises(data: bytes) -> None:
    servos = parse_servos(data)
    assert servos is None or len(data) in (40, 72)


@pytest.mark.parametrize("broken", [PACKET[:-1], PACKET + b"\0", b"\0\0" + PACKET[2:]])
def test_a_packet_that_is_cut_or_has_another_magic_is_ignored(scenario: Scenario, broken: bytes) -> None:
    backend = Backend(scenario)
    assert backend.handle(broken) is None
    assert (backend.ignored, backend.steps) == (1, 0)


def test_time_passes_by_frames_alone_and_a_repeated_frame_steps_nothing(scenario: Scenario) -> None:
    backend = Backend(scenario)
    first = backend.handle(packet(1, 1800, 1800))
    assert backend.handle(packet(1, 1800, 1800)) == first
    assert (backend.steps, backend.world.tick) == (1, 1)
    assert state(backend.handle(packet(9, 1800, 1800)))["timestamp"] == pytest.approx(0.04)


@pytest.mark.parametrize(("rate_hz", "steps"), [(1200, 1), (50, 1), (10, 2), (1, 20)])
def test_a_frame_lasts_as_long_as_asked_in_steps_that_the_hull_can_take(
    scenario: Scenario, rate_hz: int, steps: int
) -> None:
    backend = Backend(scenario)
    told = state(backend.handle(packet(1, rate_hz=rate_hz)))
    assert told["timestamp"] == pytest.approx(1.0 / rate_hz)
    assert backend.steps == steps


def test_an_autopilot_of_ours_holds_a_heading_over_a_real_socket(scenario: Scenario) -> None:
    server = PhysicsServer(Backend(scenario), port=0)
    done = threading.Event()
    thread = threading.Thread(target=server.run, args=(done.is_set,))
    port = server.port
    thread.start()
    try:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as link:
            link.settimeout(MOMENT_S)
            link.connect(("127.0.0.1", port))
            link.send(b"not a packet")
            turn = 0.0
            for frame in range(1, 600):
                link.send(packet(frame, round(1650 + turn), round(1650 - turn)))
                told = state(link.recv(4096))
                error = wrap_pi(1.0 - told["attitude"][2])
                turn = min(max(300.0 * error - 250.0 * told["imu"]["gyro"][2], -300.0), 300.0)
    finally:
        done.set()
        thread.join()
    assert told["attitude"][2] == pytest.approx(1.0, abs=0.05)
    assert math.hypot(*told["velocity"][:2]) > 0.5


@pytest.mark.parametrize(("left", "right"), [(0, 3), (1, 17), (2, 2)])
def test_outputs_that_cannot_be_are_refused(scenario: Scenario, left: int, right: int) -> None:
    with pytest.raises(ConfigError, match=r"expected"):
        Backend(scenario, left, right)


def test_a_port_that_is_taken_is_said_in_words(scenario: Scenario) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        with pytest.raises(LinkError, match="cannot listen"):
            PhysicsServer(Backend(scenario), port=taken.getsockname()[1])
