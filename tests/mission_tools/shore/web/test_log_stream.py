"""A log between boat and browser: its window, its end, and what is kept of voyages."""

import asyncio
from types import SimpleNamespace

import pytest
from shore_server import FakeBoats, FakeClock

from mission_tools.shore.web.logs.stream import WINDOW_BYTES, LogLostError, LogStream
from mission_tools.shore.web.logs.voyages import MOST_DOWNLOADS, LogService, Lost, Voyages, Waiting
from mission_tools.station.ftp.jobs import FtpFailure
from mission_tools.station.messages import LogFile

pytest_plugins = ("server_fixtures",)

LOG = LogFile(name="00001.bin", bytes=10)


async def test_a_stream_has_room_for_what_was_read_and_ends_with_the_log() -> None:
    stream = LogStream()
    opening = asyncio.create_task(stream.opened())
    await asyncio.sleep(0)
    assert not opening.done()
    stream.begin(7)
    assert await opening == 7
    for part in (b"abcd", b"efg"):
        stream.write(part)
    assert stream.room() == WINDOW_BYTES - 7
    parts = stream.parts()
    assert [await anext(parts), await anext(parts)] == [b"abcd", b"efg"]
    assert (stream.sent, stream.room()) == (4, WINDOW_BYTES - 3), "the second is still being read"
    stream.end(None)
    with pytest.raises(StopAsyncIteration):
        await anext(parts)
    assert (stream.sent, stream.room()) == (7, WINDOW_BYTES)


async def test_a_failure_ends_whoever_waits() -> None:
    stream = LogStream()
    waiting = asyncio.create_task(stream.opened())
    await asyncio.sleep(0)
    stream.end(FtpFailure("no answer"))
    with pytest.raises(LogLostError, match="no answer"):
        await waiting
    with pytest.raises(LogLostError, match="no answer"):
        await anext(stream.parts())


def listed(boats: FakeBoats) -> None:
    """One log, wherever it is asked for."""
    boats.boat.logs = SimpleNamespace(path=lambda name: f"@LOGS/{name}")  # type: ignore[assignment]


def test_downloads_are_bounded_and_their_progress_is_told() -> None:
    boats = FakeBoats()
    service = LogService(boats, FakeClock())
    with service.download(7, LOG.name) as stream:
        assert stream is None, "a boat that was never heard"
    listed(boats)
    with service.download(1, LOG.name) as far, service.download(1, LOG.name) as near:
        assert far is not None
        assert near is not None
        far.sent, near.sent = 5, 3
        assert service.fetched(1) == {LOG.name: 5}
        assert service.fetched(2) == {}
        rest = [service.download(1, LOG.name) for _ in range(MOST_DOWNLOADS - 1)]
        assert [one.__enter__() is None for one in rest] == [False] * (MOST_DOWNLOADS - 2) + [True]
        for one in rest:
            one.__exit__(None, None, None)
    assert service.fetched(1) == {}


async def test_a_voyage_that_is_lost_is_tried_again_and_the_oldest_are_forgotten() -> None:
    voyages = Voyages(FakeBoats(), FakeClock(), asyncio.Lock())
    assert voyages.get(7, LOG) == Waiting("fetching", 0.0)
    while isinstance(state := voyages.get(7, LOG), Waiting):
        await asyncio.sleep(0)
    assert isinstance(state, Lost)
    assert voyages.get(7, LOG) == Waiting("fetching", 0.0)
    for number in range(6):
        voyages.get(7, LogFile(name=f"{number}.bin", bytes=1))
    assert [name for _, name in voyages._kept] == ["2.bin", "3.bin", "4.bin", "5.bin"]
    tasks = [one.task for one in voyages._kept.values()]
    voyages.close()
    assert len(voyages._kept) == 0
    ended = await asyncio.gather(*(one for one in tasks if one is not None), return_exceptions=True)
    assert [type(one) for one in ended] == [asyncio.CancelledError] * 4
