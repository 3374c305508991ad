"""What does garbage do to the loop and to the stations on other links? 10 MB/s of it, over TCP and over UDP.

Over UDP it comes from a source that has announced itself, which is the harder case: a source that has sent no
frame costs one look a datagram. Two stations listen meanwhile, one on TCP and one on the very UDP port that
is flooded. Then 1,000 silent connections are opened before a station connects. On a machine that others use,
too, run it with real-time priority: `chrt -f 1 python -m benchmarks garbage`.
"""

import contextlib
import os
import random
import resource
import socket
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path

from benchmarks.measure import Row
from benchmarks.served_boat import served_boat
from companion.app.status_file import BoatStatus, read_status
from companion.mavlink.address import Address
from companion.mavlink.codec import Encoder
from companion.mavlink.dialect import dialect

_BYTES_S = 10_000_000
_SECONDS = 6.0
_DATAGRAM_BYTES = 1400
_PACE_S = 0.005
_SILENT = 1000
_PATTERNS = {
    "no garbage": b"",
    "0x00": b"\0",
    "0xFD": b"\xfd",
    "0xFE": b"\xfe",
    "random bytes": random.Random(1).randbytes(50_000),
    "headers without a message": b"\xfd\x00\x00",
    "heartbeats with a wrong checksum": b"\xfd\x09\x00\x00\x00\x01\x01\x00\x00\x00" + bytes(11),
}


def rows() -> list[Row]:
    """Ticks that began within 10 ms of their time, with the stations' longest gaps, and the row of
    the silent connections.
    """
    found: list[Row] = []
    with tempfile.TemporaryDirectory() as room:
        status = Path(room) / "status.json"
        with _boat(status) as (tcp, udp):
            stations = [_Station(tcp), _Station(udp, is_datagram=True)]
            with contextlib.ExitStack() as hanging_up:
                for station in stations:
                    hanging_up.callback(station.close)
                for name, pattern in _PATTERNS.items():
                    for kind in ("TCP", "UDP") if pattern else ("TCP",):
                        found.append(_flooded(name, kind, pattern, (tcp, udp), status, stations))
            found.append(_crowded(tcp))
    return found


def _flooded(
    name: str, kind: str, pattern: bytes, ports: tuple[int, int], status: Path, stations: list["_Station"]
) -> Row:
    flood = _Flood(kind, ports[kind == "UDP"], pattern) if pattern else None
    _listen(stations, 1.0)
    before = _settled(status, stations)
    for station in stations:
        station.longest_gap_s = 0.0
    sent_before = flood.sent_bytes if flood is not None else 0
    began_s = time.monotonic()
    _listen(stations, _SECONDS)
    sent = (flood.sent_bytes if flood is not None else 0) - sent_before
    rate = 1e-6 * sent / (time.monotonic() - began_s)
    gaps = [station.longest_gap_s for station in stations]
    after = _settled(status, stations)
    if flood is not None:
        flood.close()
    ticks = after.ticks - before.ticks
    output_at = 100.0 * (1.0 - (after.late_ticks - before.late_ticks) / ticks)
    what = f"{name}, over {kind}" if pattern else name
    priority = "" if os.sched_getscheduler(0) == os.SCHED_OTHER else ", real-time priority"
    skipped = after.skipped_ticks - before.skipped_ticks
    note = f"{rate:.1f} MB/s accepted, longest gap {max(gaps):.2f} s, {skipped} ticks skipped{priority}"
    return Row(f"ticks within 10 ms, {what}", "%", "more", output_at, 0.0, note=note)


def _crowded(port: int) -> Row:
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(hard, max(soft, 2 * _SILENT)), hard))
    with contextlib.ExitStack() as hanging_up:
        for _ in range(_SILENT):
            hanging_up.enter_context(socket.create_connection(("127.0.0.1", port), timeout=10.0))
        began_s = time.monotonic()
        station = _Station(port)
        hanging_up.callback(station.close)
        while not station.messages:
            _listen([station], 0.01)
        took_s = time.monotonic() - began_s
        station.longest_gap_s = 0.0
        _listen([station], 3.0)
        note = f"longest gap in the 3 s after that {station.longest_gap_s:.2f} s"
    question = f"first message to a station that connects after {_SILENT:,} silent connections"
    return Row(question, "s", "less", took_s, 0.0, note=note)


class _Station:
    """Sends a heartbeat once a second, and records the longest gap in reception."""

    def __init__(self, port: int, *, is_datagram: bool = False) -> None:
        kind = socket.SOCK_DGRAM if is_datagram else socket.SOCK_STREAM
        self._socket = socket.socket(socket.AF_INET, kind)
        self._socket.settimeout(10.0)
        self._socket.connect(("127.0.0.1", port))
        self._socket.setblocking(False)
        self._encoder = Encoder(Address(254 if is_datagram else 253, 190))
        self._beat_s = 0.0
        self._heard_s = time.monotonic()
        self.longest_gap_s = 0.0
        self.messages = 0

    def step(self) -> None:
        """Read all pending bytes; send a heartbeat when it is due."""
        now_s = time.monotonic()
        if now_s >= self._beat_s:
            self._beat_s = now_s + 1.0
            with contextlib.suppress(BlockingIOError):
                self._socket.send(self._encoder.encode(dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)))
        with contextlib.suppress(BlockingIOError):
            while self._socket.recv(65536):
                self.messages += 1
                self.longest_gap_s = max(self.longest_gap_s, now_s - self._heard_s)
                self._heard_s = now_s

    def close(self) -> None:
        """Close the connection."""
        self._socket.close()


class _Flood:
    """A thread that sends garbage as fast as the boat accepts it, at most 10 MB/s."""

    def __init__(self, kind: str, port: int, pattern: bytes) -> None:
        is_datagram = kind == "UDP"
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM if is_datagram else socket.SOCK_STREAM)
        self._socket.connect(("127.0.0.1", port))
        self._socket.settimeout(0.2)
        if is_datagram:
            self._socket.send(
                Encoder(Address(200, 1)).encode(dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))
            )
        size = _DATAGRAM_BYTES if is_datagram else 50_000
        self._piece = (pattern * (size // len(pattern) + 1))[:size]
        self._is_over = False
        self.sent_bytes = 0
        self._thread = threading.Thread(target=self._send, daemon=True)
        self._thread.start()

    def close(self) -> None:
        """End it."""
        self._is_over = True
        self._thread.join()
        self._socket.close()

    def _send(self) -> None:
        began_s, due = time.monotonic(), 0.0
        while not self._is_over:
            due = min(due, self.sent_bytes + 0.1 * _BYTES_S)
            due = max(due, (time.monotonic() - began_s) * _BYTES_S)
            while self.sent_bytes < due and not self._is_over:
                try:
                    self.sent_bytes += self._socket.send(self._piece)
                except TimeoutError:
                    began_s, due = time.monotonic() - self.sent_bytes / _BYTES_S, 0.0
                except OSError:
                    return
            time.sleep(_PACE_S)


def _listen(stations: list[_Station], seconds: float) -> None:
    end_s = time.monotonic() + seconds
    while time.monotonic() < end_s:
        for station in stations:
            station.step()
        time.sleep(0.002)


@contextlib.contextmanager
def _boat(status: Path) -> Iterator[tuple[int, int]]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        udp = free.getsockname()[1]
    arguments = ["--link", f"udpin:127.0.0.1:{udp}", "--status", str(status)]
    with served_boat(*arguments, cwd=Path.cwd(), program=(sys.executable, "-m", "benchmarks.late_boat")) as (
        _,
        tcp,
    ):
        yield tcp, udp


def _settled(status: Path, stations: list[_Station]) -> BoatStatus:
    """The current status; the boat writes it once a second."""
    _listen(stations, 1.1)
    return read_status(status)


if __name__ == "__main__":
    for row in rows():
        sys.stdout.write(f"{row.question}: {row.ours:.3f} {row.unit} {row.note}\n")
