"""What no map knew on the way home: seen, kept in mind, and rounded."""

import json
from pathlib import Path

import pytest
from boat_rig import OK, Rig
from fence_rig import INCLUDED, fenced
from sailing_rig import armed, go_to

from companion.core.geo import LatLon, Point
from companion.core.modes import Mode
from companion.core.units import deg_to_e7
from companion.mavlink.dialect import dialect
from companion.mavlink.items import MissionItem

POND = Path("examples/maps/mill_pond_fence.geojson")
BEHIND_THE_ISLANDS = LatLon(50.00095, -1.19757)


def come_home(rig: Rig, home: Point, limit_s: float) -> None:
    """RTL to a home set there, within so long."""
    place = rig.scenario.frame.to_global(home)
    rig.peer.command_int(dialect.MAV_CMD_DO_SET_HOME, x=deg_to_e7(place.lat_deg), y=deg_to_e7(place.lon_deg))
    rig.run(2.0)
    assert rig.set_mode(Mode.RTL) == OK
    assert rig.arm() == OK
    rig.until(lambda: rig.offset_m(*home) < 3.0, limit_s)


@pytest.mark.parametrize("mode", [Mode.RTL, Mode.GUIDED], ids=lambda mode: mode.name)
def test_a_wall_that_no_map_knew_is_rounded(mode: Mode) -> None:
    wall = "map.obstacles=[{name='wall', polygon=[[-10, 10], [14, 10], [14, 12], [-10, 12]]}]"
    rig = Rig("open", wall, config={"avoidance.by_sight": 1, "failsafe.gcs_enabled": False}).ready()
    # Both ways along 24 m of wall; by the local planner alone RTL takes more than 100 s
    limit_s = 85.0 if mode is Mode.RTL else 115.0
    if mode is Mode.RTL:
        come_home(rig, Point(20.0, 0.0), limit_s)
    else:
        armed(mode, rig=rig)
        go_to(rig, 20.0, 0.0)
        rig.until(lambda: rig.offset_m(20.0, 0.0) < 3.0, limit_s)
    assert rig.world.groundings == 0
    assert not any("otor" in text or "Steering" in text for text in rig.peer.texts)


def outline() -> list[MissionItem]:
    """The pond's fence without its islands."""
    features = json.loads(POND.read_text())["features"]
    (ring,) = [
        one["geometry"]["coordinates"][0] for one in features if one["properties"]["kind"] == "inclusion"
    ]
    corners = ring[:-1]
    return [
        MissionItem(frame=0, command=INCLUDED, param1=float(len(corners)), x=deg_to_e7(lat), y=deg_to_e7(lon))
        for lon, lat in corners
    ]


def test_islands_that_the_fence_lacks_are_rounded_on_the_way_home() -> None:
    lake = Rig("lake").scenario
    start = lake.frame.to_local(BEHIND_THE_ISLANDS)
    home = start.towards(lake.start, 0.4)  # the rest is open water
    rig = fenced(Rig("lake", f"route.start=[{start.east_m}, {start.north_m}]").ready(), *outline())
    come_home(rig, home, 168.0)
