"""The boat's logs by HTTP: listed, downloaded, shown as a voyage; the boat's own service answers."""

import asyncio
import random
from pathlib import Path

import pytest
from aiohttp import ClientPayloadError
from ftp_client import Served
from log_device import DATE_S, LOGS, listed, with_logs

from mission_tools.shore.web import logs_api
from mission_tools.shore.web.logs.stream import WINDOW_BYTES

pytest_plugins = ("server_fixtures",)
pytestmark = pytest.mark.slow


async def test_logs_are_listed_newest_first_with_size_and_date(tmp_path: Path) -> None:
    async with with_logs(tmp_path) as (server, device):
        for number in (2, 9, 10):
            device.put(f"{number:05d}.bin", bytes(number))
        device.put("00010-radio.tlog", b"x")
        (tmp_path / "logs" / "00010-radio.tlog").unlink()
        assert await listed(server) == [
            {"name": "00010.bin", "bytes": 10, "at_s": DATE_S + 3, "fetched_bytes": None},
            {"name": "00009.bin", "bytes": 9, "at_s": DATE_S + 2, "fetched_bytes": None},
            {"name": "00002.bin", "bytes": 2, "at_s": DATE_S + 1, "fetched_bytes": None},
        ]
        device.put("00011.bin", bytes(11))
        for _ in range(500):
            if len(await listed(server)) == 4:
                return
        raise AssertionError("the list is never read again")


async def test_a_boat_without_a_folder_says_so(tmp_path: Path) -> None:
    async with with_logs(tmp_path) as (server, device):
        device.served = Served(None)
        for _ in range(500):
            async with server.client.get(LOGS) as response:
                told = await response.json()
                if told["key"] == "log.none":
                    return
        raise AssertionError(told)


async def test_a_log_is_downloaded_byte_by_byte_with_the_pin_only(tmp_path: Path) -> None:
    async with with_logs(tmp_path) as (server, device):
        content = device.put("00001.bin", random.Random(1).randbytes(700_001))
        await listed(server)
        for path in (f"{LOGS}/00001.bin", f"{LOGS}/00001.bin/voyage"):
            async with server.client.get(path) as response:
                assert response.status == 403
        await server.log_in()
        async with server.client.get(f"{LOGS}/00001.bin") as response:
            assert response.status == 200
            assert response.headers["Content-Length"] == "700001"
            assert response.headers["Content-Disposition"] == 'attachment; filename="boat1-00001.bin"'
            assert response.headers["Cache-Control"] == "no-store"
            assert await response.read() == content


@pytest.mark.parametrize(
    "name", ["00002.bin", "..%2F..%2Fetc%2Fpasswd", "LASTLOG.TXT", "%2e%2e", "00001.bin%00"]
)
async def test_only_a_listed_name_is_sent(tmp_path: Path, name: str) -> None:
    async with with_logs(tmp_path) as (server, device):
        device.put("00001.bin", b"1")
        device.put("LASTLOG.TXT", b"1")
        await listed(server)
        await server.log_in()
        async with server.client.get(f"{LOGS}/{name}") as response:
            assert response.status == 404


async def test_a_browser_that_does_not_read_holds_a_small_window_and_others_read_on(tmp_path: Path) -> None:
    async with with_logs(tmp_path) as (server, device):
        device.put("00001.bin", bytes(30_000_000))  # more than the sockets hold
        content = device.put("00002.bin", random.Random(1).randbytes(1_000_000))
        await listed(server)
        await server.log_in()
        held = [await server.client.get(f"{LOGS}/00001.bin") for _ in range(3)]
        for _ in range(2):
            async with server.client.get(f"{LOGS}/00002.bin") as response:
                assert await response.read() == content
        assert len(server.hub.logs._under_way) == 3
        assert all(stream._held <= WINDOW_BYTES for _, _, stream in server.hub.logs._under_way)
        for response in held:
            response.close()
        while server.hub.logs._under_way or device.client.is_busy:
            await asyncio.sleep(0)
        assert not any(one.sessions for one in device.served.service._stations)


async def test_a_browser_that_reads_nothing_is_given_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(logs_api, "STALLED_S", 0.05)
    async with with_logs(tmp_path) as (server, device):
        device.put("00001.bin", bytes(20_000_000))
        await listed(server)
        await server.log_in()
        response = await server.client.get(f"{LOGS}/00001.bin")
        while server.hub.logs._under_way:
            await asyncio.sleep(0)
        assert not device.client.is_busy or device.client._jobs
        response.close()


async def test_a_boat_that_falls_silent_breaks_the_download_off(tmp_path: Path) -> None:
    async with with_logs(tmp_path) as (server, device):
        device.put("00001.bin", bytes(3_000_000))
        await listed(server)
        await server.log_in()
        async with server.client.get(f"{LOGS}/00001.bin") as response:
            assert response.status == 200
            device.is_silent = True
            with pytest.raises(ClientPayloadError):
                await response.read()
        async with server.client.get(f"{LOGS}/00001.bin") as response:
            assert response.status == 502
            assert (await response.json())["key"] == "file.no_answer"


@pytest.mark.parametrize(
    ("content", "key"), [(b"", "voyage.empty"), (b"no log at all" * 1000, "voyage.foreign")]
)
async def test_what_is_no_log_has_a_sentence_instead_of_a_voyage(
    tmp_path: Path, content: bytes, key: str
) -> None:
    async with with_logs(tmp_path) as (server, device):
        device.put("00001.bin", content)
        await listed(server)
        await server.log_in()
        steps = set()
        while True:
            async with server.client.get(f"{LOGS}/00001.bin/voyage") as response:
                told = await response.json()
                if response.status != 202:
                    break
                steps.add(told["step"])
                assert 0.0 <= told["share"] <= 1.0
            await asyncio.sleep(0.01)
        assert (response.status, told["key"]) == (422, key)
        assert "fetching" in steps
