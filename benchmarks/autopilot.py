"""The boat through ArduPilot's Rover beside its own sensors and motors: docs/autopilot.md.

    python -m benchmarks.autopilot ARDUROVER zigzag [CURRENT_M_S [SEED …]]
    python -m benchmarks.autopilot ARDUROVER failures [SITUATION …]

ARDUROVER is the program that ArduPilot builds for board `sitl`, target `bin/ardurover`. Hull and water are
the emulator's; Rover simulates receiver, compass and gyro on the true state. The zigzag is sailed in
lockstep, the failures in real time with the boat's whole program.
"""

import math
import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any, Final, NamedTuple

os.environ.setdefault("MAVLINK20", "1")
import numpy as np
from pymavlink import mavutil

from companion.boat import TICK_S
from companion.cli.command_line import echo
from companion.config.boat_config import decode_config
from companion.core.geo import Point
from companion.hal.autopilot.line import AutopilotLine
from companion.hal.interfaces import Hardware
from companion.links.port_url import open_port
from companion.links.retried import RetriedPort
from companion.mavlink.address import Address
from mission_tools.mission.route import mission_along
from sitl.courses.courses import COURSES, NEAR_M, RUN_IN_M, course_mission, off_path_m
from sitl.courses.missions import wire_items
from sitl.physics.backend import Backend
from sitl.physics.json_interface import parse_servos
from sitl.physics.udp_server import PhysicsServer
from sitl.run.lockstep import Lockstep
from sitl.run.mission_run import MissionRun
from sitl.run.recording.recorder import Recorder
from sitl.scenarios.scenario import load_scenario
from sitl.world.scenario import Scenario

EXAMPLE: Final = Path("examples/ardupilot/lake_boat.parm")
BOAT: Final = Address(1, 1)
NEUTRAL: Final = 0.02  # of full drive
# As good as Rover's simulated receiver, which has 0.3 m of stated and hardly any true error
FIXED_RTK: Final = ("receiver=rtk", "noise_m=0.01", "wander_m=0.02", "fix_type=6")
FIGURES: Final = "RC_OVERRIDE_TIME 0.4\nPILOT_STEER_TYPE 3\nMOT_SLEWRATE 0\nSIM_RATE_HZ 200\n"
AUTO: Final = 10
SITUATIONS: Final = ("to it", "from it", "both", "disarm", "mode", "reboot", "kill")


class Drive(NamedTuple):
    """What the motors got, at a time of the computer's clock."""

    time_s: float
    left: float
    right: float


class Water(Backend):
    """Remembers when Rover drove which motor."""

    def __init__(self, scenario: Scenario) -> None:
        self.drives = list[Drive]()
        super().__init__(scenario)

    def handle(self, data: bytes) -> bytes | None:
        if (packet := parse_servos(data)) is not None:
            self.drives.append(Drive(time.monotonic(), packet.share(1), packet.share(3)))
        return super().handle(data)

    def _moor(self) -> None:
        """Not again when Rover restarts: the boat drifts on meanwhile."""
        if self.steps == 0:
            super()._moor()

    def neutral_after_s(self, event_s: float) -> float:
        """From an event to the last time at which a motor was driven; until the latest return."""
        driven = [one.time_s for one in self.drives if one.time_s > event_s and _is_driven(one)]
        pauses = [(a, b) for a, b in zip([event_s, *driven], [*driven, time.monotonic()], strict=True)]
        return next((a - event_s for a, b in pauses if b - a > 1.0), float("nan"))


def _is_driven(one: Drive) -> bool:
    return max(abs(one.left), abs(one.right)) > NEUTRAL


class Line:
    """Passes bytes between the boat and Rover. cut: "", or the direction that is dropped."""

    def __init__(self, rover_port: int) -> None:
        self.cut = ""
        self._rover_port = rover_port
        self._door = socket.create_server(("127.0.0.1", 0))
        self.port = int(self._door.getsockname()[1])
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self) -> None:
        while True:
            boat, _ = self._door.accept()
            try:
                rover = socket.create_connection(("127.0.0.1", self._rover_port), timeout=5.0)
            except OSError:
                boat.close()
                continue
            rover.settimeout(None)
            for source, sink, way in ((boat, rover, "to it"), (rover, boat, "from it")):
                threading.Thread(target=self._pass, args=(source, sink, way), daemon=True).start()

    def _pass(self, source: socket.socket, sink: socket.socket, way: str) -> None:
        with suppress(OSError):
            while data := source.recv(65536):
                if self.cut not in (way, "both"):
                    sink.sendall(data)
        for one in (source, sink):
            with suppress(OSError):
                one.shutdown(socket.SHUT_RDWR)


class Boat:
    """Water, Rover, the line and the boat's program, and a station at both."""

    def __init__(self, ardurover: str, scenario: Scenario, undo: ExitStack, *, has_receiver: bool) -> None:
        self.water, self.texts = Water(scenario), list[tuple[float, str]]()
        self._folder = Path(undo.enter_context(tempfile.TemporaryDirectory()))
        server = PhysicsServer(self.water, port=0)
        ended = threading.Event()
        undo.callback(ended.set)
        threading.Thread(target=server.run, args=(ended.is_set,), daemon=True).start()
        figures = FIGURES + ("" if has_receiver else "SIM_RC_FAIL 1\n")
        start_rover(ardurover, scenario, server.port, self._folder, undo, figures)
        self.line = Line(5760)
        config = self._folder / "boat.toml"
        config.write_text(
            f'links = ["tcpin:127.0.0.1:5790"]\nparts.autopilot = "tcpout:127.0.0.1:{self.line.port}"\n'
            'parts.battery.driver = "none"\navoidance.by_sight = 2\n',
            encoding="utf-8",
        )
        self.program = start(
            undo, self._folder, sys.executable, "-m", "companion", "run", "--config", str(config)
        )
        time.sleep(5.0)
        self.station = mavutil.mavlink_connection("tcp:127.0.0.1:5790", source_system=255)
        self.other = mavutil.mavlink_connection("tcp:127.0.0.1:5762", source_system=254)

    def command(self, number: int, *params: float, other: bool = False) -> None:
        """COMMAND_LONG to the boat, or to Rover by its second port."""
        values = [*params, *([0.0] * (7 - len(params)))]
        (self.other if other else self.station).mav.command_long_send(1, 1, number, 0, *values)

    def run(self, seconds: float, is_over: Callable[[], bool] = lambda: False) -> dict[str, Any]:
        """Keep both stations talking; the last message of each name from the boat."""
        end_s, beat_s, last = time.monotonic() + seconds, 0.0, dict[str, Any]()
        while time.monotonic() < end_s and not is_over():
            if time.monotonic() - beat_s > 1.0:
                beat_s = time.monotonic()
                self.station.mav.heartbeat_send(6, 8, 0, 0, 4)
            with suppress(OSError):
                self.other.recv_match(blocking=False)
                message = self.station.recv_match(blocking=True, timeout=0.1)
                if message is not None:
                    last[message.get_type()] = message
                    if message.get_type() == "STATUSTEXT":
                        self.texts.append((time.monotonic(), message.text))
        return last

    def sail(self, items: list[Any]) -> None:
        """Upload, arm as soon as the boat can be armed, and start."""
        self.station.mav.mission_count_send(1, 1, len(items), 0)
        while (
            asked := self.station.recv_match(type=["MISSION_REQUEST_INT", "MISSION_ACK"], blocking=True)
        ) and (asked.get_type() != "MISSION_ACK"):
            self.station.mav.send(items[asked.seq].to_message(asked.seq, BOAT, 0))
        for _ in range(60):
            self.command(176, 1.0, AUTO)
            self.command(400, 1.0)
            if self.run(2.0)["HEARTBEAT"].base_mode & 128:
                return
        raise SystemExit(f"the boat does not arm: {self.texts[-3:]}")


class InLockstep(Lockstep):
    """The boat behind Rover, tick by tick: Rover waits for the water, and the water for Rover.

    Bytes of the line pass between two ticks, as over a wire without delay.
    """

    def __init__(self, scenario: Scenario, ardurover: str, undo: ExitStack) -> None:
        self._water, self._socket = Backend(scenario), socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        undo.enter_context(self._socket)
        self._socket.bind(("127.0.0.1", 0))
        self._socket.settimeout(30.0)
        folder = Path(undo.enter_context(tempfile.TemporaryDirectory()))
        port = self._socket.getsockname()[1]
        start_rover(ardurover, scenario, port, folder, undo, FIGURES, "--speedup", "50")
        now, url = lambda: self._water.world.time_s, "tcpout:127.0.0.1:5760"
        parts = {"autopilot": url, "battery": {"driver": "none"}}
        behind = decode_config({"links": [], "parts": parts}, "zigzag")
        line = RetriedPort("Autopilot", lambda: open_port(url, now))
        undo.callback(line.close)
        line.attempt()
        self._line = AutopilotLine(line, now, behind)
        hardware = Hardware(
            self._line.motors(),
            self._line.sensor(lambda readings: readings.fix),
            self._line.sensor(lambda readings: readings.heading),
            outputs=self._line,
        )
        super().__init__(scenario, world=self._water.world, hardware=hardware)

    def _advance(self) -> None:
        self._line.step()
        end_s = self.time_s + TICK_S - 1e-6
        while self.time_s < end_s:
            data, rover = self._socket.recvfrom(2048)
            if (reply := self._water.handle(data)) is not None:
                self._socket.sendto(reply, rover)
        self._line.step()


def zigzag(ardurover: str, current_m_s: float, seeds: Sequence[int]) -> None:
    """The same zigzag with the boat's own parts and through Rover."""
    water = ("sensors.sonar.fitted=false", f"environment.current_m_s={current_m_s}")
    ratios = []
    for seed in seeds:
        own = load_scenario("open", (*water, f"seed={seed}", *(f"sensors.gnss.{one}" for one in FIXED_RTK)))
        items, planned = wire_items(course_mission("zigzag", own.frame, own.start)), list(COURSES["zigzag"])
        alone = MissionRun(own, items)
        alone.run(timeout_s=400.0)
        with ExitStack() as undo:
            through = MissionRun(own, items)
            through.lockstep = InLockstep(own, ardurover, undo)
            through.run(timeout_s=400.0)
        errors_m = [_path_error_m(run.recorder, planned) for run in (alone, through)]
        ratios.append(errors_m[1] / errors_m[0])
        own_m, through_m = errors_m
        echo(f"seed {seed}: own parts {own_m:.3f} m, through Rover {through_m:.3f} m, {ratios[-1]:.2f}")
    echo(f"mean ratio {sum(ratios) / len(ratios):.2f}, {min(ratios):.2f} to {max(ratios):.2f}")


def _path_error_m(recorder: Recorder, planned: list[Point]) -> float:
    """Path error between the run-in and the last waypoint, RMS."""
    track = np.asarray(recorder.track(), dtype=np.float64)
    way_m = np.hypot(*(track - track[0]).T)
    left_m = np.hypot(*(track - np.array(planned[-1])).T)
    off_m = off_path_m(track[np.argmax(way_m > RUN_IN_M) : np.argmax(left_m < NEAR_M) or None], planned)
    return math.sqrt(float(np.mean(off_m * off_m)))


def start_rover(
    ardurover: str, scenario: Scenario, port: int, folder: Path, undo: ExitStack, figures: str, *words: str
) -> None:
    """port: of the water. figures: parameters besides the example's. words: further ones of the command."""
    defaults = folder / "rover.parm"
    defaults.write_text(EXAMPLE.read_text(encoding="utf-8") + figures, encoding="utf-8")
    place = scenario.frame.origin
    start(
        undo, folder, ardurover, "--model", "JSON:127.0.0.1", "--sim-port-out", str(port), "--home",
        f"{place.lat_deg:.7f},{place.lon_deg:.7f},0,0", "--defaults", str(defaults), *words,
    )  # fmt: skip


def start(undo: ExitStack, folder: Path, *words: str) -> subprocess.Popen[bytes]:
    """A program that ends with `undo`."""
    program = subprocess.Popen(words, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    undo.callback(program.wait)
    undo.callback(program.kill)
    return program


def failures(ardurover: str, situations: list[str]) -> None:
    """Time until the motors are neutral, until the operator is told, and until the boat drives again."""
    scenario = load_scenario("open", ("sensors.sonar.fitted=false",))
    far = [Point(300.0 * (n % 2), 30.0 * n) for n in range(9)]
    for has_receiver in (True, False):
        echo(f"a transmitter at Rover: {has_receiver}")
        with ExitStack() as undo:
            boat = Boat(ardurover, scenario, undo, has_receiver=has_receiver)
            boat.sail(wire_items(mission_along([scenario.frame.to_global(point) for point in far])))
            for name in situations:
                boat.run(15.0)
                echo(f"  {name}: {_fail(boat, name)}")


def _fail(boat: Boat, name: str) -> str:
    event_s = time.monotonic()
    away_s = 6.0
    if name in ("to it", "from it", "both"):
        boat.line.cut = name
    elif name == "disarm":
        boat.command(400, 0.0, 21196.0, other=True)
    elif name == "mode":
        boat.command(176, 1.0, 4.0, other=True)
    elif name == "reboot":
        boat.command(246, 1.0, 0.0, 0.0, 0.0, 0.0, 20190226.0, other=True)
        away_s = 55.0
    elif name == "kill":
        boat.program.send_signal(signal.SIGKILL)
    boat.run(away_s)
    neutral_s = boat.water.neutral_after_s(event_s)
    back_s = event_s if name == "reboot" else time.monotonic()
    told = [told_s - event_s for told_s, text in boat.texts if told_s > event_s and "Motors off" in text]
    boat.line.cut = ""
    if name == "disarm":
        boat.command(400, 1.0, other=True)
    elif name == "mode":
        boat.command(176, 1.0, 0.0, other=True)
    beat = boat.run(8.0).get("HEARTBEAT")
    mode = "AUTO" if beat is not None and beat.custom_mode == AUTO else "not AUTO"
    again = [
        told_s - back_s for told_s, text in boat.texts if told_s > event_s and "drives the motors" in text
    ]
    told_s, again_s = min(told, default=math.nan), min(again, default=math.nan)
    return f"neutral after {neutral_s:.2f} s, told after {told_s:.2f} s, again after {again_s:.1f} s, {mode}"


if __name__ == "__main__":
    sys.setswitchinterval(0.0005)  # the water answers Rover's frames in a thread
    match sys.argv[1:]:
        case [rover, "zigzag", *figures]:
            current, *seeds = figures or ["0"]
            zigzag(rover, float(current), [int(seed) for seed in seeds] or [1])
        case [rover, "failures", *names]:
            failures(rover, names or list(SITUATIONS))
        case _:
            sys.exit(__doc__)
