"""Depth charts of logs: boat-survey charts one on the server's map, and its files are kept for a while."""

import asyncio
import shutil
import tempfile
from pathlib import Path
from typing import Final

from mission_tools.shore.clock import Clock
from mission_tools.shore.plans.process import Planner, PlannerBusyError, PlannerError, PlannerMissingError
from mission_tools.shore.web.logs.voyages import FOLDER, Job, LogJobs, Lost, Waiting
from mission_tools.station.boats import Boats
from mission_tools.station.words import say

FILES: Final = ("chart.html", "chart.png", "depth.tif", "chart.gpkg", "gaps.geojson", "lake.geojson")
"""Of a chart, those that the page shows or offers."""


class Charts(LogJobs):
    """The result is chart.json. water: the map; None without one."""

    def __init__(
        self, boats: Boats, clock: Clock, one: asyncio.Lock, planner: Planner, water: Path | None
    ) -> None:
        super().__init__(boats, clock, one)
        self._planner = planner
        self._water = water

    def file(self, boat: int, name: str, product: str) -> Path | None:
        """A file of a finished chart; None while there is none."""
        job = self._kept.get((boat, name))
        return None if job is None or job.folder is None else job.folder / "chart" / product

    async def _work(self, job: Job, boat: int, name: str) -> Lost | bytes:
        if self._water is None:
            return Lost(say("depths.no_map"))
        folder = Path(tempfile.mkdtemp(dir=FOLDER, prefix="mavboat-chart-"))
        try:
            with (folder / name).open("wb") as file:
                await self._fetch(job, boat, name, file)
            job.state = Waiting("charting", 1.0)
            await self._planner.chart(name, str(self._water.resolve()), folder)
            figures = (folder / "chart" / "chart.json").read_bytes()
            (folder / name).unlink()  # the largest file
            job.folder = folder
        except (PlannerError, PlannerMissingError, PlannerBusyError) as error:
            return Lost(error.args[0])
        finally:
            if job.folder is None:
                shutil.rmtree(folder, ignore_errors=True)
        return figures
