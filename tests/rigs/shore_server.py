"""A server of the page with a client, and a fleet, a chart and a clock of its tests."""

import asyncio
import tempfile
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import asynccontextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast
from unittest import mock

import msgspec
from aiohttp import ClientWebSocketResponse, web
from aiohttp.test_utils import TestClient, TestServer

from companion.mavlink.address import Address
from companion.mavlink.items import MissionItem
from mission_tools.shore.chart import WaterChart, Way
from mission_tools.shore.clock import Clock
from mission_tools.shore.plans.plan_service import Sources
from mission_tools.shore.web.hub import Hub
from mission_tools.shore.web.login import pin_file
from mission_tools.shore.web.login.pin_file import PinFile
from mission_tools.shore.web.login.session import Sessions
from mission_tools.shore.web.server import HUB, make_app
from mission_tools.station.boat import ShoreBoat
from mission_tools.station.boats import Boats
from mission_tools.station.ftp.client import FtpClient
from mission_tools.station.items import Kind
from mission_tools.station.logs import LogList
from mission_tools.station.messages import Answer, BoatName, PageRequest, Place, Sensor, Snapshot
from mission_tools.station.outcome import Answered
from mission_tools.station.parameters.parameter_table import ParameterTable
from mission_tools.station.uploads import Upload

PIN = "482913"
NO_SOURCES = Sources()
PAGE = {
    "index.html": "<!doctype html><title>boat</title>" + "<p>water</p>" * 100,
    "main.js": "export const one = 1;\n" * 100,
    "style.css": "body { color: black }",
    "words.en.json": "{}",
}


class FakeClock(Clock):
    """Time as a test sets it."""

    def __init__(self, at_s: float = 1000.0, date_s: float = 1.8e9) -> None:
        self.at_s = at_s
        self.date_s = date_s  # Unix time when the clock was at 0

    def now_s(self) -> float:
        return self.at_s

    def unix_s(self) -> float:
        return self.date_s + self.at_s


class FakeBoat:
    """A boat that was heard, as far as the server looks into it."""

    def __init__(self, boats: "FakeBoats") -> None:
        self.lists = SimpleNamespace(items=lambda _kind: boats.items_on_board)
        self.view = SimpleNamespace(track=SimpleNamespace(points=[(12.5, 48.0), (12.6, 48.0)]))
        boat, own = Address(1, 1), Address(250, 190)
        self.files = FtpClient(boat, own, lambda _: None)
        self.logs = LogList(boat, lambda _: None, self.files)
        self.parameters = ParameterTable(boat, own, lambda _: None, self.files.read_whole)


class FakeBoats(Boats):
    """Boats with the snapshots of a test; requests are answered when it says so."""

    is_transferring = False
    first = 1

    def __init__(self) -> None:
        self.boat = FakeBoat(self)
        self.now: dict[int, Snapshot] = {
            1: Snapshot(boat=1, heard_s=5.0, mode="HOLD", place=Place(lat=1, lon=2))
        }
        self.lists: dict[Kind, dict[str, Any]] = {}
        self.asked: list[tuple[PageRequest, Callable[[Answer], None]]] = []
        self.items_on_board: tuple[MissionItem, ...] | None = None
        self.uploads: list[tuple[Upload, Answered]] = []
        self.polls = 0
        self.is_operator = False

    def poll(self, now_s: float, unix_s: float) -> None:
        self.polls += 1

    def names(self) -> list[BoatName]:
        return [BoatName(id=boat, heard_s=one.heard_s) for boat, one in self.now.items()]

    def snapshot(self, boat: int) -> Snapshot | None:
        return self.now.get(boat)

    def get(self, boat: int) -> ShoreBoat | None:
        return cast(ShoreBoat, self.boat) if boat == 1 else None

    def items(self, boat: int, kind: Kind) -> dict[str, Any] | None:
        return self.lists.get(kind)

    def sensors(self, boat: int) -> list[Sensor] | None:
        if boat not in self.now:
            return None
        return [Sensor(name="gnss", verdict="fine", text="good", values={"satellites": 12})]

    def upload(self, boat: int, upload: Upload, answered: Answered) -> None:
        self.uploads.append((upload, answered))

    def ask(self, request: PageRequest, answer: Callable[[Answer], None]) -> None:
        self.asked.append((request, answer))

    def answer_all(self, text: str) -> None:
        asked, self.asked = self.asked, []
        for request, answer in asked:
            answer(Answer(id=request.id, ok=True, text=text))

    def change(self, **values: Any) -> None:  # noqa: ANN401 (fields of a Snapshot)
        self.now[1] = msgspec.structs.replace(self.now[1], **values)


class FakeChart(WaterChart):
    content = b'{"type":"FeatureCollection","features":[]}' + b" " * 500

    def __init__(self) -> None:
        super().__init__(None)

    def geojson(self) -> bytes:
        return self.content

    def way(self, start: Place, goal: Place, fence: Mapping[str, Any] | None = None) -> Way:
        return Way([(start.lon, start.lat), (goal.lon, goal.lat)], 100.0, None)


class Server:
    """A server on a free port, polled by the test, and a client of it."""

    def __init__(
        self, client: TestClient[web.Request, web.Application], app: web.Application, pin: PinFile
    ) -> None:
        self.client = client
        self.app = app
        self.hub: Hub = app[HUB]
        self.pin = pin
        assert isinstance(self.hub.boats, FakeBoats)
        assert isinstance(self.hub.clock, FakeClock)
        self.boats = self.hub.boats
        self.clock = self.hub.clock

    @property
    def origin(self) -> str:
        return f"http://127.0.0.1:{self.client.port}"

    @property
    def own(self) -> dict[str, str]:
        """Headers of a page of this server."""
        return {"Origin": self.origin}

    def tick(self, later_s: float = 0.2) -> None:
        self.clock.at_s += later_s
        self.hub.tick()

    async def log_in(self, pin: str = PIN) -> int:
        async with self.client.post("/api/session", json={"pin": pin}, headers=self.own) as response:
            return response.status

    async def live(self, path: str = "/live?boat=1", **options: Any) -> ClientWebSocketResponse:  # noqa: ANN401
        return await self.client.ws_connect(path, **({"headers": self.own} | options))


@asynccontextmanager
async def serving(
    *,
    has_pin: bool = True,
    hosts: tuple[str, ...] = (),
    sources: Sources = NO_SOURCES,
) -> AsyncIterator[Server]:
    # The PIN's hash is a matter of test_pin.py; here it would take a fifth of the time
    with tempfile.TemporaryDirectory() as folder, mock.patch.object(pin_file, "_COST", 2):
        page = Path(folder) / "page"
        page.mkdir()
        for name, text in PAGE.items():
            (page / name).write_text(text, encoding="utf-8")
        pin = PinFile(Path(folder) / "pin")
        if has_pin:
            pin.write(PIN)
        app = make_app(
            FakeBoats(),
            FakeChart(),
            Sessions(pin),
            page,
            FakeClock(),
            sources=sources,
            hosts=hosts,
            is_polling=False,
        )
        async with TestClient(TestServer(app)) as client:
            yield Server(client, app, pin)


async def answer(ws: ClientWebSocketResponse) -> dict[str, Any]:
    """The next answer on a socket."""
    while True:
        message: dict[str, Any] = await ws.receive_json()
        if message["type"] == "answer":
            return message


async def until(is_so: Callable[[], bool]) -> None:
    """Let the server's tasks run until something is so; the test's own timeout ends what never is."""
    while not is_so():
        await asyncio.sleep(0)
