"""How many boats does one core carry in real time? Fifty in one process, all under way, all talking."""

import json
import math
import os
import signal
import socket
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from benchmarks.measure import Row, alone
from companion.app.status_file import BoatStatus, read_status
from companion.boat import TICK_S
from companion.core.modes import Mode
from companion.core.units import deg_to_e7
from companion.mavlink.address import Address
from companion.mavlink.codec import Decoder, Encoder
from companion.mavlink.dialect import Message, dialect

_BOATS = 50
_SECONDS = 20.0
_START_S = 60.0
_FAR_DEG = 0.02  # two kilometres: nobody arrives

Process = subprocess.Popen[bytes]


def rows() -> list[Row]:
    """Share of a core, ticks that began more than 5 ms late, and how long ticks take, over some seconds."""
    with tempfile.TemporaryDirectory() as room:
        status, times = Path(room) / "status.json", Path(room) / "ticks.json"
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as line:
            line.bind(("127.0.0.1", 0))
            with _fleet(line.getsockname()[1], status, times) as process:
                station = _Station(line)
                station.release(time.monotonic() + _START_S)
                before, cpu_s, began_s = _settled(status, station), _cpu_s(process), time.monotonic()
                station.listen(time.monotonic() + _SECONDS)
                after, spent_s = _settled(status, station), _cpu_s(process) - cpu_s
                lasted_s = time.monotonic() - began_s
                under_way = sum(boat.speed_m_s > 0.5 for boat in station.boats.values())
        ticks_ms = [1e3 * tick_s for tick_s in json.loads(times.read_text())[before.ticks : after.ticks]]
    ticks = after.ticks - before.ticks
    late = 100.0 * (after.late_ticks - before.late_ticks) / ticks
    skipped = after.skipped_ticks - before.skipped_ticks
    note = f"{under_way} under way, {ticks / lasted_s:.1f} ticks per second of 50, {skipped} skipped"
    return [
        Row(
            f"share of a core for {_BOATS} boats in one process",
            "%",
            "less",
            100.0 * spent_s / lasted_s,
            0.0,
            note=note,
        ),
        Row("ticks of these boats that began more than 5 ms late", "%", "less", late, 0.0),
        alone("CPU time of a tick of these boats", "ms", "less", ticks_ms, _distribution(ticks_ms)),
    ]


def _distribution(ticks_ms: list[float]) -> str:
    """Percentiles of the ticks' CPU time."""
    hundredths = statistics.quantiles(ticks_ms, n=100)
    over = sum(tick_ms > 1e3 * TICK_S for tick_ms in ticks_ms)
    return (
        f"p90 {hundredths[89]:.1f}, p99 {hundredths[98]:.1f}, worst {max(ticks_ms):.1f} ms; "
        f"{over} of {len(ticks_ms)} above {1e3 * TICK_S:.0f} ms"
    )


class _Boat:
    """The station's data about one boat."""

    def __init__(self, at: tuple[str, int]) -> None:
        self.at = at
        self.lat_e7 = self.lon_e7 = 0
        self.speed_m_s = 0.0
        self.is_armed = False


class _Station:
    """One UDP socket that all boats talk to."""

    def __init__(self, line: socket.socket) -> None:
        self.boats: dict[int, _Boat] = {}
        self._line = line
        self._encoder = Encoder(Address(255, dialect.MAV_COMP_ID_MISSIONPLANNER))
        self._decoder = Decoder(datagram=True)
        self._beat_s = 0.0

    def release(self, until_s: float) -> None:
        """Send every boat far away, one after the other in bearing.

        Raises:
            TimeoutError: some are not armed in time.
        """
        while time.monotonic() < until_s:
            self.listen(time.monotonic() + 1.0)
            waiting = [system for system, boat in self.boats.items() if not boat.is_armed]
            if len(self.boats) == _BOATS and not waiting:
                return
            for system in waiting:
                if self.boats[system].lat_e7:
                    self._order(system, self.boats[system])
        raise TimeoutError(
            f"{len(waiting)} of {len(self.boats)} boats are not under way after {_START_S:g} s"
        )

    def listen(self, until_s: float) -> None:
        """Receive from all boats, and send the heartbeat."""
        while (left_s := until_s - time.monotonic()) > 0.0:
            self._line.settimeout(left_s)
            try:
                data, at = self._line.recvfrom(2048)
            except TimeoutError:
                return
            for received in self._decoder.feed(data):
                boat = self.boats.setdefault(received.sender.system, _Boat(at))
                self._hear(boat, received.message)
            if time.monotonic() >= self._beat_s:
                self._beat_s = time.monotonic() + 1.0
                beat = dialect.MAVLink_heartbeat_message(dialect.MAV_TYPE_GCS, 8, 0, 0, 4, 3)
                for boat in self.boats.values():
                    self._send(boat, beat)

    def _hear(self, boat: _Boat, message: Message) -> None:
        match message.get_type():
            case "HEARTBEAT":
                boat.is_armed = bool(message.base_mode & dialect.MAV_MODE_FLAG_SAFETY_ARMED)
            case "GLOBAL_POSITION_INT":
                boat.lat_e7, boat.lon_e7 = message.lat, message.lon
            case "VFR_HUD":
                boat.speed_m_s = message.groundspeed

    def _order(self, system: int, boat: _Boat) -> None:
        to = (system, 1)
        bearing = math.tau * system / _BOATS
        lat_e7 = boat.lat_e7 + deg_to_e7(_FAR_DEG * math.cos(bearing))
        lon_e7 = boat.lon_e7 + deg_to_e7(_FAR_DEG * math.sin(bearing))
        command, go = dialect.MAVLink_command_long_message, dialect.MAVLink_command_int_message
        self._send(boat, command(*to, dialect.MAV_CMD_DO_SET_MODE, 0, 1, int(Mode.GUIDED), 0, 0, 0, 0, 0))
        self._send(boat, command(*to, dialect.MAV_CMD_COMPONENT_ARM_DISARM, 0, 1, 0, 0, 0, 0, 0, 0))
        self._send(boat, go(*to, 6, dialect.MAV_CMD_DO_REPOSITION, 0, 0, -1, 1, 0, 0, lat_e7, lon_e7, 0))

    def _send(self, boat: _Boat, message: Message) -> None:
        self._line.sendto(self._encoder.encode(message), boat.at)


@contextmanager
def _fleet(port: int, status: Path, times: Path) -> Iterator[Process]:
    command = [sys.executable, "-m", "benchmarks.timed_fleet", str(times), "serve", "open", "--no-tcp"]
    command += ["--state", "none"]
    command += ["--count", str(_BOATS), "--udp", f"127.0.0.1:{port}", "--status", str(status)]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    try:
        yield process
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(timeout=10)


def _settled(status: Path, station: _Station) -> BoatStatus:
    """The status as it is once a second has gone into it."""
    station.listen(time.monotonic() + 1.2)
    return read_status(status)


def _cpu_s(process: Process) -> float:
    fields = Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
