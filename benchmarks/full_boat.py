"""What does the boat cost with every part configured? Its share of a core, its memory, its first heartbeat.

`python -m benchmarks.full_boat 1.0` runs it for an hour of real time and prints memory, descriptors and
threads every minute.
"""

import contextlib
import os
import pty
import signal
import socket
import statistics
import subprocess
import sys
import tempfile
import time
import tty
from collections.abc import Callable, Iterator
from pathlib import Path

from benchmarks.measure import Row, alone
from companion.app.status_file import read_status
from companion.mavlink.address import Address
from companion.mavlink.codec import Decoder, Encoder
from companion.mavlink.dialect import Message, dialect

CORE_PERCENT, MEMORY_MB, HEARTBEAT_S = 6.0, 70.0, 1.5  # targets
Process = subprocess.Popen[bytes]

_BOAT = Address(1, 1)
_WARM_S, _SECONDS, _STARTS = 8.0, 20.0, 3
_STEP_S = 0.01
_LOITER = 5
_HEARTBEAT = dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)
_CRSF = bytes.fromhex("c81816e0031ff8c0073ef0810f7ce0031ff8c0073ef0810f7cad")  # sticks in the middle
_PING = bytes.fromhex("42520500bb040100b20c0000617802")  # distance_simple: 3250 mm, 97 %
_PROBE = b"7.01, 3.5\r\n"
_CRSF_HZ, _FIX_HZ, _GCS_HZ, _PING_HZ, _PROBE_HZ = 150.0, 5.0, 1.0, 5.0, 1.0
_CONFIG = """
links = ["udpout:127.0.0.1:{udp}", "tcpin:127.0.0.1:0", "serial:{radio}:57600"]
[parts]
rudder = {{driver = "servo", signal = {{output = "pca9685", channel = 2}}}}
gnss = {{driver = "nmea", port = "{gnss}", baud = 38400}}
compass = {{driver = "bno055", auto_declination = true}}
sonar = {{driver = "hcsr04", trigger = 23, echo = 24, servo = 18}}
battery = {{driver = "ina226", shunt_ohm = 0.01}}
depth = {{driver = "ping1d", port = "{sounder}", transducer_m = 0.1}}
pca9685 = {{output_enable = 26}}
hull = {{driver = "host", thermometer = "{thermometer}", leak = 25}}
[parts.motors]
driver = "esc"
arming_s = 0.5
left = {{output = "pca9685", channel = 0}}
right = {{output = "pca9685", channel = 1}}
[drive]
layout = "differential_rudder"
[rc]
driver = "crsf"
port = "{rc}"
[camera]
rtsp = "rtsp://127.0.0.1/boat"
[log]
tlog = true
min_free_mb = 0.0
[storage]
folder = "{folder}/state"
status_file = "{folder}/status.json"
[failsafe]
overrun_action = 0
[[probe]]
name = "ph"
driver = "ads1115"
channel = 3
rate_hz = 2.0
[[probe]]
name = "water_t"
driver = "file"
path = "{thermometer}"
scale = 0.001
[[probe]]
name = "turbidity"
driver = "serial"
port = "{probe}"
column = 1
[[payload]]
kind = "light"
number = 0
pin = 17
[[payload]]
kind = "servo"
number = 5
start = 1500
signal = {{output = "pca9685", channel = 5}}
[[payload]]
kind = "winch"
number = 1
out_pin = 22
in_pin = 27
"""


def rows() -> list[Row]:
    """CPU share over 20 s under way, resident memory at their end, and heartbeats of three starts."""
    heartbeats_s: list[float] = []
    starts_s: list[float] = []
    for number in range(_STARTS):
        with full_boat() as boat:
            heartbeats_s.append(boat.wait_for_heartbeat_s())
            starts_s.append(boat.cpu_s)
            if number < _STARTS - 1:
                continue
            boat.sail()
            boat.feed(_WARM_S)
            before_s, began_s = boat.cpu_s, time.monotonic()
            boat.feed(_SECONDS)
            percent = 100.0 * (boat.cpu_s - before_s) / (time.monotonic() - began_s)
            memory_mb = boat.resident_mb
            status = read_status(boat.status)
    ticks = f"{status.late_ticks} of {status.ticks} ticks late, {status.skipped_ticks} skipped"
    start = f"{statistics.median(starts_s):.2f} CPU s"
    what = "every part configured"
    return [
        alone(f"{what}: share of a core", "%", "less", [percent], f"target {CORE_PERCENT:g}; {ticks}"),
        alone(f"{what}: resident memory", "MB", "less", [memory_mb], f"target {MEMORY_MB:g}"),
        alone(f"{what}: first heartbeat", "s", "less", heartbeats_s, f"target {HEARTBEAT_S:g}; {start}"),
    ]


class FullBoat:
    """The program, the far ends of its lines, and a station."""

    def __init__(self, folder: Path, process: Process, station: socket.socket, lines: dict[str, int]) -> None:
        self.status = folder / "status.json"
        self._process = process
        self._began_s = time.monotonic()
        self._station = station
        self._lines = lines
        self._encoder, self._decoder = Encoder(Address(255, 190)), Decoder(datagram=True)
        self._boat: tuple[str, int] | None = None
        self._due_s = dict.fromkeys(("fix", "rc", "gcs", "depth", "probe"), 0.0)
        self._acknowledged: set[int] = set()

    def wait_for_heartbeat_s(self) -> float:
        """Seconds from the start of the process."""
        while self._boat is None:
            self.feed(_STEP_S)
            assert self._process.poll() is None, "the boat has ended"
        return time.monotonic() - self._began_s

    def sail(self) -> None:
        """Armed, in LOITER."""
        self.feed(3.0)
        self._command(dialect.MAV_CMD_DO_SET_MODE, 1.0, _LOITER)
        self._command(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 1.0, 2989.0)

    def feed(self, seconds: float) -> None:
        """Fixes, sticks and heartbeats for a time; everything that the boat sends is read."""
        end_s = time.monotonic() + seconds
        while time.monotonic() < end_s:
            self._every("fix", _FIX_HZ, lambda: self._write("gnss", _epoch(time.time())))
            self._every("depth", _PING_HZ, lambda: self._write("sounder", _PING))
            self._every("probe", _PROBE_HZ, lambda: self._write("probe", _PROBE))
            self._every("rc", _CRSF_HZ, lambda: self._write("rc", _CRSF))
            self._every("gcs", _GCS_HZ, lambda: self._send(_HEARTBEAT))
            self._listen()
            time.sleep(_STEP_S)

    @property
    def cpu_s(self) -> float:
        """Processor time of the boat's process."""
        fields = self._proc("stat").rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    @property
    def resident_mb(self) -> float:
        """Memory of the boat's process."""
        return int(self._proc("statm").split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6

    @property
    def descriptors(self) -> int:
        """Open files of the boat's process."""
        return len(os.listdir(f"/proc/{self._process.pid}/fd"))

    @property
    def threads(self) -> int:
        """Threads of the boat's process."""
        return len(os.listdir(f"/proc/{self._process.pid}/task"))

    def _proc(self, name: str) -> str:
        return Path(f"/proc/{self._process.pid}/{name}").read_text(encoding="utf-8")

    def _every(self, what: str, hertz: float, act: Callable[[], None]) -> None:
        now_s = time.monotonic()
        if now_s >= self._due_s[what]:
            self._due_s[what] = max(self._due_s[what] + 1.0 / hertz, now_s)
            act()

    def _write(self, line: str, data: bytes) -> None:
        with contextlib.suppress(BlockingIOError):
            os.write(self._lines[line], data)

    def _send(self, message: Message) -> None:
        if self._boat is not None:
            self._station.sendto(self._encoder.encode(message), self._boat)

    def _command(self, number: int, *params: float) -> None:
        self._acknowledged.discard(number)
        for _ in range(50):
            values = [*params, *([0.0] * (7 - len(params)))]
            self._send(dialect.MAVLink_command_long_message(*_BOAT, number, 0, *values))
            self.feed(0.2)
            if number in self._acknowledged:
                return
        raise AssertionError(f"command {number} was not accepted")

    def _listen(self) -> None:
        with contextlib.suppress(BlockingIOError):
            while True:
                data, address = self._station.recvfrom(65536)
                self._boat = address
                for received in self._decoder.feed(data):
                    message = received.message
                    if message.get_type() == "COMMAND_ACK" and message.result == 0:
                        self._acknowledged.add(message.command)
        with contextlib.suppress(BlockingIOError):
            while os.read(self._lines["radio"], 65536):
                pass
        with contextlib.suppress(BlockingIOError):
            while os.read(self._lines["sounder"], 65536):
                pass


@contextlib.contextmanager
def full_boat() -> Iterator[FullBoat]:
    """The program in a room of its own."""
    with tempfile.TemporaryDirectory() as room, contextlib.ExitStack() as ending:
        folder = Path(room)
        station = ending.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        station.bind(("127.0.0.1", 0))
        station.setblocking(False)
        lines: dict[str, int] = {}
        devices: dict[str, str] = {}
        for name in ("gnss", "rc", "radio", "sounder", "probe"):
            lines[name], far = pty.openpty()
            tty.setraw(far)
            os.set_blocking(lines[name], False)
            devices[name] = os.ttyname(far)
            ending.callback(os.close, lines[name])
            ending.callback(os.close, far)
        thermometer = folder / "temp"
        thermometer.write_text("45000\n", encoding="ascii")
        config = folder / "boat.toml"
        config.write_text(
            _CONFIG.format(udp=station.getsockname()[1], folder=folder, thermometer=thermometer, **devices),
            encoding="utf-8",
        )
        command = [sys.executable, "-m", "benchmarks.full_boat_program", room, "run", "--config", str(config)]
        with (folder / "log").open("wb") as log:
            process = subprocess.Popen(command, stderr=log)
        try:
            yield FullBoat(folder, process, station, lines)
        except BaseException:
            sys.stderr.write((folder / "log").read_text(encoding="utf-8"))
            raise
        finally:
            process.send_signal(signal.SIGTERM)
            process.wait(60.0)


def _epoch(unix_s: float) -> bytes:
    clock = time.strftime("%H%M%S", time.gmtime(unix_s)) + f"{unix_s % 1.0:.2f}"[1:]
    date = time.strftime("%d%m%y", time.gmtime(unix_s))
    lat = f"5030.{int(1e3 * unix_s) % 5:04d}"  # a receiver's noise: a metre
    return _sentence(f"GNRMC,{clock},A,{lat},N,00112.0000,W,0.1,90.0,{date},,,A") + _sentence(
        f"GNGGA,{clock},{lat},N,00112.0000,W,1,12,0.85,12.5,M,47.0,M,,"
    )


def _sentence(body: str) -> bytes:
    checksum = 0
    for byte in body.encode():
        checksum ^= byte
    return f"${body}*{checksum:02X}\r\n".encode()


def _endure(hours: float) -> None:
    with full_boat() as boat:
        boat.wait_for_heartbeat_s()
        boat.sail()
        for minute in range(round(60.0 * hours) + 1):
            figures = f"{boat.resident_mb:.1f} MB, {boat.descriptors} descriptors, {boat.threads} threads"
            sys.stdout.write(f"minute {minute}: {figures}, {boat.cpu_s:.1f} CPU s\n")
            sys.stdout.flush()
            boat.feed(60.0)


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # not without ending the boat's process
    if len(sys.argv) > 1:
        _endure(float(sys.argv[1]))
    else:
        for row in rows():
            sys.stdout.write(f"{row.question}: {row.ours:.2f} {row.unit} ({row.note})\n")
