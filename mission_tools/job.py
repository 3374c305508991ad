"""The whole job of `mission-upload`: propose, connect, upload, read back and compare, start, follow."""

import asyncio
import math
import time
from contextlib import AsyncExitStack
from dataclasses import dataclass, field
from pathlib import Path

from rich.console import Console

from mission_tools.compare import differences
from mission_tools.errors import NoVehicle, ReadBackMismatch
from mission_tools.follow import follow
from mission_tools.link_url import DEFAULT_LINK, LinkUrl, parse_link
from mission_tools.mission import MissionType
from mission_tools.plan_file import save_mission
from mission_tools.preview import check_picture_name, save_preview
from mission_tools.proposal import MissionFile, Proposal, Water, Wishes, open_source
from mission_tools.signed_link import read_sign_key
from mission_tools.vehicle import DEFAULT_SYSTEM_ID, Vehicle, connect
from mission_tools.voyage import Voyage
from mission_tools.wording import distance, duration

SHOWN_DIFFERENCES = 3


@dataclass(frozen=True, slots=True)
class Request:
    """What was asked for."""

    source: str
    wishes: Wishes = field(default_factory=Wishes)
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


@dataclass(slots=True)
class Report:
    """What became of it; grows as the job goes on, so that a failed one still tells how far it came."""

    proposal: Proposal | None = None
    link: str = ""
    vehicle_id: int | None = None
    mode: str = ""
    items: int = 0
    upload_s: float = math.nan
    read_back_s: float = math.nan
    read_back_equal: bool = False
    started: bool = False
    voyage: Voyage | None = None
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
    source = open_source(request.source, request.wishes)
    async with AsyncExitStack() as stack:
        vehicle = None
        if source.needs_position and not request.dry_run:
            vehicle = await stack.enter_async_context(
                connect(link, request.patience_s, request.system_id, key)
            )
        proposal = report.proposal = await _propose(source, vehicle, request.patience_s)
        _say_proposal(proposal, console)
        if request.save is not None:
            save_mission(proposal.mission, request.save)
            report.saved = request.save
            console.print(f"saved {request.save}")
        try:
            if not request.dry_run:
                if vehicle is None:
                    vehicle = await stack.enter_async_context(
                        connect(link, request.patience_s, request.system_id, key)
                    )
                await _upload(vehicle, link, proposal, report, console)
                await _sail(vehicle, request, report, console)
        finally:
            if request.preview is not None:
                save_preview(request.preview, proposal, report.voyage)
                report.preview = request.preview
                console.print(f"drew {request.preview}")


async def _propose(source: MissionFile | Water, vehicle: Vehicle | None, patience_s: float) -> Proposal:
    here = None
    if vehicle is not None:
        if not await vehicle.wait_for(lambda: vehicle.state.position is not None, patience_s):
            vehicle.raise_if_lost("waiting for its position")
            raise NoVehicle(
                f"{vehicle.link.typed}: no position from the boat within {patience_s:g} s: is there a fix? "
                "Or name the start: --start-at LAT,LON"
            )
        here = vehicle.state.position
    # Off the event loop, so that the vehicle's messages are taken in meanwhile.
    return await asyncio.to_thread(source.propose, here)


def _say_proposal(proposal: Proposal, console: Console) -> None:
    mission, plan = proposal.mission, proposal.plan
    line = f"{proposal.name}: {len(mission.places)} waypoints"
    if plan is not None:
        line += f", {distance(plan.length_m)} (straight {distance(plan.straight_m)})"
        if math.isfinite(plan.min_clearance_m):
            line += f", never nearer than {distance(plan.min_clearance_m)} to anything"
        line += f"; {plan.search.expanded} cells of {distance(plan.cell_m)} searched"
    console.print(line)
    for note in plan.notes if plan is not None else ():
        console.print(f"note: {note}")


async def _upload(
    vehicle: Vehicle, link: LinkUrl, proposal: Proposal, report: Report, console: Console
) -> None:
    state = vehicle.state
    report.link, report.vehicle_id, report.mode = link.typed, vehicle.system_id, state.mode
    lists = proposal.mission.wire_lists(home_first=state.is_ardupilot)
    began_s = time.perf_counter()
    for kind, items in lists.items():
        await vehicle.upload(kind, items)
    sent_s = time.perf_counter()
    held = {kind: await vehicle.download(kind) for kind in lists}
    report.items = sum(map(len, lists.values()))
    report.upload_s, report.read_back_s = sent_s - began_s, time.perf_counter() - sent_s
    found = []
    for kind, items in lists.items():
        is_home_theirs = kind is MissionType.MISSION and state.is_ardupilot
        found += differences(items, held[kind], home_is_the_vehicles=is_home_theirs)
    if found:
        shown = "; ".join(map(str, found[:SHOWN_DIFFERENCES]))
        more = f" and {len(found) - SHOWN_DIFFERENCES} more" if len(found) > SHOWN_DIFFERENCES else ""
        raise ReadBackMismatch(f"the vehicle does not hold what was sent: {shown}{more}")
    report.read_back_equal = True
    console.print(
        f"uploaded {report.items} items to vehicle {vehicle.system_id} on {link.typed} "
        f"in {report.upload_s:.2f} s, read back and found equal"
    )


async def _sail(vehicle: Vehicle, request: Request, report: Report, console: Console) -> None:
    if request.start:
        await vehicle.start(request.patience_s)
        report.started, report.mode = True, vehicle.state.mode
        console.print("started")
    if request.follow and report.proposal is not None:
        report.voyage = Voyage.of(vehicle.state, report.proposal.mission, time.monotonic())
        await follow(vehicle, report.voyage, console, request.timeout_s)
        report.mode = vehicle.state.mode
        sailed = f"sailed {distance(report.voyage.track_length_m)} in {duration(report.voyage.duration_s)}"
        console.print(f"{sailed}, now in {report.mode}")
