"""The task that polls the boats: in a transfer it waits for what they send, not for the next poll."""

import asyncio
import os

import pytest
from shore_server import FakeBoats, FakeClock, serving, until

from mission_tools.shore.web import server
from mission_tools.shore.web.server import SOCKETS

pytest_plugins = ("server_fixtures",)

ROUND_TRIPS = 200


class AnsweringBoats(FakeBoats):
    """A boat that answers each poll at once, over a pipe."""

    def __init__(self) -> None:
        super().__init__()
        self.read_end, self.write_end = os.pipe()
        self.is_transferring = True
        self.answered = 0

    def filenos(self) -> list[int]:
        return [self.read_end]

    def poll(self, now_s: float, unix_s: float) -> None:
        if self.answered:
            os.read(self.read_end, 1)
        if self.answered < ROUND_TRIPS:
            self.answered += 1
            os.write(self.write_end, b"x")


async def test_a_list_comes_at_the_round_trips_speed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(server, "POLL_S", 3600.0)
    async with serving() as web:
        sockets = web.app[SOCKETS]
        web.hub.boats = boats = AnsweringBoats()
        web.hub.clock = FakeClock()
        task = asyncio.create_task(server._poll(web.hub, sockets))
        await until(lambda: boats.answered == ROUND_TRIPS or task.done())
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)
        assert boats.answered == ROUND_TRIPS
        for end in (boats.read_end, boats.write_end):
            os.close(end)
