"""Lines to the vehicle under test: the one that `--vehicle` names, else our own boat.

Ours runs as a process where the wall clock matters, and in simulated time where the line is bad.
"""

import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
from boat_rig import Rig
from client_habits import Habits
from patience import MOMENT_S
from station_client import OpenClient, StationClient
from vehicle_line import PERFECT, Line, LiveLine, SimulatedLine

from sitl.radio.channel import Quality


@pytest.fixture(scope="module")
def live_url(request: pytest.FixtureRequest) -> Iterator[str]:
    """Where a vehicle listens."""
    url = request.config.getoption("--vehicle", default=None)
    if url is not None:
        yield url
        return
    program = str(Path(sys.executable).with_name("boat-sitl"))
    process = subprocess.Popen(
        [program, "serve", "open", "--tcp", "0", "--no-udp"], stdout=subprocess.PIPE, text=True
    )
    try:
        assert process.stdout is not None
        line = process.stdout.readline()
        yield "tcp:" + line.rsplit("tcpin:", 1)[1].strip()
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(timeout=MOMENT_S)
        assert process.stdout is not None
        process.stdout.close()


@pytest.fixture
def live_client(live_url: str) -> Iterator[OpenClient]:
    """Opens stations on the vehicle in real time, each on a connection of its own."""
    with ExitStack() as ending:

        def open_client(habits: Habits, quality: Quality = PERFECT, seed: int = 1) -> StationClient:
            line = LiveLine(live_url, habits.address, quality, seed)
            ending.callback(line.close)
            return StationClient(line, habits)

        yield open_client


@pytest.fixture
def client(request: pytest.FixtureRequest) -> Iterator[OpenClient]:
    """Opens stations over lines as bad as asked for: in simulated time where it is our boat."""
    url = request.config.getoption("--vehicle", default=None)
    rig = None if url is not None else Rig().ready()
    with ExitStack() as ending:

        def open_client(habits: Habits, quality: Quality = PERFECT, seed: int = 1) -> StationClient:
            line: Line
            if rig is None:
                assert url is not None
                line = LiveLine(url, habits.address, quality, seed)
            else:
                link = rig.connect(habits.address).link  # type: ignore[arg-type]
                line = SimulatedLine(rig, habits.address, quality, seed, link)
            ending.callback(line.close)
            return StationClient(line, habits)

        yield open_client
        if rig is not None:
            assert rig.boat.endpoint.faults == 0, "the boat's endpoint caught a fault of its own"
