"""Fences for tests: areas in metres of the open scenario's frame, as mission items."""

import math

from boat_rig import Rig, scenario

from companion.core.geo import Point
from companion.core.units import deg_to_e7
from companion.mavlink.items import MissionItem, MissionType
from companion.mavlink.transfer import Completed

INCLUDED, EXCLUDED, CIRCLE_IN, CIRCLE_OUT, RALLY = 5001, 5002, 5003, 5004, 5100
Corner = tuple[float, float]


def item(north_m: float, east_m: float, command: int, param1: float = 0.0) -> MissionItem:
    """A fence or rally item at a place."""
    place = scenario().frame.to_global(Point(north_m, east_m))
    return MissionItem(
        frame=0, command=command, param1=param1, x=deg_to_e7(place.lat_deg), y=deg_to_e7(place.lon_deg)
    )


def polygon(corners: list[Corner], command: int = INCLUDED) -> list[MissionItem]:
    """A polygon by its corners, north and east."""
    return [item(north_m, east_m, command, float(len(corners))) for north_m, east_m in corners]


def box(south_m: float, west_m: float, north_m: float, east_m: float) -> list[Corner]:
    """A rectangle's corners."""
    return [(south_m, west_m), (south_m, east_m), (north_m, east_m), (north_m, west_m)]


L_CORNERS = [(-15.0, -15.0), (-15.0, 75.0), (75.0, 75.0), (75.0, 45.0), (15.0, 45.0), (15.0, -15.0)]
"""Thirty metres wide: 60 m east from the start, then 60 m north, round the corner at (15, 45)."""


def fenced(rig: Rig, *items: MissionItem) -> Rig:
    """Upload these as the fence."""
    assert isinstance(rig.upload(list(items), mission_type=MissionType.FENCE), Completed)
    return rig


def margin_m(rig: Rig) -> float:
    """How far the boat truly is inside the fence."""
    truth, frame = rig.world.truth, rig.boat.vehicle.frame
    assert frame is not None
    place = rig.scenario.frame.to_global(Point(truth.north_m, truth.east_m))
    return rig.boat.vehicle.fence.margin_m(frame.to_local(place))


def least_margin_m(rig: Rig, seconds: float) -> float:
    """Sail on; how near the fence the boat truly came."""
    least = math.inf
    for _ in range(round(seconds / 0.2)):
        rig.run(0.2)
        least = min(least, margin_m(rig))
    return least
