"""The whole job of `mission-upload`: propose, connect, upload, read back and compare, start, follow."""

import asyncio
import contextlib
import math
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import AsyncExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar, cast

from rich.console import Console

from companion.mavlink.signing_key import SigningKey
from mission_tools.drawing.preview import check_picture_name, save_preview
from mission_tools.errors import NoVehicle, ReadBackMismatch, UsageError
from mission_tools.mission.areas import NO_AREAS, Areas, open_areas
from mission_tools.mission.compare import Difference, differences
from mission_tools.mission.mission import MissionItem, MissionType
from mission_tools.mission.plan_file import check_mission_name, save_mission
from mission_tools.mission.planned_mission import (
    MapSource,
    MissionFile,
    PlannedMission,
    PlanOptions,
    open_source,
)
from mission_tools.vehicle.connection import DEFAULT_SYSTEM_ID, connect
from mission_tools.vehicle.follow import follow
from mission_tools.vehicle.link_url import DEFAULT_LINK, LinkUrl, parse_link
from mission_tools.vehicle.mission_monitor import MissionMonitor
from mission_tools.vehicle.signed_link import read_sign_key
from mission_tools.vehicle.vehicle import NAMES, Vehicle
from mission_tools.wording import distance, duration

SHOWN_DIFFERENCES = 3

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Request:
    """What was asked for. source: None for fence and rally points alone, and the boat's mission stays."""

    source: str | None
    options: PlanOptions = field(default_factory=PlanOptions)
    link: str = DEFAULT_LINK
    system_id: int = DEFAULT_SYSTEM_ID
    patience_s: float = 10.0  # for the first heartbeat, the first position, and for arming
    start: bool = False
    follow: bool = False
    timeout_s: float = math.inf
    dry_run: bool = False
    save: Path | None = None
    preview: Path | None = None
    sign_key: Path | None = None
    fence: str | None = None  # a file, or "none" to clear
    rally: str | None = None


@dataclass(slots=True)
class Report:
    """The results so far, also of a job that fails."""

    planned: PlannedMission | None = None
    link: str = ""
    vehicle_id: int | None = None
    mode: str = ""
    items: int = 0
    lists: dict[str, int] = field(default_factory=dict)  # items of each list, cleared ones too
    upload_s: float = math.nan
    read_back_s: float = math.nan
    read_back_equal: bool = False
    started: bool = False
    monitor: MissionMonitor | None = None
    saved: Path | None = None
    preview: Path | None = None


async def run(request: Request, report: Report, console: Console) -> None:
    """Do the job; `report` is filled in on the way and `console` gets a line for every step.

    Raises:
        MissionToolsError: what went wrong, with the exit code it stands for.
    """
    link = parse_link(request.link)
    key = None if request.sign_key is None else read_sign_key(request.sign_key)
    if request.preview is not None:
        check_picture_name(request.preview)
    _check_outputs(request)
    areas = open_areas(request.fence, request.rally)
    if request.source is None:
        await _run_without_source(request, areas, link, key, report, console)
        return
    source = open_source(request.source, request.options, areas)
    async with AsyncExitStack() as stack:
        vehicle = None
        if source.wants_position and not request.dry_run:
            vehicle = await stack.enter_async_context(
                connect(link, request.patience_s, request.system_id, key)
            )
        planned = report.planned = await _propose(source, vehicle, request.patience_s, console)
        _print_planned(planned, console)
        if request.save is not None:
            save_mission(planned.mission, request.save)
            report.saved = request.save
            console.print(f"saved {request.save}")
        try:
            if not request.dry_run:
                if vehicle is None:
                    vehicle = await stack.enter_async_context(
                        connect(link, request.patience_s, request.system_id, key)
                    )
                mission_lists = planned.mission.wire_lists(home_first=vehicle.state.is_ardupilot)
                await _upload(vehicle, mission_lists | areas.wire_lists(), report, console)
                await _sail(vehicle, request, report, console)
        finally:
            if request.preview is not None:
                save_preview(request.preview, planned, report.monitor)
                report.preview = request.preview
                console.print(f"drew {request.preview}")


def _check_outputs(request: Request) -> None:
    """What is written is of a known format, and nothing that is read is overwritten.

    Raises:
        PlanFileError, UsageError: names the file.
    """
    if request.save is not None:
        check_mission_name(request.save)
    inputs = [Path(name) for name in (request.source, request.fence, request.rally) if name is not None]
    inputs += [request.sign_key] if request.sign_key is not None else []
    for option, output in (("--save", request.save), ("--preview", request.preview)):
        for given in inputs:
            if output is not None and output.exists() and given.exists() and output.samefile(given):
                raise UsageError(
                    f"{option} {output}: would overwrite {given}, which is read; choose another name"
                )


async def _run_without_source(
    request: Request,
    areas: Areas,
    link: LinkUrl,
    key: SigningKey | None,
    report: Report,
    console: Console,
) -> None:
    """Fence and rally points alone."""
    unfit = [name for name in ("start", "follow", "save", "preview") if getattr(request, name)]
    if unfit or request.options != PlanOptions():
        options = ", ".join("--" + name for name in unfit) or "options about the route"
        raise UsageError(f"no SOURCE: {options} would need a scenario, a map or a mission file")
    if areas == NO_AREAS:
        raise UsageError("nothing to upload: expected a SOURCE, --fence FILE or --rally FILE")
    console.print(str(areas))
    if not request.dry_run:
        async with connect(link, request.patience_s, request.system_id, key) as vehicle:
            await _upload(vehicle, areas.wire_lists(), report, console)


async def _propose(
    source: MissionFile | MapSource, vehicle: Vehicle | None, patience_s: float, console: Console
) -> PlannedMission:
    here = None
    if vehicle is not None:
        is_known = await vehicle.wait_for(lambda: vehicle.state.position is not None, patience_s)
        if not is_known and source.needs_position:
            vehicle.raise_if_lost("waiting for its position")
            raise NoVehicle(
                f"{vehicle.link.typed}: no position from the boat within {patience_s:g} s: is there a fix? "
                "Or name the start: --start-at LAT,LON"
            )
        here = vehicle.state.position
        if here is None:
            console.print("note: no position from the boat: the route starts at the scenario's start")
    # Off the event loop, so that the vehicle's messages are taken in meanwhile.
    return await _in_thread(lambda: source.prepare(here))


async def _in_thread(work: Callable[[], T]) -> T:
    """As asyncio.to_thread, but an interrupted program does not wait for the thread's end."""
    loop = asyncio.get_running_loop()
    future: asyncio.Future[T] = loop.create_future()

    def settle(result: T | None, error: Exception | None) -> None:
        if future.cancelled():
            return
        if error is not None:
            future.set_exception(error)
        else:
            future.set_result(cast(T, result))

    def run() -> None:
        result, error = None, None
        try:
            result = work()
        except Exception as raised:
            error = raised
        with contextlib.suppress(RuntimeError):  # the loop is closed
            loop.call_soon_threadsafe(settle, result, error)

    threading.Thread(target=run, daemon=True).start()
    return await future


def _print_planned(planned: PlannedMission, console: Console) -> None:
    mission, plan = planned.mission, planned.plan
    line = f"{planned.name}: {len(mission.places)} waypoints"
    if plan is not None:
        line += f", {distance(plan.length_m)} (straight {distance(plan.straight_m)})"
        if math.isfinite(plan.min_clearance_m):
            line += f", never nearer than {distance(plan.min_clearance_m)} to anything"
        line += f"; {plan.search.expanded} cells of {distance(plan.cell_m)} searched"
    console.print(line)
    for note in planned.notes:
        console.print(f"note: {note}")


async def _upload(
    vehicle: Vehicle, lists: Mapping[MissionType, Sequence[MissionItem]], report: Report, console: Console
) -> None:
    state, link = vehicle.state, vehicle.link
    report.link, report.vehicle_id, report.mode = link.typed, vehicle.system_id, state.mode
    report.lists = {kind.name.lower(): len(items) for kind, items in lists.items()}
    began_s = time.perf_counter()
    for kind, items in lists.items():
        if items:
            await vehicle.upload(kind, items)
        else:
            await vehicle.clear(kind)
    sent_s = time.perf_counter()
    held = {kind: await vehicle.download(kind) for kind in lists}
    report.items = sum(map(len, lists.values()))
    report.upload_s, report.read_back_s = sent_s - began_s, time.perf_counter() - sent_s
    found: list[tuple[MissionType, Difference]] = []
    for kind, items in lists.items():
        is_home_theirs = kind is MissionType.MISSION and state.is_ardupilot
        found += [
            (kind, difference)
            for difference in differences(items, held[kind], home_is_the_vehicles=is_home_theirs)
        ]
    if found:
        shown = "; ".join(_named(kind, difference) for kind, difference in found[:SHOWN_DIFFERENCES])
        more = f" and {len(found) - SHOWN_DIFFERENCES} more" if len(found) > SHOWN_DIFFERENCES else ""
        raise ReadBackMismatch(f"the vehicle does not hold what was sent: {shown}{more}")
    report.read_back_equal = True
    cleared = [NAMES[kind] for kind, items in lists.items() if not items]
    if cleared:
        what = " and the ".join(cleared)
        console.print(f"cleared the {what} of vehicle {vehicle.system_id} on {link.typed}")
    if not report.items:
        return
    console.print(
        f"uploaded {report.items} items to vehicle {vehicle.system_id} on {link.typed} "
        f"in {report.upload_s:.2f} s, read back and found equal"
    )


def _named(kind: MissionType, difference: Difference) -> str:
    """A difference, with the name of its list unless that is the mission."""
    return str(difference) if kind is MissionType.MISSION else f"{NAMES[kind]}, {difference}"


async def _sail(vehicle: Vehicle, request: Request, report: Report, console: Console) -> None:
    if request.start:
        await vehicle.start(request.patience_s)
        report.started, report.mode = True, vehicle.state.mode
        console.print("started")
    if request.follow and report.planned is not None:
        report.monitor = MissionMonitor.of(vehicle.state, report.planned.mission, time.monotonic())
        await follow(vehicle, report.monitor, console, request.timeout_s)
        report.mode = vehicle.state.mode
        sailed = f"sailed {distance(report.monitor.track_length_m)} in {duration(report.monitor.duration_s)}"
        console.print(f"{sailed}, now in {report.mode}")
