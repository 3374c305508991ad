"""The boat through ArduPilot's Rover beside its own sensors and motors: docs/autopilot.md.

    python -m benchmarks.autopilot ARDUROVER zigzag [CURRENT_M_S [SEED …]]
    python -m benchmarks.autopilot ARDUROVER failures [SITUATION …]

ARDUROVER is the program that ArduPilot builds for board `sitl`, target `bin/ardurover`. Hull and water are
the emulator's; Rover simulates receiver, compass and gyro on the true state. All is in lockstep: Rover waits
for the water, and the water for Rover and the boat.
"""

import math
import socket
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np

from companion.boat import TICK_S
from companion.cli.command_line import echo
from companion.config.boat_config import decode_config
from companion.core.geo import Point
from companion.hal.autopilot.line import AutopilotLine
from companion.hal.interfaces import Hardware
from companion.links.port_url import open_port
from companion.links.retried import RetriedPort
from companion.mavlink.address import Address
from companion.mavlink.codec import Encoder
from companion.mavlink.dialect import build_message
from mission_tools.mission.route import mission_along
from sitl.courses.courses import COURSES, NEAR_M, RUN_IN_M, course_mission, off_path_m
from sitl.courses.missions import wire_items
from sitl.physics.backend import Backend
from sitl.physics.json_interface import parse_servos
from sitl.run.lockstep import Lockstep
from sitl.run.mission_run import MissionRun
from sitl.run.recording.recorder import Recorder
from sitl.run.station_commands import StationCommands
from sitl.scenarios.scenario import load_scenario
from sitl.world.scenario import Scenario

EXAMPLE: Final = Path("examples/ardupilot/lake_boat.parm")
FIGURES: Final = "RC_OVERRIDE_TIME 0.4\nPILOT_STEER_TYPE 3\nMOT_SLEWRATE 0\nSIM_RATE_HZ 200\n"
NO_RECEIVER: Final = "SIM_RC_FAIL 1\n"
LINE, OTHER_LINE = 5760, 5762  # TCP ports of Rover
OTHER: Final = Address(254, 190)
NEUTRAL: Final = 0.02  # of full drive
# As good as Rover's simulated receiver, which has 0.3 m of stated and hardly any true error
FIXED_RTK: Final = ("receiver=rtk", "noise_m=0.01", "wander_m=0.02", "fix_type=6")
SITUATIONS: Final = ("to it", "from it", "both", "disarm", "mode", "reboot", "kill")
ARM, MODE, REBOOT = 400, 176, 246
ORDERS: Final[dict[str, tuple[int, tuple[float, ...]]]] = {
    "disarm": (ARM, (0.0, 21196.0)),
    "mode": (MODE, (1.0, 4.0)),
    "reboot": (REBOOT, (1.0, 0.0, 0.0, 0.0, 0.0, 20190226.0)),
}


class Drive(NamedTuple):
    """What the motors got in a frame."""

    time_s: float
    left: float
    right: float

    @property
    def is_neutral(self) -> bool:
        return max(abs(self.left), abs(self.right)) <= NEUTRAL


class Water(Backend):
    """Remembers what Rover gave the motors."""

    drives: list[Drive]

    def handle(self, data: bytes) -> bytes | None:
        if (packet := parse_servos(data)) is not None:
            self.drives.append(Drive(self.world.time_s, packet.share(1), packet.share(3)))
        return super().handle(data)

    def _moor(self) -> None:
        """Not again when Rover restarts: the boat drifts on meanwhile."""
        if self.steps == 0:
            self.drives = []
            super()._moor()

    def neutral_after_s(self, event_s: float) -> float:
        """From an event until the motors were neutral for a second."""
        driven = [one.time_s for one in self.drives if one.time_s > event_s and not one.is_neutral]
        pauses = zip([event_s, *driven], [*driven, self.world.time_s], strict=True)
        return next((a - event_s for a, b in pauses if b - a > 1.0), math.nan)


class CutLine(AutopilotLine):
    """cut: "", or the direction that is dropped, "to it", "from it" or "both"."""

    cut = ""

    def _transmit(self, data: bytes) -> None:
        if self.cut not in ("to it", "both"):
            super()._transmit(data)

    def _decode(self, chunk: bytes, time_s: float) -> Sequence[None]:
        if self.cut not in ("from it", "both"):
            super()._decode(chunk, time_s)
        return ()


class BehindRover(Lockstep):
    """The line is served after each frame of the water, as its thread does once bytes have come."""

    def __init__(self, ardurover: str, scenario: Scenario, undo: ExitStack, figures: str = "") -> None:
        """figures: parameters of Rover, a line each."""
        self.water = Water(scenario)
        self._frames = undo.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        self._frames.bind(("127.0.0.1", 0))
        self._frames.settimeout(60.0)
        self._other: socket.socket | None = None
        self._encoder = Encoder(OTHER)
        self._is_killed = False
        self._start(ardurover, undo, EXAMPLE.read_text(encoding="utf-8") + FIGURES + figures)
        url, now = f"tcpout:127.0.0.1:{LINE}", lambda: self.water.world.time_s
        parts = {"autopilot": {"url": url, "latency_s": 0.0}, "battery": {"driver": "none"}}
        self.port = RetriedPort("Autopilot", lambda: open_port(url, now))
        undo.callback(self.port.close)
        self.port.attempt()
        self.line = CutLine(self.port, now, decode_config({"links": ["none"], "parts": parts}, "Rover"))
        hardware = Hardware(
            self.line.motors(),
            self.line.sensor(lambda readings: readings.fix),
            self.line.sensor(lambda readings: readings.heading),
            outputs=self.line,
        )
        super().__init__(scenario, world=self.water.world, hardware=hardware)

    def _start(self, ardurover: str, undo: ExitStack, figures: str) -> None:
        folder = Path(undo.enter_context(tempfile.TemporaryDirectory()))
        (folder / "boat.parm").write_text(figures, encoding="utf-8")
        place, port = self.water.world.scenario.frame.origin, self._frames.getsockname()[1]
        words = (
            "--model", "JSON:127.0.0.1", "--sim-port-out", str(port), "--speedup", "50", "--serial0", "tcp:0",
            "--home", f"{place.lat_deg:.7f},{place.lon_deg:.7f},0,0", "--defaults", "boat.parm",
        )  # fmt: skip
        quiet = subprocess.DEVNULL
        rover = subprocess.Popen(
            (str(Path(ardurover).resolve()), *words), cwd=folder, stdout=quiet, stderr=quiet
        )
        undo.callback(rover.wait)
        undo.callback(rover.kill)

    def _advance(self) -> None:
        """A tick of water, Rover and line."""
        end_s = self.time_s + TICK_S - 1e-6
        while self.time_s < end_s:
            data, rover = self._frames.recvfrom(2048)
            if not self._is_killed:
                self.line.step()
            if (reply := self.water.handle(data)) is not None:
                self._frames.sendto(reply, rover)
        if self._other is not None:
            with suppress(BlockingIOError):
                self._other.recv(1 << 20)

    def kill(self, seconds: float) -> None:
        """The boat's program ends, the system closes its line, and the water goes on."""
        self._is_killed = True
        self.port.close()
        for _ in range(round(seconds / TICK_S)):
            self._advance()

    def order(self, number: int, *params: float) -> None:
        """COMMAND_LONG of another station to Rover, by its second port."""
        if self._other is None:
            self._other = socket.create_connection(("127.0.0.1", OTHER_LINE))
            self._other.setblocking(False)
        values = {f"param{index}": value for index, value in enumerate(params, 1)}
        message = build_message("COMMAND_LONG", target_system=1, target_component=1, command=number, **values)
        self._other.sendall(self._encoder.encode(message))


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
            through.lockstep = BehindRover(ardurover, own, undo)
            through.run(timeout_s=400.0)
        own_m, through_m = (_path_error_m(run.recorder, planned) for run in (alone, through))
        ratios.append(through_m / own_m)
        echo(f"seed {seed}: own parts {own_m:.3f} m, through Rover {through_m:.3f} m, ratio {ratios[-1]:.2f}")
    echo(f"mean ratio {sum(ratios) / len(ratios):.2f}, {min(ratios):.2f} to {max(ratios):.2f}")


def _path_error_m(recorder: Recorder, planned: list[Point]) -> float:
    """Path error between the run-in and the last waypoint, RMS."""
    track = np.asarray(recorder.track(), dtype=np.float64)
    way_m = np.hypot(*(track - track[0]).T)
    left_m = np.hypot(*(track - np.array(planned[-1])).T)
    off_m = off_path_m(track[np.argmax(way_m > RUN_IN_M) : np.argmax(left_m < NEAR_M) or None], planned)
    return math.sqrt(float(np.mean(off_m * off_m)))


def failures(ardurover: str, situations: Sequence[str]) -> None:
    """Time until the motors are neutral, until the operator is told, and until the boat drives again."""
    scenario = load_scenario("open", ("sensors.sonar.fitted=false",))
    far = [Point(300.0 * (n % 2), 30.0 * n) for n in range(9)]
    items = wire_items(mission_along([scenario.frame.to_global(point) for point in far]))
    for figures in ("", NO_RECEIVER):
        echo(f"a transmitter at Rover: {not figures}")
        with ExitStack() as undo:
            boat = BehindRover(ardurover, scenario, undo, figures)
            orders = StationCommands(boat, boat.step)
            orders.until_armable()
            orders.upload(items)
            orders.arm()
            orders.start_mission()
            for name in situations:
                _run(boat, 15.0)
                echo(f"  {name}: {_fail(boat, name)}")


def _fail(boat: BehindRover, name: str) -> str:
    event_s = boat.time_s
    if name == "kill":
        boat.kill(4.0)
        return f"neutral after {boat.water.neutral_after_s(event_s):.2f} s"
    if name in ORDERS:
        number, params = ORDERS[name]
        boat.order(number, *params)
    else:
        boat.line.cut = name
    told_s = _run(boat, 6.0, "Motors off") - event_s
    boat.line.cut, back_s = "", event_s if name == "reboot" else boat.time_s
    if name == "disarm":
        boat.order(ARM, 1.0)
    elif name == "mode":
        boat.order(MODE, 1.0, 0.0)
    again_s = _run(boat, 60.0, "drives the motors") - back_s
    neutral_s, mode = boat.water.neutral_after_s(event_s), boat.boat.vehicle.mode.name
    return f"neutral after {neutral_s:.2f} s, told after {told_s:.2f} s, again after {again_s:.1f} s, {mode}"


def _run(boat: BehindRover, seconds: float, awaited: str = "") -> float:
    """Go on; the time when a text with these words came from the boat, NaN if none did."""
    end_s, at_s, known = boat.time_s + seconds, math.nan, len(boat.station.texts)
    while boat.time_s < end_s:
        boat.step()
        if math.isnan(at_s) and awaited and any(awaited in text for text in boat.station.texts[known:]):
            at_s = boat.time_s
    return at_s


if __name__ == "__main__":
    match sys.argv[1:]:
        case [rover, "zigzag", *figures]:
            current, *seeds = figures or ["0"]
            zigzag(rover, float(current), [int(seed) for seed in seeds] or [1])
        case [rover, "failures", *names]:
            failures(rover, names or SITUATIONS)
        case _:
            sys.exit(__doc__)
