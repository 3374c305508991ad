"""The boats, their viewers and their requests: everything behind the sockets, with time handed in."""

import asyncio
from collections.abc import Callable
from functools import partial
from typing import Final

import msgspec

from mission_tools.shore.chart import WaterChart
from mission_tools.shore.clock import Clock
from mission_tools.shore.plans.plan_service import PlanService, Sources
from mission_tools.shore.plans.uploading import upload_stored_plan
from mission_tools.shore.web.feed import Feed, Viewer
from mission_tools.shore.web.login.session import Sessions
from mission_tools.shore.web.logs.charts import Charts
from mission_tools.shore.web.logs.voyages import LogService
from mission_tools.shore.web.request_log import Reply, RequestLog
from mission_tools.shore.web.route_service import RouteService
from mission_tools.station.boats import Boats
from mission_tools.station.messages import Answer, BoatName, Hello, PageRequest, Role
from mission_tools.station.words import say

STATE_PERIOD_S: Final = 0.2
_MOST_ID: Final = 64
_MOST_WHAT: Final = 32
_NO_SOURCES: Final = Sources()


class _Id(msgspec.Struct):
    id: str = ""


class Watch:
    """An open socket: who reads there, and which boat. wake: something may have to be sent."""

    def __init__(self, viewer: Viewer, boat: int | None, token: str | None) -> None:
        self.viewer = viewer
        self.boat = boat
        self.token = token
        self.wake = asyncio.Event()

    def reply(self, answer: Answer) -> None:
        """Send an answer to the page that asked."""
        self.viewer.reply(answer)
        self.wake.set()


class Hub:
    """Polls the boats, hands their states to the viewers, and requests to the boats."""

    def __init__(
        self,
        boats: Boats,
        chart: WaterChart,
        sessions: Sessions,
        clock: Clock,
        sources: Sources = _NO_SOURCES,
    ) -> None:
        self.boats = boats
        self.plans = PlanService(boats, sources)
        self.chart = chart
        self.sessions = sessions
        self.clock = clock
        self.logs = LogService(boats, clock)
        self.charts = Charts(boats, clock, self.logs.one, self.plans.planner, sources.water)
        self.watches: list[Watch] = []
        self._feeds: dict[int, Feed] = {}
        self._request_log = RequestLog()
        self._services: dict[str, Callable[[PageRequest, Reply], None]] = {
            "route": RouteService(boats, chart).ask,
            "upload_plan": partial(upload_stored_plan, boats, self.plans),
        }
        self._next_s = float("-inf")

    def tick(self) -> None:
        """Call every 50 ms."""
        now_s = self.clock.now_s()
        self.boats.poll(now_s, self.clock.unix_s())
        self.sessions.poll(now_s)
        if now_s >= self._next_s:
            self._next_s = max(self._next_s + STATE_PERIOD_S, now_s)
            self._update(now_s)

    def _update(self, now_s: float) -> None:
        self.boats.is_operator = any(self.role(watch) == "skipper" for watch in self.watches)
        names = self.boats.names()
        watched = {watch.boat for watch in self.watches}
        self._feeds = {boat: feed for boat, feed in self._feeds.items() if boat in watched}
        for watch in self.watches:
            self._attach(watch)
        for feed in self._feeds.values():
            feed.update(self.boats.snapshot(feed.boat))
        for watch in self.watches:
            watch.viewer.greet(self._hello(watch, names, now_s))
            watch.wake.set()

    def _attach(self, watch: Watch) -> None:
        """To the boat asked for, or the first."""
        if watch.boat is None:
            watch.boat = self.boats.first
        if watch.boat is not None:
            watch.viewer.feed = self._feeds.setdefault(watch.boat, Feed(watch.boat))

    def _hello(self, watch: Watch, names: list[BoatName], now_s: float) -> Hello:
        return Hello(role=self.sessions.role(watch.token, now_s), boats=names)

    def open(self, boat: int | None, token: str | None) -> Watch:
        """Begin to feed a new socket."""
        now_s = self.clock.now_s()
        watch = Watch(Viewer(None, now_s), boat, token)
        self.watches.append(watch)
        names = self.boats.names()
        self._attach(watch)
        feed = watch.viewer.feed
        if feed is not None and feed.tree is None:
            feed.update(self.boats.snapshot(feed.boat))
        watch.viewer.greet(self._hello(watch, names, now_s))
        watch.wake.set()
        return watch

    def close(self, watch: Watch) -> None:
        """A socket is closed."""
        if watch in self.watches:
            self.watches.remove(watch)
        self._request_log.leave(watch.reply)

    def role(self, watch: Watch) -> Role:
        """Of the page behind a socket."""
        return self.sessions.role(watch.token, self.clock.now_s())

    def on_text(self, watch: Watch, text: str) -> None:
        """A message of a page."""
        try:
            request = msgspec.json.decode(text, type=PageRequest)
        except (msgspec.DecodeError, RecursionError, UnicodeError):
            watch.reply(Answer(id=_id_of(text), ok=False, text=say("answer.malformed")))
            return
        if not 0 < len(request.id) <= _MOST_ID or len(request.what) > _MOST_WHAT:
            watch.reply(Answer(id=request.id[:_MOST_ID], ok=False, text=say("answer.malformed")))
        elif self.role(watch) != "skipper":
            watch.reply(Answer(id=request.id, ok=False, text=self.sessions.refusal()))
        else:
            self._request_log.submit(request, watch.reply, self._do, self.clock.now_s())

    def _do(self, request: PageRequest, reply: Reply) -> None:
        self._services.get(request.what, self.boats.ask)(request, reply)


def _id_of(text: str) -> str:
    """Of a message that is no request, so that its page hears of it."""
    try:
        return msgspec.json.decode(text, type=_Id).id[:_MOST_ID]
    except (msgspec.DecodeError, RecursionError, UnicodeError):
        return ""
