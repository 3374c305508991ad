"""What does a message cost on its way from one UDP link to another, how long does it take, do all arrive?

The bridge is a program of its own: our whole boat with two more links, and MAVProxy. CPU time is what the
program used during the load less what it uses at rest.
"""

import contextlib
import os
import select
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.measure import Row, alone, of_pairs
from companion.mavlink.address import Address
from companion.mavlink.codec import Encoder
from companion.mavlink.dialect import dialect

_VEHICLE = Address(2, 1)
_SECONDS = 4.0
_REST_S = 2.0
_PEERS_HZ = 1000  # what MAVProxy carries without losing any
_OURS_HZ = 20_000
_ROUNDS = 3
_PEER = "MAVProxy"
_GIVE_UP_S = 1.0  # without a message
_NUMBER_AT = 10  # time_boot_ms, the first field of ATTITUDE, behind the header

Command = Callable[[int, int], list[str]]
"""The command line of a bridge that listens on one port and sends to another."""


@dataclass(frozen=True)
class Carried:
    """One run."""

    cpu_us: float  # a message
    loss: float  # share
    p50_us: float


def rows() -> list[Row]:
    """This router and MAVProxy in turn at 1,000 messages a second; this router alone at 20,000."""
    pairs = [(carry(_ours, _PEERS_HZ), carry(_mavproxy, _PEERS_HZ)) for _ in range(_ROUNDS)]
    fast = [carry(_ours, _OURS_HZ) for _ in range(_ROUNDS)]
    at = f"at {_PEERS_HZ:,} a second"
    return [
        of_pairs(
            f"CPU time to pass a message on, {at}", "µs", [(a.cpu_us, b.cpu_us) for a, b in pairs], _PEER
        ),
        of_pairs(f"median delay of a message, {at}", "µs", [(a.p50_us, b.p50_us) for a, b in pairs], _PEER),
        alone(f"CPU time to pass a message on, at {_OURS_HZ:,} a second", "µs", [one.cpu_us for one in fast]),
        alone(f"messages lost at {_OURS_HZ:,} a second", "%", [100.0 * one.loss for one in fast]),
    ]


def carry(command: Command, rate_hz: int, seconds: float = _SECONDS) -> Carried:
    """Run a bridge under load."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as station, _bridge(command, station) as bridge:
        pid, near = bridge
        station.setblocking(False)
        station.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as vehicle:
            vehicle.connect(("127.0.0.1", near))
            vehicle.setblocking(False)
            frames = _frames(round(rate_hz * seconds))
            _wake_up(vehicle, station)
            rest_s = _cpu_s(pid)
            time.sleep(_REST_S)
            rest_share = (_cpu_s(pid) - rest_s) / _REST_S
            began_s, before_s = time.monotonic(), _cpu_s(pid)
            delays_us = _load(vehicle, station, frames, rate_hz)
            took_s = time.monotonic() - began_s
            cpu_s = _cpu_s(pid) - before_s - rest_share * took_s
    in_order = sorted(delays_us)
    return Carried(
        cpu_us=1e6 * cpu_s / len(frames),
        loss=1.0 - len(in_order) / len(frames),
        p50_us=in_order[len(in_order) // 2] if in_order else 0.0,
    )


def _frames(count: int) -> list[bytes]:
    encoder = Encoder(_VEHICLE)
    attitude = dialect.MAVLink_attitude_message
    return [encoder.encode(attitude(n, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6)) for n in range(count)]


def _wake_up(vehicle: socket.socket, station: socket.socket) -> None:
    """Heartbeats until they arrive; then whatever else has arrived is thrown away."""
    encoder, end_s = Encoder(_VEHICLE), time.monotonic() + 30.0
    beat = dialect.MAVLink_heartbeat_message(dialect.MAV_TYPE_SURFACE_BOAT, 3, 81, 0, 4, 3)
    while time.monotonic() < end_s:
        with contextlib.suppress(ConnectionRefusedError, BlockingIOError):
            vehicle.send(encoder.encode(beat))
        time.sleep(0.1)
        while select.select([station], [], [], 0.0)[0]:
            if station.recv(4096)[5] == _VEHICLE.system:
                return
    raise AssertionError("the bridge never passed a heartbeat on")


def _load(
    vehicle: socket.socket, station: socket.socket, frames: Sequence[bytes], rate_hz: int
) -> list[float]:
    """Send at an even pace; the delay in µs of each message that arrives."""
    now = time.perf_counter
    sent_s = [0.0] * len(frames)
    delays_us: list[float] = []
    poll = select.poll()
    poll.register(station, select.POLLIN)
    began_s, at = now(), 0
    latest_s = began_s
    while len(delays_us) < len(frames) and now() - latest_s < _GIVE_UP_S:
        due = min(len(frames), int((now() - began_s) * rate_hz) + 1)
        for number in range(at, due):
            sent_s[number] = latest_s = now()
            with contextlib.suppress(BlockingIOError):
                vehicle.send(frames[number])
        at = due
        if not poll.poll(1):
            continue
        with contextlib.suppress(BlockingIOError):
            for _ in range(64):
                data = station.recv(4096)
                if data[5] == _VEHICLE.system and data[7] == dialect.MAVLINK_MSG_ID_ATTITUDE:
                    number = int.from_bytes(data[_NUMBER_AT : _NUMBER_AT + 4], "little")
                    latest_s = now()
                    delays_us.append(1e6 * (latest_s - sent_s[number]))
    return delays_us


@contextlib.contextmanager
def _bridge(command: Command, station: socket.socket) -> Iterator[tuple[int, int]]:
    """A running bridge: its process id and the port that it listens on."""
    station.bind(("127.0.0.1", 0))
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        near = free.getsockname()[1]
    with tempfile.TemporaryDirectory() as room:
        process = subprocess.Popen(
            command(near, station.getsockname()[1]),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            cwd=room,
            env={**os.environ, "HOME": room},
        )
        try:
            yield process.pid, near
        finally:
            process.terminate()
            try:
                process.wait(timeout=5)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def _cpu_s(pid: int) -> float:
    """User and system time of a process."""
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _ours(near: int, far: int) -> list[str]:
    program = str(Path(sys.executable).with_name("boat-sitl"))
    links = ["--link", f"udpin:127.0.0.1:{near}", "--link", f"udpout:127.0.0.1:{far}"]
    return [program, "serve", "open", "--no-tcp", "--no-udp", "--state", "none", *links]


def _mavproxy(near: int, far: int) -> list[str]:
    links = [f"--master=udpin:127.0.0.1:{near}", f"--out=udpout:127.0.0.1:{far}"]
    quiet = ["--daemon", "--non-interactive", "--nowait", "--default-modules="]
    return [sys.executable, str(Path(sys.executable).with_name("mavproxy.py")), *links, *quiet]
