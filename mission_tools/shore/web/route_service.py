"""The request `route`: a way by the water, found in a thread and answered by the server itself."""

import asyncio
import logging
from typing import Final

from msgspec import ValidationError, convert

from mission_tools.shore.chart import Blocked, WaterChart
from mission_tools.shore.web.request_log import Reply
from mission_tools.station.boats import Boats
from mission_tools.station.messages import Answer, PageRequest, Place
from mission_tools.station.words import say

_log: Final = logging.getLogger(__name__)
_MOST_WAITING: Final = 4
_BUSY: Final = say("answer.ways_busy")


class RouteService:
    """One search at a time."""

    def __init__(self, boats: Boats, chart: WaterChart) -> None:
        self._boats = boats
        self._chart = chart
        self._one = asyncio.Lock()
        self._tasks: set[asyncio.Task[None]] = set()

    def ask(self, request: PageRequest, reply: Reply) -> None:
        """Start a search; `reply` is called once."""
        snapshot = self._boats.snapshot(request.boat)
        try:
            goal = convert(request.arguments, Place)
        except ValidationError:
            goal = None
        if goal is None or not (abs(goal.lat) <= 90.0 and abs(goal.lon) <= 180.0):
            reply(Answer(id=request.id, ok=False, text=say("answer.no_goal")))
        elif snapshot is None or snapshot.place is None:
            reply(Answer(id=request.id, ok=False, text=say("answer.no_position")))
        elif len(self._tasks) >= _MOST_WAITING:
            reply(Answer(id=request.id, ok=False, text=_BUSY))
        else:
            task = asyncio.create_task(
                self._search(request, snapshot.place, goal, snapshot.cruise_m_s, reply)
            )
            self._tasks.add(task)
            task.add_done_callback(self._tasks.discard)

    async def _search(
        self, request: PageRequest, start: Place, goal: Place, cruise_m_s: float | None, reply: Reply
    ) -> None:
        fence, ident = self._boats.items(request.boat, "fence"), request.id
        try:
            async with self._one:
                found = await asyncio.to_thread(self._chart.way, start, goal, fence)
        except Exception:
            _log.exception("the search for a way has failed")
            reply(Answer(id=ident, ok=False, text=say("answer.search_failed")))
            return
        if isinstance(found, Blocked):
            reply(Answer(id=ident, ok=False, text=found.reason, result={"nearest": found.nearest}))
            return
        time_s = found.length_m / cruise_m_s if cruise_m_s else None
        reply(Answer(id=ident, ok=True, text="", result=found._asdict() | {"time_s": time_s}))
