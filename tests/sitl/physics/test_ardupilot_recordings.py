"""What the real ArduPilot Rover sends: packets recorded from its 4.7-dev of July 2025, built unchanged.

It ran with `--model JSON:127.0.0.1` against this project's `boat-sitl physics`. Frame 0 comes when a station
has connected, at 1200 frames/s unless SIM_RATE_HZ says otherwise.
"""

import pytest

from sitl.__main__ import run_program
from sitl.physics.backend import Backend
from sitl.physics.json_interface import ServoPacket, parse_servos
from sitl.scenarios.scenario import load_scenario

RATE_HZ = 1200
MIDDLE, LOW = "dc05", "e803"
# From frame 0 on: outputs 1 to 4 in the middle, all others at 1000 µs
FIRST = bytes.fromhex("1a48b00400000000" + MIDDLE * 4 + LOW * 12)
# From frame 2240 on, for 24 frames: output 1 at 1000 µs, whatever its function, and no other pulse
SETTING_UP = bytes.fromhex("1a48b004c0080000" + LOW + "0000" * 15)
# The same moment of another build: outputs 1 and 3
SETTING_UP_BOTH = bytes.fromhex("1a48b004c0080000" + LOW + "0000" + LOW + "0000" * 13)
# From frame 2264 on, disarmed: outputs that have a function, here 73 and 74 on these two
READY = {
    (1, 3): bytes.fromhex("1a48b004d8080000" + (MIDDLE + "0000") * 2 + "0000" * 12),
    (1, 2): bytes.fromhex("1a48b004d8080000" + MIDDLE * 2 + "0000" * 14),
    (5, 7): bytes.fromhex("1a48b004d8080000" + LOW + "0000" * 3 + (MIDDLE + "0000") * 2 + "0000" * 8),
}
OUTPUTS = sorted(READY)
# The same moment with SERVO_32_ENABLE 1: another magic, and twice as many outputs
READY_32 = bytes.fromhex("8173b004d8080000" + (MIDDLE + "0000") * 2 + "0000" * 28)
# Armed in AUTO, the first three packets that turn the boat to port
UNDER_WAY = ((65587, 1496, 1506), (65611, 1490, 1512), (65635, 1484, 1519))


def at_frame(data: bytes, frame: int) -> bytes:
    """The same outputs at another frame: Rover repeats them until they change."""
    return data[:4] + frame.to_bytes(4, "little") + data[8:]


def driven(frame: int, outputs: tuple[int, int], left_us: int, right_us: int) -> bytes:
    """A recorded packet with these pulses."""
    data = bytearray(at_frame(READY[outputs], frame))
    for output, pulse_us in zip(outputs, (left_us, right_us), strict=True):
        data[6 + 2 * output : 8 + 2 * output] = pulse_us.to_bytes(2, "little")
    return bytes(data)


def start_up(backend: Backend, outputs: tuple[int, int], setting_up: bytes = SETTING_UP) -> None:
    """Rover's first two seconds, then one more of waiting for its estimator."""
    for frame in range(2240):
        backend.handle(at_frame(FIRST, frame))
    for frame in range(2240, 2264):
        backend.handle(at_frame(setting_up, frame))
    for frame in range(2264, 3464):
        backend.handle(at_frame(READY[outputs], frame))


def in_a_current(outputs: tuple[int, int] = (1, 3)) -> Backend:
    """A boat that anything but a mooring would let drift."""
    return Backend(load_scenario("open", ("environment.current_m_s=0.5",)), *outputs)


@pytest.mark.parametrize("data", [FIRST, SETTING_UP, SETTING_UP_BOTH, *READY.values(), READY_32])
def test_recorded_packets_are_read(data: bytes) -> None:
    servos = parse_servos(data)
    assert isinstance(servos, ServoPacket)
    assert (servos.rate_hz, len(servos.pulses_us)) == (RATE_HZ, 32 if data is READY_32 else 16)


def test_the_pulses_of_32_outputs_are_where_those_of_16_are() -> None:
    few, many = parse_servos(READY[(1, 3)]), parse_servos(READY_32)
    assert few is not None
    assert many is not None
    assert (few.frame, few.pulses_us[:3]) == (many.frame, many.pulses_us[:3]) == (2264, (1500, 0, 1500))


@pytest.mark.parametrize(
    ("outputs", "setting_up"), [((1, 3), SETTING_UP_BOTH), ((1, 2), SETTING_UP), ((5, 7), SETTING_UP)]
)
def test_the_boat_stays_moored_while_rover_starts(outputs: tuple[int, int], setting_up: bytes) -> None:
    backend = in_a_current(outputs)
    start = backend.world.scenario.start
    start_up(backend, outputs, setting_up)
    truth = backend.world.truth
    assert truth.time_s == pytest.approx(3464 / RATE_HZ)
    assert (truth.north_m, truth.east_m) == (start.north_m, start.east_m)
    assert (truth.left_thrust_n, truth.right_thrust_n) == (0.0, 0.0)


@pytest.mark.parametrize("outputs", OUTPUTS)
def test_the_boat_casts_off_when_rover_first_drives(outputs: tuple[int, int]) -> None:
    backend = in_a_current(outputs)
    start = backend.world.scenario.start
    start_up(backend, outputs)
    for frame, left_us, right_us in UNDER_WAY:
        backend.handle(driven(frame, outputs, left_us, right_us))
    for frame in range(65636, 65636 + RATE_HZ):
        backend.handle(driven(frame, outputs, 1484, 1519))
    assert backend.world.truth.east_m - start.east_m > 0.1


def test_the_boat_casts_off_after_a_tenth_of_a_second_of_drive_without_a_pause() -> None:
    backend = in_a_current()
    start = backend.world.scenario.start
    start_up(backend, (1, 3))
    frame = 3464
    for driven_frames, is_moored in (
        (RATE_HZ // 10 - 1, True),
        (RATE_HZ // 10 - 1, True),
        (RATE_HZ // 10, False),
    ):
        for _ in range(driven_frames):
            backend.handle(driven(frame, (1, 3), 1000, 1000))
            frame += 1
        backend.handle(at_frame(READY[(1, 3)], frame))
        frame += 1
        assert (backend.world.truth.north_m == start.north_m) is is_moored


def test_rover_that_is_rebooted_finds_the_boat_moored_again() -> None:
    backend = in_a_current()
    start = backend.world.scenario.start
    start_up(backend, (1, 3))
    for frame in range(3464, 3464 + RATE_HZ):
        backend.handle(driven(frame, (1, 3), 1900, 1900))
    assert backend.world.truth.north_m != start.north_m
    start_up(backend, (1, 3))
    assert backend.restarts == 1
    assert (backend.world.truth.north_m, backend.world.truth.east_m) == (start.north_m, start.east_m)


def test_rover_that_is_under_way_when_this_side_starts_again_goes_on() -> None:
    backend = in_a_current()
    for frame in range(65636, 65636 + RATE_HZ):
        backend.handle(driven(frame, (1, 3), 1900, 1900))
    assert backend.world.truth.north_m > 0.1


class IdleServer:
    """A server that nobody calls."""

    def __init__(self, backend: Backend, host: str, port: int) -> None:
        self.backend, self.host, self.port = backend, host, port

    def run(self, *_: object) -> None:
        """End at once."""


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ((), "--model JSON:127.0.0.1 --home"),
        (("--port", "9222"), "--model JSON:127.0.0.1 --sim-port-out 9222 --home"),
    ],
)
def test_the_printed_command_sends_rover_to_the_port_in_use(
    options: tuple[str, ...], told: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Rover sends to 9002 unless `--sim-port-out` names another port, as its --help says."""
    monkeypatch.setattr("sitl.cli.physics.PhysicsServer", IdleServer)
    assert run_program(["physics", "open", "--left", "5", "--right", "7", *options]) == 0
    printed = capsys.readouterr().out
    assert f"  ardurover {told} 50.0000000,-1.2000000,0,0\n" in printed
    assert "SERVO5_FUNCTION 73 (left motor)" in printed
    assert "SERVO7_FUNCTION 74 (right motor)" in printed
