"""Does the boat stay as it is for a day? Memory and descriptors over simulated hours of work.

    python -m benchmarks.endurance 24

The whole boat sails between places in simulated water, with logs, storage and a station that comes and goes;
every simulated hour is a line. `python -m benchmarks.full_boat 1` does the same for the installed program and
its drivers in real time.
"""

import contextlib
import gc
import math
import os
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from benchmarks.measure import Row, alone
from companion.boat import TICK_S, Boat
from companion.config.boat_config import with_value
from companion.core.geo import Point
from companion.core.units import deg_to_e7
from companion.links.memory import MemoryPort, memory_pair
from companion.log.logbook import open_logbook
from companion.mavlink.address import Address
from companion.mavlink.codec import Encoder
from companion.mavlink.dialect import Message, dialect
from companion.persistence.storage import FolderStorage
from sitl.scenarios.scenario import load_scenario
from sitl.world.world import World

_BOAT = Address(1, 1)
_HOURS = 1.0  # of `make bench`
_SETTLED_H = 0.25  # of the time, until caches are warm
_GUIDED = 15
_NEW_TARGET_S, _NEW_STATION_S, _NEW_ARMING_S = 60.0, 600.0, 3600.0
_BEAT_S, _LISTEN_S = 1.0, 0.1
_CIRCLE_M = 60.0
_QUOTA_MB = 20.0  # of logs: the oldest are removed first
_SETTINGS = ("battery.capacity_mah=1e8",)


class Figures(NamedTuple):
    """Of the process."""

    resident_kib: float
    descriptors: int
    objects: int  # that the garbage collector tracks
    logs_mb: float


def rows() -> list[Row]:
    """Growth over the last three quarters of a simulated hour."""
    marks = list(_endure(_HOURS, _SETTLED_H * _HOURS))
    first, last = marks[1], marks[-1]
    what = f"{_HOURS * (1.0 - _SETTLED_H):g} simulated hours"
    return [
        alone(f"{what}: memory growth", "KiB", "less", [last.resident_kib - first.resident_kib]),
        alone(f"{what}: descriptors more", "", "less", [last.descriptors - first.descriptors]),
    ]


class _Station:
    """Heartbeats, and reading all that comes."""

    def __init__(self, port: MemoryPort, number: int) -> None:
        near, self._far = memory_pair(f"station {number}")
        port.offer(near)
        self._encoder = Encoder(Address(255, 190))

    def send(self, *messages: Message) -> None:
        """To the boat."""
        for message in messages:
            self._far.send(self._encoder.encode(message))

    def listen(self) -> None:
        """Read everything."""
        self._far.receive()

    def close(self) -> None:
        """The station goes."""
        self._far.close()


def _endure(hours: float, every_h: float) -> Iterator[Figures]:
    """The figures after each part of the time; the first at its beginning."""
    scenario = load_scenario("open", _SETTINGS)
    with tempfile.TemporaryDirectory() as room, contextlib.ExitStack() as ending:
        world, port = World(scenario), MemoryPort()
        storage = FolderStorage(Path(room))
        ending.callback(storage.close)
        logbook = open_logbook(Path(room), quota_mb=_QUOTA_MB, min_free_mb=0.0, keeps_telemetry=True)
        vehicle = with_value(scenario.vehicle, "log.quota_mb", _QUOTA_MB)
        boat = Boat(vehicle, world.hardware, [port], storage, 0.0, logbook)
        ending.callback(boat.close)
        station = _Station(port, 0)
        target = 0
        ticks, every = round(hours * 3600.0 / TICK_S), round(every_h * 3600.0 / TICK_S)
        for tick in range(ticks + 1):
            if tick % every == 0:
                yield _figures(Path(room))
            if _is_due(tick, _NEW_STATION_S):
                station.close()
                station = _Station(port, tick)
            if _is_due(tick, _BEAT_S):
                station.send(dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))
            if _is_due(tick, _NEW_STATION_S, 5.0):  # as a ground station that has just connected
                station.send(
                    dialect.MAVLink_param_request_list_message(*_BOAT),
                    dialect.MAVLink_mission_request_list_message(*_BOAT, 0),
                )
            if _is_due(tick, _NEW_ARMING_S, 30.0):
                station.send(_command(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 0.0, 21196.0))
            if _is_due(tick, _NEW_ARMING_S, 60.0):
                station.send(
                    _command(dialect.MAV_CMD_DO_SET_MODE, 1.0, _GUIDED),
                    _command(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 1.0),
                )
            if _is_due(tick, _NEW_TARGET_S, 40.0):
                target += 1
                north_m = scenario.start.north_m + _CIRCLE_M * math.cos(2.4 * target)
                east_m = scenario.start.east_m + _CIRCLE_M * math.sin(2.4 * target)
                place = scenario.frame.to_global(Point(north_m, east_m))
                x, y = deg_to_e7(place.lat_deg), deg_to_e7(place.lon_deg)
                number = dialect.MAV_CMD_DO_REPOSITION
                station.send(
                    dialect.MAVLink_command_int_message(
                        *_BOAT, 3, number, 0, 0, -1.0, 1.0, 0.0, 0.0, x, y, 0.0
                    )
                )
            boat.step(world.time_s)
            world.step(TICK_S)
            if _is_due(tick, _LISTEN_S):
                station.listen()
        assert boat.vehicle.armed, "the boat was disarmed on its way"


def _is_due(tick: int, period_s: float, offset_s: float = 0.0) -> bool:
    return tick > 0 and (tick - round(offset_s / TICK_S)) % round(period_s / TICK_S) == 0


def _command(number: int, *params: float) -> Message:
    values = [*params, *([0.0] * (7 - len(params)))]
    message: Message = dialect.MAVLink_command_long_message(*_BOAT, number, 0, *values)
    return message


def _reposition(x: int, y: int) -> Message:
    number, values = dialect.MAV_CMD_DO_REPOSITION, (-1.0, 1.0, 0.0, 0.0, x, y, 0.0)
    message: Message = dialect.MAVLink_command_int_message(*_BOAT, 3, number, 0, 0, *values)
    return message


def _figures(room: Path) -> Figures:
    gc.collect()
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    logs = sum(file.stat().st_size for file in room.rglob("*") if file.is_file())
    return Figures(
        pages * os.sysconf("SC_PAGE_SIZE") / 1024.0,
        len(os.listdir("/proc/self/fd")),
        len(gc.get_objects()),
        logs / 1e6,
    )


if __name__ == "__main__":
    began_s = time.monotonic()
    for hour, figures in enumerate(_endure(float(sys.argv[1]) if len(sys.argv) > 1 else _HOURS, 1.0)):
        counts = f"{figures.descriptors} descriptors, {figures.objects} objects"
        took_s = time.monotonic() - began_s
        memory = f"{figures.resident_kib / 1024.0:.1f} MiB, {counts}, {figures.logs_mb:.1f} MB on disk"
        sys.stdout.write(f"hour {hour}: {memory}, {took_s:.0f} s\n")
        sys.stdout.flush()
