"""Every mode against everything that it may lack, and every column of the table of modes."""

from itertools import product

import pytest
from boat_rig import FRAME, GOOD_FIX, nav_at, place
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig
from companion.core.geo import LatLon
from companion.core.modes import Mode
from companion.core.requests import Arm, ChangeMode, Disarm, OtherVehicle
from companion.geofence.fence import FenceCircle
from companion.vehicle.mission.steps import Home, Waypoint
from companion.vehicle.vehicle import Vehicle

STEERED_BY_POSITION = frozenset(Mode) - {Mode.MANUAL, Mode.HOLD}
LACKS: dict[str, tuple[frozenset[Mode], str]] = {  # the modes that it bars, and the reason given
    "nothing": (frozenset(), ""),
    "estimate": (STEERED_BY_POSITION, "no position yet"),
    "position": (STEERED_BY_POSITION, "position is stale"),
    "heading": (STEERED_BY_POSITION, "no heading"),
    "mission": (frozenset({Mode.AUTO}), "no mission"),
    "home in reach": (frozenset({Mode.RTL}), "home is more than 100 km away"),
    "track": (frozenset({Mode.SMART_RTL}), "no track, the boat was not armed"),
    "lead": (frozenset({Mode.FOLLOW}), "no vehicle is heard"),
    "lead in reach": (frozenset({Mode.FOLLOW}), "system 2 is 150 m away (FOLL_DIST_MAX 100)"),
}


def vehicle_without(lack: str) -> Vehicle:
    """Disarmed in HOLD, with everything that any mode needs but one thing."""
    vehicle = Vehicle(BoatConfig())
    vehicle.update_state(nav_at(), FRAME, GOOD_FIX, None, 0.0)
    if lack != "mission":
        vehicle.set_mission((Home(), Waypoint(place(50.0, 0.0))))
    if lack != "track":
        assert vehicle.request(Arm()).accepted
        assert vehicle.request(Disarm()).accepted
    if lack != "lead":
        away_m = 150.0 if lack == "lead in reach" else 20.0
        vehicle.request(OtherVehicle(2, place(away_m, 0.0), 1.0, 0.0, 0.0))
    if lack == "home in reach":
        vehicle.home = LatLon(51.2, -1.2)
    if lack == "estimate":
        vehicle.update_state(None, None, None, None, 1.0)
    if lack == "position":
        vehicle.update_state(replace(nav_at(), position_age_s=10.0), FRAME, None, None, 1.0)
    if lack == "heading":
        vehicle.update_state(replace(nav_at(), heading_age_s=10.0), FRAME, GOOD_FIX, None, 1.0)
    return vehicle


@pytest.mark.parametrize(("mode", "lack"), [*product(Mode, LACKS)], ids=str)
def test_a_mode_is_refused_exactly_where_it_lacks_something(mode: Mode, lack: str) -> None:
    vehicle = vehicle_without(lack)
    barred, reason = LACKS[lack]
    outcome = vehicle.request(ChangeMode(mode))
    if mode in barred:
        assert outcome.reason == f"{mode.name}: {reason}"
        assert vehicle.mode is Mode.HOLD
    else:
        assert outcome.accepted, outcome.reason
        assert vehicle.mode is mode


@pytest.mark.parametrize("mode", Mode)
def test_a_boat_outside_the_fence_arms_only_in_modes_that_come_inside(mode: Mode) -> None:
    vehicle = vehicle_without("nothing")
    vehicle.set_fence([FenceCircle(place(500.0, 0.0), 50.0, is_inclusion=True)])
    vehicle.force_mode(mode, "test")
    refusals = [fault for fault in vehicle.arming_faults() if "outside" in fault]
    assert bool(refusals) is (mode not in (Mode.LOITER, Mode.RTL))
