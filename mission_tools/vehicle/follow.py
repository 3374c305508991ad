"""Follows a mission: progress on the screen, a bar on a terminal and a line for each waypoint elsewhere.

`--watch` also feeds a watcher with the vehicle's messages, and uploads the missions that it asks for.
"""

import asyncio
import contextlib
import json
import logging
import math
import threading
import time
from collections.abc import AsyncIterator, Callable
from concurrent.futures import Future
from contextlib import asynccontextmanager
from types import TracebackType
from typing import Self, TextIO, TypeVar

from rich.console import Console
from rich.progress import BarColumn, TaskProgressColumn, TextColumn, TimeElapsedColumn
from rich.progress import Progress as Bar

from mission_tools.errors import NoRoute, VehicleError
from mission_tools.mission.mission import Mission, MissionType
from mission_tools.vehicle.mission_monitor import MissionMonitor, Progress
from mission_tools.vehicle.vehicle import Vehicle
from mission_tools.watch.watcher import WATCHED_HZ, Watcher
from mission_tools.wording import Printer, counted, distance, duration

LOOK_EVERY_S = 0.1
MESSAGE_IDS = {
    "GLOBAL_POSITION_INT": 33,
    "ATTITUDE": 30,
    "OBSTACLE_DISTANCE": 330,
    "DISTANCE_SENSOR": 132,
    "MISSION_CURRENT": 42,
}
CURRENT_HZ = 5.0
SETTLE_S = 1.0
"""After an upload, until MISSION_CURRENT speaks of the new mission."""

log = logging.getLogger(__name__)


class Lookout:
    """Made by `looking_out`; `step` is called again and again while the vehicle sails."""

    def __init__(self, vehicle: Vehicle, watcher: Watcher, say: Printer, clock: Callable[[], float]) -> None:
        self._vehicle, self._watcher, self._say, self._clock = vehicle, watcher, say, clock
        self._ready_s = clock()

    async def step(self) -> Mission | None:
        """Look once; a mission that was uploaded, None while the way ahead is free. Raises UploadRejected,
        LinkLost: the vehicle did not take it.
        """
        vehicle, now_s = self._vehicle, self._clock()
        first = vehicle.state.first_seq
        if now_s < self._ready_s:
            return None
        try:
            found = await in_thread(lambda: self._watcher.look(vehicle.state.current_item - first, now_s))
        except NoRoute as error:
            self._say(f"the way ahead is blocked: {error}")
            return None
        if found is None:
            return None
        lists = found.wire_lists(home_first=vehicle.state.is_ardupilot)
        await vehicle.upload(MissionType.MISSION, lists[MissionType.MISSION])
        took_s = self._clock() - now_s
        vehicle.state.reached_item = -1  # the new mission's items are counted anew
        vehicle.state.current_item = first
        self._ready_s = self._clock() + SETTLE_S
        self._say(
            f"the way ahead is blocked: {counted(len(found.places), 'waypoint')} uploaded "
            f"{took_s:.2f} s after it was seen"
        )
        return found

    async def hear(self, name: str) -> None:
        """Feed one kind of message to the watcher, forever."""
        async for fields in self._vehicle.messages(name):
            try:
                self._watcher.take(name, json.loads(fields), self._clock())
            except (ArithmeticError, LookupError, TypeError, ValueError) as error:
                log.debug("%s that makes no sense: %r", name, error)


@asynccontextmanager
async def looking_out(
    vehicle: Vehicle, watcher: Watcher, say: Printer, clock: Callable[[], float]
) -> AsyncIterator[Lookout]:
    """Ask for the messages that watching needs, and take them in until the end."""
    lookout = Lookout(vehicle, watcher, say, clock)
    hearers = [asyncio.create_task(lookout.hear(name)) for name in WATCHED_HZ]
    try:
        await vehicle.ask_for_rates(
            {MESSAGE_IDS[name]: rate for name, rate in (*WATCHED_HZ.items(), ("MISSION_CURRENT", CURRENT_HZ))}
        )
        yield lookout
    finally:
        for hearer in hearers:
            hearer.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await asyncio.gather(*hearers, return_exceptions=True)


T = TypeVar("T")


async def in_thread(work: Callable[[], T]) -> T:
    """As asyncio.to_thread, but an interrupted program does not wait for the thread's end."""
    future: Future[T] = Future()
    future.set_running_or_notify_cancel()  # from now on it is not cancelled, whoever awaits it

    def run() -> None:
        try:
            future.set_result(work())
        except Exception as error:
            future.set_exception(error)

    threading.Thread(target=run, daemon=True).start()
    return await asyncio.wrap_future(future)


async def follow(
    vehicle: Vehicle,
    monitor: MissionMonitor,
    stream: TextIO,
    timeout_s: float = math.inf,
    clock: Callable[[], float] = time.monotonic,
    lookout: Lookout | None = None,
) -> MissionMonitor:
    """Watch until the mission has ended; the monitor keeps the track, also of one that ends badly.

    lookout: gives the vehicle another mission where the way ahead is blocked. Returns the last one's monitor,
    whose track is that of the whole voyage. Raises VehicleError: the mission ended badly, or has not ended
    within timeout_s. LinkLost: the vehicle fell silent.
    """
    began_s = clock()
    console = Console(file=stream, highlight=False, markup=False, soft_wrap=True)
    with ProgressDisplay(console) as display:
        while True:
            vehicle.raise_if_lost("following the mission")
            progress = monitor.update(vehicle.state, clock())
            display.show(progress)
            if progress.finished:
                return monitor
            if lookout is not None and (found := await lookout.step()) is not None:
                monitor = monitor.replaced(found, clock(), first_seq=vehicle.state.first_seq)
            if clock() - began_s > timeout_s:
                raise VehicleError(
                    f"the mission has not ended within {timeout_s:g} s: {progress.left_m:.1f} m are left; "
                    "the boat sails on"
                )
            await asyncio.sleep(LOOK_EVERY_S)


class ProgressDisplay:
    """Shows progress on a console."""

    def __init__(self, console: Console) -> None:
        self._console = console
        self._waypoint = 0
        self._bar = Bar(
            TextColumn("{task.description}"),
            BarColumn(),
            TaskProgressColumn(),
            TimeElapsedColumn(),
            console=console,
            disable=not console.is_terminal,
        )
        self._task = self._bar.add_task("starting", total=None)

    def __enter__(self) -> Self:
        self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bar.stop()

    def show(self, progress: Progress) -> None:
        """Update the bar; on anything but a terminal print a line when the waypoint changes."""
        line = describe(progress)
        total_m = max(progress.total_m, 1e-9)
        self._bar.update(self._task, description=line, total=total_m, completed=total_m - progress.left_m)
        if not self._console.is_terminal and (progress.finished or progress.waypoint != self._waypoint):
            self._console.print(line, highlight=False)
        self._waypoint = progress.waypoint


def describe(progress: Progress) -> str:
    """One line: waypoint, distance left, speed and time to go."""
    if progress.finished:
        return f"mission complete: {progress.waypoints} of {progress.waypoints} waypoints"
    eta = "" if math.isnan(progress.eta_s) else f", {duration(progress.eta_s)} to go"
    return (
        f"waypoint {progress.waypoint} of {progress.waypoints}: {distance(progress.left_m)} left"
        f" at {progress.speed_m_s:.2f} m/s{eta}"
    )
