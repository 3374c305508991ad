"""Ask a vehicle for everything that it holds."""

import asyncio
from dataclasses import dataclass
from pathlib import Path

from mission_tools.mission.mission import Mission
from mission_tools.vehicle.connection import connect
from mission_tools.vehicle.exchange import held_mission
from mission_tools.vehicle.link_url import DEFAULT_SYSTEM_ID, parse_link
from mission_tools.vehicle.signed_link import read_sign_key


@dataclass(frozen=True, slots=True)
class Held:
    """What a vehicle holds, and which vehicle it is."""

    mission: Mission
    vehicle_id: int
    link: str


def ask_vehicle(
    link: str, patience_s: float, sign_key: Path | None = None, system_id: int = DEFAULT_SYSTEM_ID
) -> Held:
    """Connect, and download mission, fence and rally points.

    Raises:
        NoVehicle, LinkLost: no answer.
        VehicleError: it does not hand them out, or they make no sense.
        UsageError: the link or the key.
    """
    where = parse_link(link)
    key = None if sign_key is None else read_sign_key(sign_key)

    async def ask() -> Held:
        async with connect(where, patience_s, system_id, key) as vehicle:
            return Held(await held_mission(vehicle), vehicle.system_id, where.typed)

    return asyncio.run(ask())
