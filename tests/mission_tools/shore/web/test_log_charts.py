"""Depth charts of logs by HTTP: who may ask, what boat-survey makes of a log, and what is kept of it."""

import asyncio
from pathlib import Path
from typing import Any

import pytest
import rasterio.io
from log_device import LOGS, listed, with_logs
from shore_server import Server

from companion.core.geo import LatLon, LocalFrame, Point, position_to_e7
from companion.log import records as r
from mission_tools.shore.plans.plan_service import Sources
from mission_tools.shore.plans.process import Planner

pytest_plugins = ("server_fixtures",)
pytestmark = pytest.mark.slow

POND = Sources(Path("sitl/scenarios/maps/mill_pond.geojson").resolve())
CHART = f"{LOGS}/00001.bin/chart"
DEPTH_M = 2.5


def soundings() -> bytes:
    """Four lines of 30 m, 8 m apart, over a level bottom of the mill pond; a transducer at the surface."""
    frame = LocalFrame(LatLon(50.0003, -1.2004))
    parts, us = [r.HEADER, r.PARM.pack(0, b"RNGFND2_SOUND", 1500.0, 0.0)], 0
    for line in range(4):
        for step in range(61):
            us += 500_000
            at = position_to_e7(frame.to_global(Point(8.0 * line, 0.5 * step)))
            parts.append(r.EST.pack(us, 0, 0, 0.02, 0))
            parts.append(r.POS.pack(us, *at, 0.0, 0.0, 0.0))
            parts.append(r.DPTH.pack(us, 0, *at, DEPTH_M, 15.0, 100, 0.0))
    return b"".join(parts)


async def asked(server: Server, method: str = "POST", path: str = CHART) -> tuple[int, dict[str, Any]]:
    server.clock.at_s += 0.1  # else the server says that it is asked too fast
    async with server.client.request(method, path, headers=server.own) as response:
        return response.status, await response.json()


async def charted(server: Server) -> tuple[int, dict[str, Any]]:
    """Ask until it is there, or refused; the steps on the way are among those that the page knows."""
    while (told := await asked(server))[0] == 202:
        assert told[1]["step"] in ("fetching", "charting")
        await asyncio.sleep(0.05)
    return told


async def test_a_log_is_charted_and_its_files_are_kept_until_the_log_has_grown(tmp_path: Path) -> None:
    async with with_logs(tmp_path, POND) as (server, device):
        content = device.put("00001.bin", soundings())
        await listed(server)
        assert (await asked(server))[0] == 403
        await server.log_in()
        assert (await asked(server, "GET", f"{CHART}/chart.png"))[1]["key"] == "depths.gone"
        device.pause_s = 0.001
        status, figures = await charted(server)
        device.pause_s = 0.0
        assert (status, figures["logs"]) == (200, ["00001.bin"])
        assert figures["max_depth_m"] == pytest.approx(DEPTH_M, abs=0.05)
        async with server.client.get(f"{CHART}/depth.tif") as response:
            assert response.headers["Content-Disposition"] == 'attachment; filename="boat1-00001-depth.tif"'
            with rasterio.io.MemoryFile(await response.read()) as memory, memory.open() as grid:
                assert grid.count == 2
        async with server.client.get(f"{CHART}/chart.html") as response:
            assert response.content_type == "text/html"
            policy = response.headers["Content-Security-Policy"]
            assert policy.startswith("default-src 'none'; ")
            assert policy.endswith("; sandbox")
            assert "script" not in policy
        for name, begin in (("chart.png", b"\x89PNG"), ("chart.gpkg", b"SQLite"), ("gaps.geojson", b"{")):
            async with server.client.get(f"{CHART}/{name}") as response:
                assert (await response.read()).startswith(begin)
        for name in ("00001.bin", "..%2Ferrors.txt", "chart.json"):
            assert (await asked(server, "GET", f"{CHART}/{name}"))[0] == 404
        assert (await asked(server))[0] == 200
        folder = next(iter(server.hub.charts._kept.values())).folder
        assert folder is not None
        assert not (folder / "00001.bin").exists()
        device.put("00001.bin", content + content)
        while (await listed(server))[0]["bytes"] == len(content):
            server.clock.at_s += 0.1
        assert (await asked(server))[0] == 202
        assert not folder.exists()


@pytest.mark.parametrize(
    ("sources", "said"),
    [(POND, "00001.bin: no DataFlash log: expected"), (Sources(), "There is no map of the water")],
)
async def test_what_makes_no_chart_has_a_sentence(tmp_path: Path, sources: Sources, said: str) -> None:
    async with with_logs(tmp_path, sources) as (server, device):
        device.put("00001.bin", b"no log at all" * 100)
        await listed(server)
        await server.log_in()
        status, told = await charted(server)
        assert (status, told["error"][: len(said)]) == (422, said)


class StuckPlanner(Planner):
    """Charts for ever."""

    folder = Path()

    async def chart(self, log: str, water: str, folder: Path) -> None:
        self.folder = folder
        await asyncio.Event().wait()


async def test_a_chart_that_is_cancelled_leaves_nothing_and_the_next_log_is_read(tmp_path: Path) -> None:
    async with with_logs(tmp_path, POND) as (server, device):
        server.hub.charts._planner = planner = StuckPlanner()
        device.put("00001.bin", b"1")
        await listed(server)
        await server.log_in()
        while (told := await asked(server))[1]["step"] != "charting":
            await asyncio.sleep(0.001)
        assert told[0] == 202
        assert planner.folder.is_dir()
        voyage = asyncio.create_task(asked(server, "GET", f"{LOGS}/00001.bin/voyage"))
        assert (await voyage)[1]["step"] == "fetching"
        assert (await asked(server, "DELETE"))[0] == 200
        while (told := await asked(server, "GET", f"{LOGS}/00001.bin/voyage"))[0] == 202:
            await asyncio.sleep(0.01)
        assert told[0] == 422
        assert not planner.folder.exists()
