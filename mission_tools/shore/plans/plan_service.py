"""From what the page asks to a plan: the planner's arguments, its report, and the files of a plan."""

import asyncio
import contextlib
import re
import secrets
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final, NamedTuple

from mission_tools.shore.plans import files
from mission_tools.shore.plans.plan_request import (
    MadePlan,
    PlanRequest,
    PlanRequestError,
    Task,
    charge_percent,
    distance,
    line,
    lists_of,
    time_s,
)
from mission_tools.shore.plans.plan_store import PlanStore, StoredPlan, file_name
from mission_tools.shore.plans.process import Planner, PlannerError
from mission_tools.station.boats import Boats
from mission_tools.station.messages import Place
from mission_tools.station.words import say

FORMATS: Final = {
    "plan": "application/json",
    "waypoints": "text/plain",
    "kml": "application/vnd.google-earth.kml+xml",
    "gpx": "application/gpx+xml",
    "geojson": "application/geo+json",
}
"""What is read and written, and its media type."""
MOST_BYTES: Final = 2_000_000
_PLACE: Final = re.compile(r"(?:Goal|Via point (\d+)) -?\d+\.\d+,-?\d+\.\d+")
_MOST_WARNINGS: Final = 12
_ROUTES: Final = ("kml", "gpx", "geojson")
_SUFFIXES: Final = say("planner.suffixes", suffixes=", ".join(f".{kind}" for kind in FORMATS))


class Sources(NamedTuple):
    """What the server was started with. water: its map; boat: a boat's TOML, or an emulated boat's name."""

    water: Path | None = None
    boat: str | None = None


class File(NamedTuple):
    """A file to download."""

    name: str
    kind: str
    content: bytes


class PlanService:
    """Plans and their files. PlanRequestError, StorageError and the errors of `process` tell why not."""

    def __init__(self, boats: Boats, sources: Sources, planner: Planner | None = None) -> None:
        self._boats = boats
        self._water = None if sources.water is None else str(sources.water.resolve())
        self._boat = _absolute(sources.boat)
        self.planner = planner or Planner()
        self.store = PlanStore()

    async def plan(self, boat: int, wanted: PlanRequest) -> MadePlan:
        """Plan a route or a survey."""
        snapshot = self._boats.snapshot(boat)
        start = wanted.start or (snapshot.place if snapshot is not None else None)
        if start is None:
            raise PlanRequestError(say("planner.no_boat"), say("planner.a_start"))
        speed_m_s = wanted.speed_m_s or (snapshot.cruise_m_s if snapshot is not None else None)
        folder = self.store.new_folder()
        try:
            arguments = [self._source(folder, start), f"--start-at={_place(start.lon, start.lat)}"]
            arguments += _arguments_of(wanted, folder)
            if self._boat is not None:
                arguments += ["--boat", self._boat, "--beyond-range"]
            arguments += self._fence(boat, folder)
            report = await self._plan(arguments, folder, len(wanted.goals))
            warnings = [] if self._boats.items(boat, "fence") is not None else [str(say("planner.no_fence"))]
            length_m = float(report[key := "plan" if report["plan"] else "task"]["length_m"])
            name = f"{wanted.task.capitalize()} {distance(length_m)}"
            return await self._keep(folder, wanted.task, name, report, report[key], speed_m_s, warnings)
        except BaseException:
            shutil.rmtree(folder, ignore_errors=True)
            raise

    async def _plan(self, arguments: list[str], folder: Path, goals: int) -> dict[str, Any]:
        """The planner names a place by its coordinates: the page, by its number in the list."""
        try:
            return await self.planner.run([*arguments, "--out", "new.plan"], folder)
        except PlannerError as error:

            def named(found: re.Match[str]) -> str:
                return str(say("plan.place", n=int(found[1]) if found[1] else goals))

            raise PlannerError(_PLACE.sub(named, error.args[0])) from None

    async def read(self, boat: int, name: str, body: bytes) -> MadePlan:
        """A plan from a file of another program."""
        stem, dot, suffix = name.rpartition(".")
        suffix = suffix.lower()
        if not dot or suffix not in FORMATS:
            raise PlanRequestError(say("planner.no_suffix"), _SUFFIXES)
        snapshot = self._boats.snapshot(boat)
        here = snapshot.place if snapshot is not None else None
        folder = self.store.new_folder()
        try:
            source = f"{file_name(stem)}.{suffix}"
            (folder / source).write_bytes(body)
            arguments = [source, "--check-on", self._water or "none"]
            if suffix in _ROUTES:
                arguments.append("--as-route")
            if suffix != "plan":  # which may have a fence of its own
                arguments += self._fence(boat, folder)
            report = await self._read([*arguments, "--out", "new.plan"], here, folder)
            if suffix == "plan" and not report["items"].get("fence"):
                fence = self._fence(boat, folder)
                if fence:  # only to say where the plan leaves it
                    report["notes"] = (await self._read([*arguments, *fence], here, folder))["notes"]
            speed_m_s = snapshot.cruise_m_s if snapshot is not None else None
            title = stem.strip()[:60] or "Plan"
            has_areas = suffix == "plan"
            return await self._keep(
                folder, "import", title, report, report["file"], speed_m_s, [], has_own_areas=has_areas
            )
        except BaseException:
            shutil.rmtree(folder, ignore_errors=True)
            raise

    async def _read(self, arguments: list[str], here: Place | None, folder: Path) -> dict[str, Any]:
        """With time and charge from the boat's place, where that can be said."""
        if here is not None:
            arguments = [*arguments, f"--start-at={_place(here.lon, here.lat)}"]
            if self._boat is not None:
                budget = ("--boat", self._boat, "--beyond-range")
                with contextlib.suppress(PlannerError):  # perhaps of its budget: a route may end on land
                    return await self.planner.run([*arguments, *budget], folder)
        return await self.planner.run(arguments, folder)

    async def _keep(
        self,
        folder: Path,
        task: Task,
        name: str,
        report: Mapping[str, Any],
        route: Mapping[str, Any],
        speed_m_s: float | None,
        warnings: list[str],
        *,
        has_own_areas: bool = False,
    ) -> MadePlan:
        """The plan of a report; its folder then holds it and nothing else."""
        kinds = ("mission", "fence", "rally") if has_own_areas else ("mission",)
        lists = await asyncio.to_thread(lists_of, report["items"], kinds)
        warnings = [*warnings, *report["notes"]]
        if len(warnings) > _MOST_WARNINGS:
            warnings = [
                *warnings[:_MOST_WARNINGS],
                str(say("planner.more", n=len(warnings) - _MOST_WARNINGS)),
            ]
        plan = MadePlan(
            id=secrets.token_urlsafe(16),  # which nobody guesses
            name=name,
            task=task,
            items=max(len(lists.mission) - 1, 0),
            points=line(report),
            length_m=route["length_m"],
            time_s=time_s(report, route, speed_m_s),
            charge_percent=charge_percent(report),
            fits=report["budget"]["suffices"] if report["budget"] else None,
            clearance_m=route["min_clearance_m"],
            has_areas=bool(lists.fence or lists.rally),
            warnings=warnings,
        )
        kept = folder / f"{file_name(name)}.plan"
        for one in folder.iterdir():
            if one.name != "new.plan":
                one.unlink()
        (folder / "new.plan").rename(kept)
        self.store.keep(StoredPlan(plan, lists, folder))
        return plan

    async def file(self, ident: str, kind: str) -> File | None:
        """A plan as a file; None if there is no such plan."""
        kept = self.store.find(ident)
        if kept is None:
            return None
        stem = file_name(kept.plan.name)
        path = kept.folder / f"{stem}.{kind}"
        if kind == "waypoints":
            return File(path.name, FORMATS[kind], files.mission_text(kept.lists.mission))
        if not path.is_file():
            with self.store.scratch() as folder:
                shutil.copy(kept.folder / f"{stem}.plan", folder)
                await self.planner.run([f"{stem}.plan", "--out", path.name], folder)
                shutil.move(folder / path.name, path)
        return File(path.name, FORMATS[kind], path.read_bytes())

    async def on_board(self, boat: int, kind: str) -> File | None:
        """The mission on board as a file; None while it is not downloaded, or if there is none."""
        one = self._boats.get(boat)
        items = None if one is None else one.lists.items("mission")
        if items is None or len(items) < 2:
            return None
        stem = f"boat-{boat}-mission"
        text, name = files.mission_text(items), f"{stem}.{kind}"
        if kind == "waypoints":
            return File(name, FORMATS[kind], text)
        with self.store.scratch() as folder:
            (folder / f"{stem}.waypoints").write_bytes(text)
            arguments = [f"{stem}.waypoints", "--out", name, *self._fence(boat, folder)]
            rally = files.rally_file(self._boats.items(boat, "rally"))
            if rally is not None:
                (folder / "rally.geojson").write_bytes(rally)
                arguments += ["--rally", "rally.geojson"]
            await self.planner.run(arguments, folder)
            return File(name, FORMATS[kind], (folder / name).read_bytes())

    def close(self) -> None:
        """End the planner, forget the plans. May be called twice."""
        self.planner.close()
        self.store.close()

    def _source(self, folder: Path, start: Place) -> str:
        if self._water is not None:
            return self._water
        (folder / "open.toml").write_bytes(files.open_water_file(start.lat, start.lon))
        return "open.toml"

    def _fence(self, boat: int, folder: Path) -> list[str]:
        fence = files.fence_file(self._boats.items(boat, "fence"))
        if fence is None:
            return []
        (folder / "fence.geojson").write_bytes(fence)
        return ["--fence", "fence.geojson"]


def _arguments_of(wanted: PlanRequest, folder: Path) -> list[str]:
    """The planner's options for a request."""
    told: list[str] = []
    if wanted.task == "survey":
        area = "all"
        if wanted.area:
            area = "area.geojson"
            (folder / area).write_bytes(files.area_file(wanted.area))
        told += ["--survey", area]
        for option, value in (
            ("footprint", wanted.footprint_m),
            ("overlap", wanted.overlap),
            ("angle", wanted.angle_deg),
        ):
            if value is not None:
                told.append(f"--{option}={value!r}")
    else:
        *via, goal = wanted.goals
        told += [f"--via={_place(*at)}" for at in via]
        told.append(f"--goal={_place(*goal)}")
        if wanted.any_order and via:
            told.append("--any-order")
    if wanted.is_return:
        told.append("--return")
    if wanted.wind_m_s:
        told.append(f"--wind={wanted.wind_m_s:g}@{wanted.wind_from_deg or 0.0:g}")
    for option, value in (("clearance", wanted.clearance_m), ("speed", wanted.speed_m_s)):
        if value is not None:
            told.append(f"--{option}={value!r}")
    return told


def _place(lon: float, lat: float) -> str:
    return f"{lat:.7f},{lon:.7f}"


def _absolute(boat: str | None) -> str | None:
    """A boat's file wherever the planner runs; a name stays."""
    return str(Path(boat).resolve()) if boat is not None and boat.endswith(".toml") else boat
