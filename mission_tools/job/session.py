"""The part of an upload that needs a vehicle: connect, ask where it is, send, start, follow."""

import asyncio
import time
from contextlib import AsyncExitStack

from mission_tools.assembly.areas import Areas
from mission_tools.assembly.map_source import MapSource
from mission_tools.assembly.open_source import MissionFile
from mission_tools.assembly.planned_mission import PlannedMission
from mission_tools.contract.diff import diff
from mission_tools.errors import NoVehicle
from mission_tools.job.parts import take_mission
from mission_tools.job.planned import Report, Request, draw
from mission_tools.mission.mission import LIST_NAMES
from mission_tools.vehicle.connection import connect
from mission_tools.vehicle.exchange import Lists, differing, holdings, send
from mission_tools.vehicle.follow import follow, in_thread, looking_out
from mission_tools.vehicle.link_url import LinkUrl
from mission_tools.vehicle.mission_monitor import MissionMonitor
from mission_tools.vehicle.signed_link import read_sign_key
from mission_tools.vehicle.vehicle import Vehicle
from mission_tools.watch.watcher import Watcher
from mission_tools.wording import Printer, distance, duration


def run_session(
    request: Request,
    link: LinkUrl,
    source: MissionFile | MapSource | None,
    areas: Areas,
    report: Report,
    say: Printer,
) -> None:
    """Connect and do what was asked for. source: None for fence and rally points alone. Raises
    MissionToolsError: what went wrong.
    """
    session = _UploadSession(request, link, report, say)
    asyncio.run(session.upload_areas(areas) if source is None else session.upload(source, areas))


class _UploadSession:
    def __init__(self, request: Request, link: LinkUrl, report: Report, say: Printer) -> None:
        self._request = request
        self._link = link
        self._key = None if request.sign_key is None else read_sign_key(request.sign_key)
        self._report = report
        self._say = say

    async def upload_areas(self, areas: Areas) -> None:
        """Fence and rally points alone."""
        for line in areas.lines():
            self._say(line)
        async with AsyncExitStack() as stack:
            await self._send(await self._connected(stack), areas.wire_lists())

    async def upload(self, source: MissionFile | MapSource, areas: Areas) -> None:
        """Plan, from where the boat is unless a start is named; send; start and follow."""
        async with AsyncExitStack() as stack:
            vehicle = await self._connected(stack) if source.wants_position else None
            planned = await self._propose(source, vehicle)
            planned = take_mission(planned, self._request, self._report, self._say)
            try:
                vehicle = vehicle or await self._connected(stack)
                mission_lists = planned.mission.wire_lists(home_first=vehicle.state.is_ardupilot)
                await self._send(vehicle, mission_lists | areas.wire_lists())
                await self._sail(vehicle, planned)
            finally:
                draw(planned, self._request, self._report, self._say)

    async def _connected(self, stack: AsyncExitStack) -> Vehicle:
        request = self._request
        vehicle = await stack.enter_async_context(
            connect(self._link, request.patience_s, request.system_id, self._key)
        )
        vehicle.notify = self._say
        return vehicle

    async def _propose(self, source: MissionFile | MapSource, vehicle: Vehicle | None) -> PlannedMission:
        here, patience_s = None, self._request.patience_s
        if vehicle is not None:
            is_known = await vehicle.wait_for(lambda: vehicle.state.position is not None, patience_s)
            if not is_known and source.needs_position:
                vehicle.raise_if_lost("waiting for its position")
                raise NoVehicle(
                    f"{vehicle.link.typed}: no position from the boat within {patience_s:g} s: is there a "
                    "fix? Or name the start: --start-at LAT,LON"
                )
            here = vehicle.state.position
            if here is None:
                self._say("note: no position from the boat: the route starts at the scenario's start")
        return await in_thread(lambda: source.prepare(here))

    async def _send(self, vehicle: Vehicle, lists: Lists) -> None:
        state, typed, report = vehicle.state, vehicle.link.typed, self._report
        report.link, report.vehicle_id, report.mode = typed, vehicle.system_id, state.mode
        report.lists = {kind.name.lower(): len(items) for kind, items in lists.items()}
        if self._request.diff or self._request.if_changed:
            lists = await self._changed(vehicle, lists)
        if not lists:
            return
        times = await send(vehicle, lists)
        report.items = sum(map(len, lists.values()))
        report.upload_s, report.read_back_s = times.upload_s, times.read_back_s
        report.read_back_equal = True
        cleared = [LIST_NAMES[kind] for kind, items in lists.items() if not items]
        if cleared:
            self._say(f"cleared the {' and the '.join(cleared)} of vehicle {vehicle.system_id} on {typed}")
        if report.items:
            self._say(
                f"uploaded {report.items} items to vehicle {vehicle.system_id} on {typed} "
                f"in {times.upload_s:.2f} s, read back and found equal"
            )

    async def _changed(self, vehicle: Vehicle, lists: Lists) -> Lists:
        """Say what an upload changes; with --if-changed, the lists that it changes."""
        held, is_ardupilot = await holdings(vehicle, lists), vehicle.state.is_ardupilot
        for line in diff(lists, held, is_ardupilot=is_ardupilot):
            self._say(line)
        changed = {kind for kind, _ in differing(lists, held, is_ardupilot=is_ardupilot)}
        self._report.changed = [kind.name.lower() for kind in lists if kind in changed]
        if not self._request.if_changed:
            return lists
        if not changed:
            self._report.read_back_equal = True
            self._say(
                f"nothing uploaded: vehicle {vehicle.system_id} on {vehicle.link.typed} holds all of it"
            )
        return {kind: items for kind, items in lists.items() if kind in changed}

    async def _sail(self, vehicle: Vehicle, planned: PlannedMission) -> None:
        request, report = self._request, self._report
        if request.start:
            await vehicle.start(request.patience_s)
            report.started, report.mode = True, vehicle.state.mode
            self._say("started")
        if request.follow or request.watch:
            report.monitor = MissionMonitor.of(vehicle.state, planned.mission, time.monotonic())
            async with AsyncExitStack() as stack:
                lookout = None
                if request.watch:
                    watcher = Watcher(planned.chart, planned.mission, planned.clearance_m)
                    lookout = await stack.enter_async_context(
                        looking_out(vehicle, watcher, self._say, time.monotonic)
                    )
                report.monitor = await follow(
                    vehicle, report.monitor, self._say.stream, request.timeout_s, lookout=lookout
                )
            report.mode = vehicle.state.mode
            monitor = report.monitor
            sailed = f"sailed {distance(monitor.track_length_m)} in {duration(monitor.duration_s)}"
            self._say(f"{sailed}, now in {report.mode}")
