"""Finds a vehicle on a link.

We announce an onboard controller (MAV_TYPE_ONBOARD_CONTROLLER) with a system id of its own. A planner that
called itself a ground station would keep the operator's failsafe quiet for as long as it runs.
"""

import asyncio
import logging
import time
from collections.abc import AsyncIterator, Callable
from contextlib import AsyncExitStack, asynccontextmanager

from mavsdk.asyncio import ComponentType, Configuration, Mavsdk, MavsdkConnectionError
from mavsdk.logging import log_subscribe

from companion.mavlink.signing_key import SigningKey
from mission_tools.errors import NoVehicle
from mission_tools.vehicle.link_url import DEFAULT_SYSTEM_ID, LinkUrl
from mission_tools.vehicle.signed_link import signed_link
from mission_tools.vehicle.vehicle import SILENCE_S, Vehicle

ONBOARD_COMPUTER = 191  # MAV_COMP_ID_ONBOARD_COMPUTER
MESSAGES = (
    "HEARTBEAT",
    "GLOBAL_POSITION_INT",
    "MISSION_CURRENT",
    "MISSION_ITEM_REACHED",
    "MISSION_REQUEST",
    "MISSION_REQUEST_INT",
    "MISSION_ACK",
    "STATUSTEXT",
)

log = logging.getLogger(__name__)


@asynccontextmanager
async def connect(
    link: LinkUrl,
    timeout_s: float,
    system_id: int = DEFAULT_SYSTEM_ID,
    key: SigningKey | None = None,
    clock: Callable[[], float] = time.monotonic,
) -> AsyncIterator[Vehicle]:
    """Open the link and wait for an autopilot's heartbeat. key: sign all that is sent, hear nothing unsigned.
    Raises NoVehicle: the link cannot be opened, or no vehicle answers on it; says what to try.
    """
    log_subscribe(_log_quietly)
    configuration = Configuration.create_with_component_type(ComponentType.COMPANION_COMPUTER)
    configuration.system_id, configuration.component_id = system_id, ONBOARD_COMPUTER
    async with Mavsdk(configuration) as mavsdk, AsyncExitStack() as stack:
        signed = None
        if key is not None:
            signed = await stack.enter_async_context(signed_link(mavsdk, link, key))
        else:
            try:
                await mavsdk.add_any_connection(link.mavsdk)
            except MavsdkConnectionError as error:
                raise NoVehicle(f"{link.typed}: cannot be opened ({error}): {link.advice}") from None
        system = await mavsdk.first_autopilot(timeout_s)
        if system is None:
            advice = (signed.warning() if signed is not None else "") or link.advice
            raise NoVehicle(f"{link.typed}: no vehicle within {timeout_s:g} s: {advice}")
        vehicle = Vehicle(link, system, await system.get_system_id(), clock)
        watchers = [asyncio.create_task(vehicle.watch(name)) for name in MESSAGES]
        try:
            vehicle.state.heard_s = clock()
            if not await vehicle.wait_for(lambda: vehicle.state.custom_mode >= 0, SILENCE_S):
                raise NoVehicle(
                    f"{link.typed}: the vehicle fell silent after its first heartbeat: {link.advice}"
                )
            await vehicle.ask_for_rates()
            yield vehicle
        finally:
            for watcher in watchers:
                watcher.cancel()
            await asyncio.gather(*watchers, return_exceptions=True)
            vehicle.close()


def _log_quietly(level: int, message: str, file: str | None, line: int) -> bool:
    """MAVSDK prints to stdout in colour unless it is told that its line has been dealt with."""
    log.debug("MAVSDK %s: %s (%s:%d)", level, message, file, line)
    return True
