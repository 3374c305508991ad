"""MAVSDK's real client on lines that lose, delay, double and reorder: transfers end, plans stay whole."""

import asyncio
import time
from collections.abc import Awaitable, Iterator
from typing import TypeVar

import pytest
from lossy_relay import LossyRelay
from mavsdk.asyncio.plugins.mission_raw import MissionRawAsync
from mavsdk.logging import log_subscribe
from mavsdk.plugins.mission_raw import MissionRawError
from mavsdk_station import mavsdk_station, places_of, raw
from mavutil_station import zigzag
from patience import JOB_S
from programs import RunningBoat, start_boat

from sitl.radio.channel import Quality

pytestmark = pytest.mark.realtime

USABLE_LOSS = 0.05  # up to here a transfer must come about
TRIES = 3

OLD, NEW = zigzag(5), zigzag(30, north_e7=2000)


@pytest.fixture(scope="module")
def boat(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunningBoat]:
    """One boat for all."""
    log_subscribe(lambda *_: True)
    running = start_boat(tmp_path_factory.mktemp("bad-lines") / "boat", "open")
    yield running
    running.program.close()


Result = TypeVar("Result")


async def tried(job: Awaitable[Result]) -> tuple[bool, Result | None]:
    """Whether a transfer came about, and what it brought."""
    try:
        return True, await job
    except MissionRawError as error:
        print(f"MAVSDK gave up: {str(error).partition(';')[0]}")  # noqa: T201
        return False, None


async def transfer(relay: LossyRelay, old_relay: LossyRelay, loss: float) -> None:
    async with mavsdk_station(old_relay.port, "udpout") as system:
        missions = MissionRawAsync(system)
        await missions.upload_mission(raw(OLD))
        missions.destroy()
    async with mavsdk_station(relay.port, "udpout") as system:
        missions = MissionRawAsync(system)
        began_s, uploaded = time.monotonic(), False
        # MAVSDK repeats no item that was lost on its way: a person tries once more
        for _ in range(TRIES if loss <= USABLE_LOSS else 1):
            uploaded, _ = await tried(missions.upload_mission(raw(NEW)))
            if uploaded:
                break
        print(f"{loss:.0%} loss: uploaded {uploaded} in {time.monotonic() - began_s:.1f} s")  # noqa: T201
        _, read = await tried(missions.download_mission())
        relay.improve()
        await asyncio.sleep(1.0)
        held = places_of(await missions.download_mission())[1:]
        assert held == NEW[1:] or (not uploaded and held == OLD[1:])
        assert read is None or places_of(read)[1:] in (OLD[1:], NEW[1:])
        assert uploaded or loss > USABLE_LOSS
        missions.destroy()


@pytest.mark.parametrize("loss", [0.05, 0.4])
def test_a_plan_arrives_whole_or_not_at_all(boat: RunningBoat, loss: float) -> None:
    clean = LossyRelay(boat.port, Quality(), 1)
    relay = LossyRelay(boat.port, Quality(loss, delay_s=0.02, jitter_s=0.03, duplication=0.05), 3)
    try:
        asyncio.run(asyncio.wait_for(transfer(relay, clean, loss), JOB_S))
    finally:
        relay.close()
        clean.close()
