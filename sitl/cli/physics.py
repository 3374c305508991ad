"""`boat-sitl physics`: this boat's hull, drive and water under another autopilot."""

import math
import sys
from typing import Annotated

from companion.app.process import Shutdown
from companion.cli.command_line import Option, echo
from companion.cli.program_end import busy_port_explained
from companion.core.errors import BoatError
from sitl.cli.arguments import Case, Csv, Seed, Settings, Source, StartAt, scenario_from
from sitl.physics.backend import Backend
from sitl.physics.udp_server import PORT, PhysicsServer
from sitl.run.recording.recorder import Recorder

_MOST_STEPS_A_ROW = 100  # a row a tenth of a second even at a thousand steps a second


class PhysicsError(BoatError):
    """Nothing came of it."""


def physics(
    source: Source,
    settings: Settings = None,
    case: Case = None,
    seed: Seed = None,
    start: StartAt = None,
    host: Annotated[str, Option(help="address to listen on")] = "127.0.0.1",
    port: Annotated[int, Option(least=0, most=65535, help="UDP port; 0 takes a free one")] = PORT,
    left: Annotated[int, Option(help="servo output of the left motor")] = 1,
    right: Annotated[int, Option(help="servo output of the right motor")] = 3,
    csv: Csv = None,
) -> None:
    """Serve hull, drive, water, weather, sonar and pack to ArduPilot's simulator until Ctrl-C.

    Time passes when ArduPilot sends a frame, and no faster. Its own simulator makes the readings of GNSS,
    compass and gyro from the true state; the sonar's range comes from here, as rng_1. The boat is moored
    until a motor is first driven.

    Example:  boat-sitl physics lake --set environment.current_m_s=0.5
    """
    scenario = scenario_from(source, settings, case, seed, start)
    recorder = Recorder() if csv is not None else None
    backend = Backend(scenario, left, right, recorder.record if recorder is not None else None)
    with busy_port_explained(
        "choose another port with --port, and use the command for ArduPilot that is printed then"
    ):
        server = PhysicsServer(backend, host, port)
    shutdown = Shutdown()
    shutdown.install()
    origin = scenario.frame.origin
    heading_deg = math.degrees(scenario.heading_rad) % 360.0
    echo(f"boat-sitl: {scenario.title}, seed {scenario.seed}, on UDP {host}:{server.port}")
    echo(f"boat-sitl: now start ArduPilot's Rover, with SERVO{left}_FUNCTION 73 (left motor),")
    echo(f"boat-sitl: SERVO{right}_FUNCTION 74 (right motor) and SIM_RATE_HZ of at least 100:")
    home = f"{origin.lat_deg:.7f},{origin.lon_deg:.7f},0,{heading_deg:.0f}"
    other_port = "" if server.port == PORT else f" --sim-port-out {server.port}"
    echo(f"  ardurover --model JSON:{host}{other_port} --home {home}")
    sys.stdout.flush()
    server.run(shutdown, lambda who: echo(f"boat-sitl: {who} steers"))
    if recorder is not None and csv is not None:
        if not len(recorder):
            raise PhysicsError(f"nobody steered: {csv} was not written")
        rate_hz = len(recorder) / max(backend.world.time_s, 1e-9)
        recorder.write_csv(csv, every=min(max(1, round(0.1 * rate_hz)), _MOST_STEPS_A_ROW))
    echo(f"boat-sitl: {backend.steps} steps, {backend.world.time_s:.1f} s of water")
