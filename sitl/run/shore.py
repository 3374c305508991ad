"""The shore page beside the emulator: `boat-shore` as a child process with a link of its own.

The child knows the boats only by MAVLink. It ends with this process, however this one ends; if it ends
first, the boats do not notice.
"""

import ctypes
import json
import os
import re
import secrets
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import webbrowser
from collections.abc import Callable, Sequence
from pathlib import Path
from threading import Thread
from typing import IO

import numpy as np
import shapely
from numpy.typing import NDArray

from companion.core.geo import Point
from mission_tools.geojson import collection, feature
from mission_tools.maps.chart import Chart, Feature

PIN_DIGITS = 8
LISTEN = "127.0.0.1:8080"
_LOOPBACK = "127.0.0.1"
_PROGRAM = (sys.executable, "-m", "mission_tools.shore")
_END_S = 5.0  # the child has this long to close its sockets
_NICE = 5  # as in the unit of docs/shore.md
_ENDED_AS_ASKED = (0, 130)  # also by Ctrl-C, which a terminal sends to both programs
_PR_SET_PDEATHSIG = 1  # prctl(2)
_libc = ctypes.CDLL(None)  # before the fork: the child may not load anything


class ShorePage:
    """The child process and the folder with its map, its PIN and the boat's status."""

    def __init__(
        self,
        chart: Chart,
        listen: str,
        report: Callable[[str], None],
        boat: Path | None = None,
        options: Sequence[str] = (),
    ) -> None:
        """listen: HOST:PORT of the page. report: called with a line at a time. boat: its TOML, for plans.

        options: further ones of the page's program.
        """
        self._boat = boat
        self._chart = chart
        self._listen = listen
        self._report = report
        self._options = options
        self._address = ""
        self._child: subprocess.Popen[str] | None = None
        self._reader: Thread | None = None
        self._number = _free_udp_port()
        self._folder = Path(tempfile.mkdtemp(prefix="boat-sitl-shore-"))
        self._pin = "".join(secrets.choice("0123456789") for _ in range(PIN_DIGITS))

    @property
    def boat_link(self) -> str:
        """The link that each boat needs for the page."""
        return f"udpout:{_LOOPBACK}:{self._number}"

    @property
    def status(self) -> Path:
        """Where the first boat may write its status file."""
        return self._folder / "status.json"

    def start(self, status: Path) -> None:
        """Start the child, unless it runs; address and PIN are reported as soon as it listens.

        status: the first boat's status file.
        """
        if self._child is not None and self._child.poll() is None:
            self._report(f"the page is still at {self._address} with PIN {self._pin}")
            return
        pin_file = self._folder / "pin"
        if not self._set_pin(pin_file):
            self._report("there is no page; the boat does not need it")
            return
        options = ["--connect", f"udpin:{_LOOPBACK}:{self._number}", "--listen", self._listen]
        options += ["--pin-file", str(pin_file), "--status", str(status)]
        if self._boat is not None:
            options += ["--boat", str(self._boat)]
        if self._chart.features or not self._chart.is_open:
            map_file = self._folder / "map.geojson"
            map_file.write_text(map_of(self._chart), encoding="utf-8")
            options += ["--map", str(map_file)]
        options += self._options
        self._child = subprocess.Popen(  # noqa: S603
            [*_PROGRAM, *options],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            text=True,
            preexec_fn=_behind_the_boat,  # noqa: PLW1509 (two system calls, of a library that is loaded)
        )
        self._reader = Thread(target=self._follow, args=(self._child,), name="shore page", daemon=True)
        self._reader.start()

    def close(self) -> None:
        """End the child and remove the folder. May be called twice."""
        child, self._child = self._child, None
        if child is not None:
            child.terminate()
            try:
                child.wait(_END_S)
            except subprocess.TimeoutExpired:
                child.kill()
                child.wait()
        if self._reader is not None:
            self._reader.join(_END_S)
        shutil.rmtree(self._folder, ignore_errors=True)

    def _set_pin(self, file: Path) -> bool:
        """Whether the child's program could do it; if not, it has said why."""
        command = [*_PROGRAM, "pin", "--pin-file", str(file)]
        done = subprocess.run(  # noqa: S603
            command, input=f"{self._pin}\n", text=True, check=False, stdout=subprocess.DEVNULL
        )
        return done.returncode == 0

    def _follow(self, child: "subprocess.Popen[str]") -> None:
        """Say where the page is, and if it ends before it should."""
        if child.stdout is not None:
            self._read(child.stdout)
        code = child.wait()
        if self._child is not None and code not in _ENDED_AS_ASKED:
            self._report(f"the page's program ended with {code}; the boat does not need it")

    def _read(self, said: IO[str]) -> None:
        with said:
            for line in said:
                address = re.search(r"https?://\S+", line)
                if address is not None:
                    self._address = address[0]
                    self._report(f"the page is at {address[0]} with PIN {self._pin}")
                    if is_on_a_desktop():
                        webbrowser.open(address[0])


def is_on_a_desktop() -> bool:
    """Whether a browser may be opened: there is a person at a terminal, and a screen."""
    return sys.stdout.isatty() and bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def map_of(chart: Chart) -> str:
    """A chart as a GeoJSON map of the kinds that `docs/maps.md` lists. Islands are cut out of the water."""
    water = [] if chart.is_open else [Feature(chart.name, "water", chart.water)]
    others = [feature for feature in chart.features if feature.kind != "water"]

    def placed(points: NDArray[np.float64]) -> NDArray[np.float64]:
        """In WGS 84, [longitude, latitude], rounded to 1 cm."""
        places = [chart.frame.to_global(Point(north_m=north, east_m=east)) for east, north in points.tolist()]
        return np.array([[round(place.lon_deg, 7), round(place.lat_deg, 7)] for place in places])

    features = []
    for each in (*water, *others):
        shape = json.loads(shapely.to_geojson(shapely.transform(each.shape, placed)))
        properties = {**each.properties, "name": each.name, "kind": each.kind}
        features.append(feature(shape["type"], shape["coordinates"], **properties))
    return json.dumps(collection(features, name=chart.name), ensure_ascii=False, separators=(",", ":"))


def _free_udp_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind((_LOOPBACK, 0))
        return int(probe.getsockname()[1])


def _behind_the_boat() -> None:
    """In the child: give way to the boat, as its unit does, and end with it, also when that is killed."""
    os.nice(_NICE)
    _libc.prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)
