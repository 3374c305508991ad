"""A ground station on MAVSDK, and mission items as its plugins have them."""

from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager

from mavsdk.asyncio import ComponentType, Configuration, Mavsdk, System
from mavsdk.plugins.mission_raw import MissionItem as RawItem
from mavutil_station import Place
from patience import MOMENT_S


@asynccontextmanager
async def mavsdk_station(port: int, kind: str = "tcpout") -> AsyncIterator[System]:
    """Connected to the autopilot behind a port of this machine."""
    async with Mavsdk(Configuration.create_with_component_type(ComponentType.GROUND_STATION)) as mavsdk:
        await mavsdk.add_any_connection(f"{kind}://127.0.0.1:{port}")
        system = await mavsdk.first_autopilot(MOMENT_S)
        assert system is not None
        yield system


def raw(places: Sequence[Place], mission_type: int = 0, param1: float = 0.0) -> list[RawItem]:
    """The items to upload."""
    return [
        RawItem(seq, place.frame, place.command, int(seq == 0 == mission_type), 1, param1, 0.0, 0.0, 0.0,
                place.lat_e7, place.lon_e7, 0.0, mission_type)
        for seq, place in enumerate(places)
    ]  # fmt: skip


def places_of(items: Sequence[RawItem]) -> list[Place]:
    """The items that were downloaded."""
    return [Place(item.command, item.frame, item.x, item.y) for item in items]
