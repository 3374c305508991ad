"""Lists of items between us and a vehicle: sent, cleared, read back and compared."""

import asyncio
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from mission_tools.errors import ReadBackMismatch, VehicleError
from mission_tools.mission.mission import LIST_NAMES, Mission, MissionItem, MissionType
from mission_tools.mission.wire import Difference, differences, mission_from
from mission_tools.vehicle.connection import connect
from mission_tools.vehicle.link_url import DEFAULT_SYSTEM_ID, parse_link
from mission_tools.vehicle.signed_link import read_sign_key
from mission_tools.vehicle.vehicle import TRY_PAUSE_S, Vehicle

SHOWN_DIFFERENCES = 3
READINGS = 3  # of what was sent: an item that the line brings late or twice spoils one

Lists = Mapping[MissionType, Sequence[MissionItem]]


@dataclass(frozen=True, slots=True)
class Transfer:
    """How long the two directions took."""

    upload_s: float
    read_back_s: float


async def holdings(
    vehicle: Vehicle, kinds: Iterable[MissionType]
) -> dict[MissionType, tuple[MissionItem, ...]]:
    """What the vehicle holds of these lists. Raises UploadRejected, LinkLost: as `Vehicle.download`."""
    return {kind: await vehicle.download(kind) for kind in kinds}


async def held_mission(vehicle: Vehicle) -> Mission:
    """The mission, fence and rally points that are on board. Raises VehicleError: a fence on board that is
    none; names the item. UploadRejected, LinkLost: as `Vehicle.download`.
    """
    held = await holdings(vehicle, MissionType)
    try:
        return mission_from(held, home_first=vehicle.state.is_ardupilot)
    except ValueError as error:
        raise VehicleError(f"{vehicle.link.typed}: on board: {error}") from None


async def send(vehicle: Vehicle, lists: Lists) -> Transfer:
    """Replace the vehicle's lists by these, empty ones too, and read them back. Raises ReadBackMismatch: it
    does not hold what was sent; names list, item and field. UploadRejected, LinkLost: as `Vehicle.upload`.
    """
    began_s = time.perf_counter()
    for kind, items in lists.items():
        if items:
            await vehicle.upload(kind, items)
        else:
            await vehicle.clear(kind)
    sent_s = time.perf_counter()
    for number in range(READINGS):
        if number:
            await asyncio.sleep(TRY_PAUSE_S)
        held = await holdings(vehicle, lists)
        found = differing(lists, held, is_ardupilot=vehicle.state.is_ardupilot)
        if not found:
            break
    done_s = time.perf_counter()
    if found:
        shown = "; ".join(_named(kind, difference) for kind, difference in found[:SHOWN_DIFFERENCES])
        more = f" and {len(found) - SHOWN_DIFFERENCES} more" if len(found) > SHOWN_DIFFERENCES else ""
        raise ReadBackMismatch(f"the vehicle does not hold what was sent: {shown}{more}")
    return Transfer(sent_s - began_s, done_s - sent_s)


def differing(sent: Lists, held: Lists, *, is_ardupilot: bool) -> list[tuple[MissionType, Difference]]:
    """Every difference between what was sent and what is held. On ArduPilot home is the vehicle's own."""
    return [
        (kind, difference)
        for kind, items in sent.items()
        for difference in differences(
            items, held[kind], home_is_the_vehicles=kind is MissionType.MISSION and is_ardupilot
        )
    ]


def _named(kind: MissionType, difference: Difference) -> str:
    """A difference, with the name of its list unless that is the mission."""
    return str(difference) if kind is MissionType.MISSION else f"{LIST_NAMES[kind]}, {difference}"


@dataclass(frozen=True, slots=True)
class Held:
    """What a vehicle holds, and which vehicle it is."""

    mission: Mission
    vehicle_id: int
    link: str


def ask_vehicle(
    link: str, patience_s: float, sign_key: Path | None = None, system_id: int = DEFAULT_SYSTEM_ID
) -> Held:
    """Connect, and download mission, fence and rally points. Raises NoVehicle, LinkLost: no answer.
    VehicleError: it does not hand them out, or they make no sense. UsageError: the link or the key.
    """
    where = parse_link(link)
    key = None if sign_key is None else read_sign_key(sign_key)

    async def ask() -> Held:
        async with connect(where, patience_s, system_id, key) as vehicle:
            return Held(await held_mission(vehicle), vehicle.system_id, where.typed)

    return asyncio.run(ask())
