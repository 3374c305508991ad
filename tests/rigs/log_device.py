"""A boat with logs behind a server of the page: the boat's own service answers."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

from ftp_client import BOAT, STATION, Served
from shore_server import NO_SOURCES, Server, serving

from companion.mavlink.dialect import Message, dialect
from mission_tools.shore.plans.plan_service import Sources
from mission_tools.station.ftp.client import FtpClient
from mission_tools.station.logs import LogList

LOGS = "/api/boats/1/logs"
DATE_S = 1_790_000_000
STEP_S = 0.02


class Device:
    """A boat with logs. Each turn of the event loop is a tick of it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.served = Served(folder)
        self.is_silent = False
        self.pause_s = 0.0  # between ticks: leaves the core to a process
        self.now_s = 100.0
        self.asked: list[Message] = []
        self.client = FtpClient(BOAT, STATION.address, self.asked.append)
        self.logs = LogList(BOAT, self.asked.append, self.client)

    def put(self, name: str, content: bytes) -> bytes:
        (self.folder / "logs").mkdir(exist_ok=True)
        (self.folder / "logs" / name).write_bytes(content)
        return content

    def step(self) -> None:
        self.now_s += STEP_S
        self.served.now_s = self.now_s
        asked, self.asked[:] = self.asked[:], []
        for message in asked:
            if self.is_silent:
                continue
            if message.get_type() == "LOG_REQUEST_LIST":
                self._send_entries()
            else:
                self.served.service.handle(message, STATION, self.now_s)
        self.served.service.tick(self.now_s)
        for outgoing in self.served.outbox.drain():
            if outgoing.message.get_type() == "FILE_TRANSFER_PROTOCOL" and not self.is_silent:
                self.client.handle(outgoing.message, self.now_s)
        self.client.poll(self.now_s)
        self.logs.poll(self.now_s)

    def _send_entries(self) -> None:
        """As docs/logs.md counts: from the oldest, the newest as 0."""
        files = sorted((self.folder / "logs").iterdir())
        for number in range(len(files)):
            size = files[number - 1].stat().st_size
            entry = dialect.MAVLink_log_entry_message(
                number, len(files), len(files) - 1, DATE_S + (number or len(files)), size
            )
            self.logs.handle(entry)


@asynccontextmanager
async def with_logs(folder: Path, sources: Sources = NO_SOURCES) -> AsyncIterator[tuple[Server, Device]]:
    device = Device(folder)

    async def steps() -> None:
        while True:
            device.step()
            await asyncio.sleep(device.pause_s)

    async with serving(sources=sources) as server:
        server.boats.boat.files, server.boats.boat.logs = device.client, device.logs
        task = asyncio.create_task(steps())
        yield server, device
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)


async def listed(server: Server) -> list[dict[str, object]]:
    """Ask until the list is there."""
    for _ in range(500):
        async with server.client.get(LOGS) as response:
            if response.status == 200:
                found: list[dict[str, object]] = await response.json()
                return found
            assert response.status == 503
            assert response.headers["Retry-After"] == "1"
    raise AssertionError("never listed")
