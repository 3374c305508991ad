"""Does the shore page stay as it is for a day? Memory and every container over hours of handed-in time.

    python -m benchmarks.shore_endurance 24

The inside of the server (hub, station, sessions) serves boats that send what real ones send, with new
missions and texts, garbage and new links; viewers and skippers come and go, ask, know the PIN or do not; one
of four other boats appears every quarter of an hour; the date jumps by years, forth and back. Every hour is a
line: memory, and the containers that have grown since the first hour. The whole program in real time is in
`shore_attack`.
"""

import asyncio
import gc
import json
import os
import random
import sys
import tempfile
import time
from collections import deque
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from benchmarks.measure import Row, alone
from benchmarks.shore_fleet import FakeBoat, FleetPort
from companion.shore import memory_use
from companion.shore.chart import Chart
from companion.shore.station.boats import Boats
from companion.shore.web.hub import Hub, Watch
from companion.shore.web.pin_file import PinFile
from companion.shore.web.session import Opened, Sessions

PIN = "482913"
POLL_S = 0.1
_HOURS = 1.0  # of `make bench`
_ASK_S, _VISIT_S, _WRONG_PIN_S, _RIGHT_PIN_S, _NEW_BOAT_S = 3.0, 300.0, 900.0, 1200.0, 900.0
_STRANGER_S = 0.5
_OTHERS = 4  # boats
_WHATS = ("hold", "go", "speed", "check", "nonsense", "arm", "start", "set_mode")
_YEARS = {2: 5.0, 4: -50.0, 6: 12.0}  # at these hours the date jumps: a GNSS receiver sets it late
_YEAR_S = 365.25 * 86_400.0


class Figures(NamedTuple):
    """sizes: the longest container of each attribute, by `Class.attribute`."""

    hour: float
    resident_mb: float
    objects: int
    sizes: dict[str, int]


class EnduringClock:
    """Handed-in time."""

    def __init__(self) -> None:
        self.at_s = 0.0
        self.jumped_s = 0.0

    def now_s(self) -> float:
        """Monotonic."""
        return self.at_s

    def unix_s(self) -> float:
        """The date, which jumps."""
        return 1.8e9 + self.at_s + self.jumped_s


def rows() -> list[Row]:
    """Growth from a half to a whole hour."""
    marks = list(endure(_HOURS, _HOURS / 2.0))
    grown = marks[-1].resident_mb - marks[1].resident_mb
    return [alone(f"{_HOURS / 2.0:g} handed-in hours: memory growth", "MB", "less", [grown])]


def container_sizes(root: object) -> dict[str, int]:
    """The longest list, dict, set or deque of each attribute of our objects that can be reached from one."""
    sizes: dict[str, int] = {}
    seen: set[int] = set()
    waiting: list[tuple[object, str]] = [(root, "")]
    while waiting:
        one, name = waiting.pop()
        if id(one) in seen:
            continue
        seen.add(id(one))
        if isinstance(one, list | tuple | set | frozenset | deque | dict):
            sizes[name] = max(sizes.get(name, 0), len(one))
            values = [*one.keys(), *one.values()] if isinstance(one, dict) else one
            waiting += [(value, name) for value in values if not isinstance(value, str | int | float | bytes)]
        elif type(one).__module__.startswith("companion."):
            slots = [slot for kind in type(one).__mro__ for slot in getattr(kind, "__slots__", ())]
            for attribute in {*getattr(one, "__dict__", ()), *slots}:
                waiting.append((getattr(one, attribute, None), f"{type(one).__name__}.{attribute}"))
    return sizes


class _Visitors:
    """Three viewers that come and go; the first is a skipper, the last never reads."""

    def __init__(self, hub: Hub, clock: EnduringClock) -> None:
        self._hub = hub
        self._clock = clock
        self._random = random.Random(1)
        self._watches: list[Watch] = []
        self._token: str | None = None
        self._asked = 0

    def poll(self) -> None:
        """Read, ask, and now and then go."""
        now_s = self._clock.at_s
        if not self._watches or _is_due(now_s, _VISIT_S):
            for watch in self._watches:
                self._hub.close(watch)
            self._watches = [
                self._hub.open(None, self._token),
                self._hub.open(1, None),
                self._hub.open(1, None),
            ]
        for watch in self._watches[:2]:
            _, is_pinged = watch.viewer.take(now_s)
            if is_pinged:
                watch.viewer.on_pong(now_s)
        if _is_due(now_s, _ASK_S):
            self._asked += 1
            arguments: dict[str, Any] = {"lat": 48.0, "lon": 12.0, "m_s": 1.0, "mode": "HOLD"}
            ask = {"type": "do", "id": f"{self._asked}", "boat": 1, "what": self._random.choice(_WHATS)}
            for watch in self._watches[:2]:
                self._hub.on_text(watch, json.dumps({**ask, "with": arguments}))
        if _is_due(now_s, _STRANGER_S):
            self._hub.sessions.role(self._random.randbytes(16).hex(), now_s)

    async def knock(self) -> None:
        """PINs, wrong and right, from many addresses."""
        now_s = self._clock.at_s
        if _is_due(now_s, _WRONG_PIN_S):
            await self._hub.sessions.open(
                "111112", f"10.0.{int(now_s) % 251}.{int(now_s / 251) % 250}", now_s
            )
        if _is_due(now_s, _RIGHT_PIN_S):
            opened = await self._hub.sessions.open(PIN, f"10.1.{self._random.randrange(250)}.1", now_s)
            if isinstance(opened, Opened):
                self._token = opened.token


def _is_due(now_s: float, every_s: float) -> bool:
    return round(now_s / POLL_S) % round(every_s / POLL_S) == 0


def endure(hours: float, every_h: float) -> Iterator[Figures]:
    """The figures after each part of the time; the first at its beginning."""
    with tempfile.TemporaryDirectory() as folder, asyncio.Runner() as runner:
        pin = PinFile(Path(folder) / "pin")
        pin.write(PIN)
        clock, port = EnduringClock(), FleetPort()
        boats = Boats(port)
        hub = Hub(boats, Chart(None), Sessions(pin), clock)
        fleet = [FakeBoat(1, port), FakeBoat(2, port)]
        visitors = _Visitors(hub, clock)

        async def run(polls: int) -> None:
            for _ in range(polls):
                clock.at_s += POLL_S
                if _is_due(clock.at_s, _NEW_BOAT_S):
                    fleet.pop().close()
                    fleet.append(FakeBoat(2 + round(clock.at_s / _NEW_BOAT_S) % _OTHERS, port))
                    clock.jumped_s += _YEARS.get(round(clock.at_s / 3600.0), 0.0) * _YEAR_S
                for boat in fleet:
                    boat.poll(clock.at_s)
                hub.tick()
                visitors.poll()
                await visitors.knock()
                await asyncio.sleep(0)

        yield _figures(0.0, hub)
        for part in range(1, round(hours / every_h) + 1):
            runner.run(run(round(every_h * 3600.0 / POLL_S)))
            yield _figures(part * every_h, hub)


def _figures(hour: float, hub: Hub) -> Figures:
    gc.collect()
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    resident_mb = pages * os.sysconf("SC_PAGE_SIZE") / 1e6
    return Figures(hour, resident_mb, len(gc.get_objects()), container_sizes(hub))


def main(hours: float) -> None:
    """Print a line every hour."""
    memory_use.settle()
    began_s, first = time.monotonic(), None
    for one in endure(hours, 1.0):
        first = one if one.hour <= 1.0 else first
        assert first is not None
        grown = {
            n: f"{first.sizes.get(n, 0)} to {size}"
            for n, size in one.sizes.items()
            if size > first.sizes.get(n, 0)
        }
        sys.stdout.write(
            f"hour {one.hour:g}: {one.resident_mb:.1f} MB, {one.objects} objects, "
            f"{time.monotonic() - began_s:.0f} s; longer than after an hour: {grown or 'nothing'}\n"
        )
        sys.stdout.flush()


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else _HOURS)
