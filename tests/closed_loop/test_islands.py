"""What no map knew on the way home: seen, kept in mind, and rounded."""

import json
from pathlib import Path

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


def returned(rig: Rig, home: Point, limit_s: float) -> float:
    """Seconds that RTL takes to a home set there."""
    place = rig.scenario.frame.to_global(home)
    rig.peer.command_int(dialect.MAV_CMD_DO_SET_HOME, x=deg_to_e7(place.lat_deg), y=deg_to_e7(place.lon_deg))
    rig.run(2.0)
    assert rig.set_mode(Mode.RTL) == OK
    assert rig.arm() == OK
    return rig.until(lambda: rig.offset_m(*home) < 3.0, limit_s)


def is_accused(rig: Rig) -> bool:
    """Whether a motor of the healthy boat was suspected."""
    return any("otor" in text or "Steering" in text for text in rig.peer.texts)


def test_a_wall_that_no_map_knew_is_rounded_on_the_way_home() -> None:
    corners = "[[-30, 20], [40, 20], [40, 22], [-30, 22]]"
    wall = f"map.obstacles=[{{name='wall', polygon={corners}}}]"
    rig = Rig("open", wall, config={"avoidance.by_sight": 1, "failsafe.gcs_enabled": False}).ready()
    assert returned(rig, Point(45.0, 0.0), 330.0) < 290.0  # both ways along 70 m of wall at 1.2 m/s
    assert rig.world.groundings == 0
    assert not is_accused(rig)


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
    start = Rig("lake").scenario.frame.to_local(BEHIND_THE_ISLANDS)
    home = Rig("lake").scenario.start
    rig = fenced(Rig("lake", f"route.start=[{start.east_m}, {start.north_m}]").ready(), *outline())
    assert returned(rig, home, 420.0) < 420.0


def test_a_wall_across_the_way_to_a_guided_point_is_rounded() -> None:
    corners = "[[-30, 20], [12, 20], [12, 22], [-30, 22]]"
    wall = f"map.obstacles=[{{name='wall', polygon={corners}}}]"
    rig = Rig("open", wall, config={"avoidance.by_sight": 1, "failsafe.gcs_enabled": False}).ready()
    armed(Mode.GUIDED, rig=rig)
    go_to(rig, 45.0, 0.0)
    assert rig.until(lambda: rig.offset_m(45.0, 0.0) < 3.0, 260.0) < 200.0
    assert rig.world.groundings == 0
    assert not is_accused(rig)
