"""Does the control loop care for its stations? Four of them, three that behave badly, and the ticks counted.

One sails along, one asks for everything again and again, one floods 5,000 messages a second, one has asked
for all telemetry at full rate and no longer reads its TCP socket.
"""

import contextlib
import os
import socket
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from benchmarks.measure import Row
from benchmarks.served_boat import Process, served_boat
from companion.app.status_file import BoatStatus, read_status
from companion.mavlink.address import Address
from companion.mavlink.codec import Encoder
from companion.mavlink.dialect import Message, dialect

_SECONDS = 20.0
_FLOOD_HZ = 5000
_BOAT = Address(1, 1)
_ASK_S = 0.5
_STREAM_HZ = 50


def rows() -> list[Row]:
    """Ticks that began within 5 ms of their time, the worst of all, and how the memory grew."""
    with tempfile.TemporaryDirectory() as room:
        status = Path(room) / "status.json"
        with _boat(status) as (process, tcp, udp), contextlib.ExitStack() as hanging_up:
            stations = [_Station(number, tcp) for number in (255, 254, 253)]
            for station in stations:
                hanging_up.callback(station.close)
            flood = hanging_up.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
            flood.connect(("127.0.0.1", udp))
            _trouble(stations, flood, 5.0)  # until buffers are full and caches warm
            before, memory_before_kib = _settled(status), _memory_kib(process.pid)
            _trouble(stations, flood, _SECONDS)
            after, memory_after_kib = _settled(status), _memory_kib(process.pid)
    ticks = after.ticks - before.ticks
    output_at = 100.0 * (1.0 - (after.late_ticks - before.late_ticks) / ticks)
    grown_kib = float(memory_after_kib - memory_before_kib)
    note = f"{ticks} ticks, {after.skipped_ticks - before.skipped_ticks} skipped, load {after.load:.0%}"
    return [
        Row("ticks within 5 ms, four stations, three of them faulty", "%", "more", output_at, 0.0, note=note),
        Row("worst tick since the start", "ms", "less", 1e3 * after.worst_late_s, 0.0),
        Row(f"memory growth in {_SECONDS:g} s", "KiB", "less", grown_kib, 0.0),
    ]


class _Station:
    """Over TCP."""

    def __init__(self, system: int, port: int) -> None:
        self._socket = socket.create_connection(("127.0.0.1", port))
        self._socket.setblocking(False)
        self._encoder = Encoder(Address(system, 190))

    def send(self, message: Message) -> None:
        """Send one frame; it is lost if the socket is full."""
        with contextlib.suppress(BlockingIOError):
            self._socket.send(self._encoder.encode(message))

    def listen(self) -> None:
        """Read all pending bytes."""
        with contextlib.suppress(BlockingIOError):
            while self._socket.recv(65536):
                pass

    def close(self) -> None:
        """Close the connection."""
        self._socket.close()


def _trouble(stations: list[_Station], flood: socket.socket, seconds: float) -> None:
    """The traffic of the four stations, for a time."""
    good, asking, deaf = stations
    encoder = Encoder(Address(200, 1))
    frames = [encoder.encode(dialect.MAVLink_heartbeat_message(11, 3, 0, n, 4, 3)) for n in range(256)]
    began_s, sent, ask_s = time.monotonic(), 0, 0.0
    while (now_s := time.monotonic() - began_s) < seconds:
        due = int(now_s * _FLOOD_HZ)
        for number in range(sent, due):
            with contextlib.suppress(BlockingIOError):
                flood.send(frames[number % 256])
        sent = due
        if now_s >= ask_s:
            ask_s = now_s + _ASK_S
            for station in stations:
                station.send(dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))
            asking.send(dialect.MAVLink_param_request_list_message(*_BOAT))
            asking.send(dialect.MAVLink_mission_request_list_message(*_BOAT, 0))
            deaf.send(dialect.MAVLink_request_data_stream_message(*_BOAT, 0, _STREAM_HZ, 1))
        good.listen()
        asking.listen()
        time.sleep(0.001)


@contextlib.contextmanager
def _boat(status: Path) -> Iterator[tuple[Process, int, int]]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        udp = free.getsockname()[1]
    arguments = ["--link", f"udpin:127.0.0.1:{udp}", "--status", str(status)]
    with served_boat(*arguments, cwd=status.parent) as (process, tcp):
        yield process, tcp, udp


def _settled(status: Path) -> BoatStatus:
    """The current status; the boat writes it once a second."""
    time.sleep(1.1)
    return read_status(status)


def _memory_kib(pid: int) -> int:
    """Resident memory of a process."""
    resident_pages = int(Path(f"/proc/{pid}/statm").read_text(encoding="utf-8").split()[1])
    return resident_pages * os.sysconf("SC_PAGE_SIZE") // 1024


if __name__ == "__main__":
    for row in rows():
        sys.stdout.write(f"{row.question}: {row.ours:.3f} {row.unit} {row.note}\n")
