"""Fences that no boat can keep, as a store of another version may hold them: every mode is answered."""

import pytest
from boat_rig import OK, Rig

from companion.core.geo import LatLon
from companion.geofence.fence import FenceArea, FenceCircle, FencePolygon
from companion.mavlink.dialect import dialect

pytestmark = pytest.mark.slow

HOLD, LOITER, GUIDED, RTL, MANUAL = 4, 5, 15, 11, 0


def polygon(*places: tuple[float, float], is_inclusion: bool = True) -> FencePolygon:
    return FencePolygon(tuple(LatLon(*place) for place in places), is_inclusion)


ABSURD = {
    "round the pole": polygon((-90.0, 0.0), (-90.0, 90.0), (-89.999, 180.0)),
    "the world": polygon((85.0, -179.0), (85.0, 179.0), (-85.0, 179.0), (-85.0, -179.0)),
    "poles excluded": polygon((90.0, -180.0), (90.0, 180.0), (-90.0, 0.0), is_inclusion=False),
    "a line": polygon((50.0, -1.2), (50.001, -1.2), (50.002, -1.2)),
    "a circle without end": FenceCircle(LatLon(89.99, 0.0), 1e30, True),
}


@pytest.mark.parametrize("area", ABSURD.values(), ids=ABSURD.keys())
def test_every_mode_and_a_pause_are_answered_whatever_the_fence(area: FenceArea) -> None:
    rig = Rig("open").ready()
    assert rig.set_mode(GUIDED) == OK
    assert rig.arm() == OK
    rig.boat.vehicle.fence.set_areas([area])
    rig.run(2.0)  # long enough for the failsafe
    for mode in (LOITER, HOLD, GUIDED, MANUAL, RTL, LOITER):
        assert rig.set_mode(mode) == OK
        rig.run(0.4)
    assert rig.ask(dialect.MAV_CMD_DO_PAUSE_CONTINUE, 0.0) == OK
    rig.run(0.4)
    assert (rig.boat.net.faults, rig.boat.endpoint.faults) == (0, 0)
    assert rig.boat.vehicle.armed
