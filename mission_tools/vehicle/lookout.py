"""`--watch`: feeds a watcher with a vehicle's messages, and uploads the missions that it asks for."""

import asyncio
import contextlib
import json
import logging
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager

from mission_tools.errors import NoRoute
from mission_tools.mission.mission import Mission, MissionType
from mission_tools.vehicle.off_loop import in_thread
from mission_tools.vehicle.vehicle import Vehicle
from mission_tools.watch.watcher import WATCHED_HZ, Watcher
from mission_tools.wording import Printer, counted

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
        """Look once; a mission that was uploaded, None while the way ahead is free.

        Raises:
            UploadRejected, LinkLost: the vehicle did not take it.
        """
        vehicle, now_s = self._vehicle, self._clock()
        first = 1 if vehicle.state.is_ardupilot else 0
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
            {
                MESSAGE_IDS[name]: rate_hz
                for name, rate_hz in (WATCHED_HZ | {"MISSION_CURRENT": CURRENT_HZ}).items()
            }
        )
        yield lookout
    finally:
        for hearer in hearers:
            hearer.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await asyncio.gather(*hearers, return_exceptions=True)
