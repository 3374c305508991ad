"""What no map knew on the way home or on a mission: seen, kept in mind, and rounded."""

import json
from pathlib import Path

import pytest
from boat_rig import OK, Rig, waypoint
from fence_rig import INCLUDED, fenced
from sailing_rig import armed, go_to, over, reached, told

from companion.core.geo import LatLon, Point
from companion.core.modes import Mode
from companion.core.units import deg_to_e7
from companion.mavlink.dialect import dialect
from companion.mavlink.items import MissionItem

BY_SIGHT: dict[str, object] = {"avoidance.by_sight": 1, "failsafe.gcs_enabled": False}
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
    rig = Rig("open", wall, config=BY_SIGHT).ready()
    # Both ways along 24 m of wall; by the local planner alone RTL takes more than 100 s
    limit_s, most_told = (85.0, 4) if mode is Mode.RTL else (100.0, 2)
    if mode is Mode.RTL:
        come_home(rig, Point(20.0, 0.0), limit_s)
    else:
        armed(mode, rig=rig)
        go_to(rig, 20.0, 0.0)
        rig.until(lambda: rig.offset_m(20.0, 0.0) < 3.0, limit_s)
    assert rig.world.groundings == 0
    assert 1 <= sum("passing to" in text for text in rig.peer.texts) <= most_told
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


ISLAND = "map.obstacles=[{name='island', polygon=[[30, -9], [41, -8], [42, 7], [36, 10], [29, 6]]}]"
ROCKY = "map.obstacles=[{name='rock', polygon=[[30, -5], [41, -4], [41, 5], [30, 4]]}]"


def off_line_m(rig: Rig, east_m: float, limit_s: float) -> float:
    """How far off the parallel of the start the boat is when it comes to a place of it."""
    rig.until(lambda: rig.world.truth.east_m > east_m, limit_s)
    return abs(rig.world.truth.north_m)


def test_an_island_on_a_later_leg_is_rounded_and_the_line_sailed_on() -> None:
    rig = Rig("open", ISLAND, config=BY_SIGHT)
    rig.sail(waypoint(0.0, 10.0), waypoint(0.0, 62.0), waypoint(15.0, 62.0))
    assert off_line_m(rig, 25.0, 40.0) < 1.0
    assert off_line_m(rig, 36.0, 80.0) > 6.0
    assert off_line_m(rig, 56.0, 40.0) < 2.0
    rig.until(lambda: reached(rig)[-1:] == [3], 50.0)
    assert rig.world.groundings == 0
    assert not any("otor" in text or "Steering" in text or "skipped" in text for text in rig.peer.texts)


def test_a_waypoint_on_an_island_is_waited_for_then_skipped() -> None:
    rig = Rig("open", ROCKY, config={**BY_SIGHT, "avoidance.retry_s": 5.0})
    rig.sail(waypoint(0.0, 20.0), waypoint(0.0, 36.0), waypoint(20.0, 36.0))
    told(rig, "No way to item 2 round what was seen: waiting", 220.0)
    told(rig, "No way to item 2: skipped", 60.0)
    assert over(rig, 90.0) == [1, 3]
    assert rig.world.groundings == 0
    assert not any("otor" in text or "Steering" in text for text in rig.peer.texts)


def test_smart_rtl_rounds_what_has_come_onto_the_track() -> None:
    rig = Rig("open", ISLAND, "boat.start=[60, 0]", config=BY_SIGHT).ready()
    armed(Mode.LOITER, rig=rig)
    track, nav = rig.boat.vehicle.track, rig.boat.vehicle.nav
    assert nav is not None
    track.points = [Point(nav.north_m, nav.east_m - off_m) for off_m in (60.0, 50.0, 1.0)]
    assert rig.set_mode(Mode.SMART_RTL) == OK
    rig.until(lambda: rig.offset_m(0.0, 0.0) < 3.0, 130.0)
    assert rig.world.groundings == 0
    assert not any("otor" in text or "Steering" in text for text in rig.peer.texts)
