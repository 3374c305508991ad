"""Logs as MAVProxy and MAVSDK fetch them from the emulator, and what pymavlink's own tool makes of one."""

import asyncio
import re
from pathlib import Path

import pytest
from mavsdk.asyncio.plugins.log_files import LogFilesAsync
from mavsdk.logging import log_subscribe
from mavsdk_station import mavsdk_station
from mavutil_station import MavutilStation, OpenStation
from patience import JOB_S
from programs import RunBoat, RunningBoat, RunProgram, until
from pymavlink.dialects.v20 import all as dialect

pytestmark = pytest.mark.realtime
pytest_plugins = ("program_fixtures",)

FORCE = 2989.0
PAST_LOG_BYTES = 300_000


def past_log(state: Path, number: int, size_bytes: int) -> bytes:
    """Leave a log of an earlier day: nothing to read in it, but every 90 bytes differ."""
    content = b"".join(block.to_bytes(4, "big") for block in range(size_bytes // 4))
    (state / "logs").mkdir(parents=True, exist_ok=True)
    (state / "logs" / f"{number:05d}.bin").write_bytes(content)
    return content


def make_a_log(station: MavutilStation, state: Path, number: int) -> bytes:
    """Arm, disarm, and wait until the log of it is complete."""
    path = state / "logs" / f"{number:05d}.bin"
    assert station.command(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 1.0, FORCE) == dialect.MAV_RESULT_ACCEPTED
    until(path.exists)
    assert station.command(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 0.0) == dialect.MAV_RESULT_ACCEPTED
    until(lambda: path.stat().st_size > 6000)
    size = -1
    while size != path.stat().st_size:
        size = path.stat().st_size
        station.listen(3.0)  # a log that is being written grows once a second
    return path.read_bytes()


def test_mavproxy_lists_the_logs_and_downloads_one(
    running_boat: RunBoat, run_program: RunProgram, open_station: OpenStation, tmp_path: Path
) -> None:
    state = tmp_path / "state"
    old = past_log(state, 7, PAST_LOG_BYTES)
    boat = running_boat("open", "--state", str(state), "--set", "vehicle.log.after_disarm_s=0.5")
    new = make_a_log(open_station(boat.port), state, 8)
    proxy = run_program("mavproxy.py", f"--master={boat.url}", "--state-basedir=.")
    proxy.wait_for("Received [0-9]+ parameters")
    proxy.say("log list")
    proxy.wait_for(rf"Log 1 +numLogs 2 lastLog 1 size {len(old)}")
    proxy.wait_for(rf"Log 0 +numLogs 2 lastLog 1 size {len(new)}")
    for number, name, content in ((1, "old.bin", old), (2, "new.bin", new)):
        proxy.say(f"log download {number} {name}")
        proxy.wait_for(rf"Finished downloading {name} ")
        assert (proxy.room / name).read_bytes() == content
    proxy.say("log erase")
    until(lambda: not list((state / "logs").glob("*.bin")))
    proxy.hang_up()
    proxy.wait()
    assert not re.search("Traceback", proxy.out + proxy.err)


async def fetch_with_mavsdk(boat: RunningBoat, folder: Path) -> list[bytes]:
    async with mavsdk_station(boat.port) as system:
        log_files = LogFilesAsync(system)
        fetched = []
        for entry in await log_files.get_entries():
            path = folder / f"{entry.id}.bin"
            async for _ in log_files.download_log_file(entry, str(path)):
                pass
            fetched.append(path.read_bytes())
        log_files.destroy()
        return fetched


def test_mavsdk_finds_every_log_and_downloads_it_whole(running_boat: RunBoat, tmp_path: Path) -> None:
    state = tmp_path / "state"
    contents = [past_log(state, 3, PAST_LOG_BYTES), past_log(state, 4, 90 * 512), past_log(state, 9, 500)]
    boat = running_boat("open", "--state", str(state))
    log_subscribe(lambda *_: True)
    fetched = asyncio.run(asyncio.wait_for(fetch_with_mavsdk(boat, tmp_path), JOB_S))
    assert fetched == [contents[-1], *contents[:-1]]  # the newest is number 0
