"""Progress of a mission on the screen: a bar on a terminal, one line for each waypoint elsewhere."""

import asyncio
import math
import time
from collections.abc import Callable
from types import TracebackType
from typing import Self, TextIO

from rich.console import Console
from rich.progress import BarColumn, TaskProgressColumn, TextColumn, TimeElapsedColumn
from rich.progress import Progress as Bar

from mission_tools.errors import VehicleError
from mission_tools.vehicle.lookout import Lookout
from mission_tools.vehicle.mission_monitor import MissionMonitor, Progress
from mission_tools.vehicle.vehicle import Vehicle
from mission_tools.wording import distance, duration

LOOK_EVERY_S = 0.1


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
    whose track is that of the whole voyage.

    Raises:
        VehicleError: the mission ended badly, or has not ended within timeout_s.
        LinkLost: the vehicle fell silent.
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
                first_seq = 1 if vehicle.state.is_ardupilot else 0
                monitor = monitor.replaced(found, clock(), first_seq=first_seq)
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
