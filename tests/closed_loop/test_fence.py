"""The fence on ground truth: the boat stops before it, comes back inside, and sails round its corners."""

import math

import pytest
from boat_rig import Rig, waypoint
from fence_rig import EXCLUDED, L_CORNERS, box, fenced, least_margin_m, margin_m, polygon
from sailing_rig import CURRENT, VELOCITY, aim, armed, sail_to, tells, told

from companion.core.geo import LatLon
from companion.core.modes import Mode
from companion.core.units import deg_to_e7
from companion.mavlink.dialect import dialect
from companion.mavlink.items import MissionItem, MissionType
from companion.mavlink.transfer import Completed
from mission_tools.assembly.areas import open_areas
from mission_tools.assembly.open_source import open_source
from mission_tools.assembly.plan_options import PlanOptions

ONTO_IT = ("environment.current_m_s=0.5", "environment.current_to_deg=0.0")
ROUND = "The way to the mission leads round the shore"
POND = "examples/maps/mill_pond_fence.geojson"
BEHIND_THE_ISLANDS = LatLon(50.00095, -1.19757)


def test_a_boat_told_to_sail_at_the_line_stops_inside() -> None:
    rig = armed(Mode.GUIDED, rig=fenced(Rig("open", *ONTO_IT), *polygon(box(-20.0, -100.0, 20.0, 100.0))))
    least, course = math.inf, math.radians(40.0)
    for _ in range(24):
        aim(rig, VELOCITY, velocity=(2.0 * math.cos(course), 2.0 * math.sin(course)))
        least = min(least, least_margin_m(rig, 1.0))
    assert 0.3 < least < 4.0
    assert "Fence ahead: keeping station" in rig.peer.texts


def test_rtl_follows_the_water_round_the_corner_in_a_current() -> None:
    water = ("environment.current_to_deg=225.0", "environment.current_m_s=0.5")
    rig = armed(Mode.GUIDED, rig=fenced(Rig("open", *water), *polygon(L_CORNERS)))
    sail_to(rig, 0.0, 60.0)
    sail_to(rig, 60.0, 60.0)
    assert rig.set_mode(Mode.RTL) == 0
    began_s, least = rig.now_s, math.inf
    while not tells(rig, "RTL: arrived"):
        least = min(least, least_margin_m(rig, 1.0))
        assert rig.now_s - began_s < 75.0  # 99 m of water at 2 m/s, two stops and a corner
    assert least > 1.5
    rig.run(15.0)
    assert rig.offset_m(0.0, 0.0) < 3.5


@pytest.mark.parametrize(("action", "water"), [(1, ONTO_IT), (6, CURRENT)], ids=["RTL", "LOITER"])
def test_a_boat_beyond_the_fence_comes_back(action: int, water: tuple[str, ...]) -> None:
    rig = armed(Mode.GUIDED, *water, config={"failsafe.fence_action": action})
    sail_to(rig, 18.0, 0.0, within_m=3.0)
    fenced(rig, *polygon(box(-15.0, -20.0, 10.0, 20.0)))
    rig.run(3.0)  # FENCE_STATUS comes every two seconds
    assert rig.mode == ("RTL" if action == 1 else "LOITER")
    assert tells(rig, "Failsafe: Outside the fence by ")
    assert rig.peer.said("FENCE_STATUS")[-1].breach_status == 1
    geofence = dialect.MAV_SYS_STATUS_GEOFENCE
    assert not rig.peer.said("SYS_STATUS")[-1].onboard_control_sensors_health & geofence
    told(rig, "Failsafe over: inside the fence again", 40.0)
    rig.run(20.0)
    assert least_margin_m(rig, 10.0) > 1.0
    assert (rig.offset_m(0.0, 0.0) < 4.0) if action == 1 else (rig.world.truth.north_m > 3.0)
    status = rig.peer.said("FENCE_STATUS")[-1]
    assert (status.breach_status, status.breach_count) == (0, 1)
    assert rig.peer.said("SYS_STATUS")[-1].onboard_control_sensors_health & geofence


def sail_out(rig: Rig, limit_s: float) -> float:
    """To the end of the mission; how near the fence the boat came."""
    began_s, least = rig.now_s, math.inf
    while rig.mode == "AUTO":
        rig.run(0.2)
        least = min(least, margin_m(rig))
        assert rig.now_s - began_s < limit_s
    return least


def test_a_boat_set_off_its_plan_keeps_clear_of_an_islet_beside_it() -> None:
    rig = Rig("open", "environment.current_m_s=0.8", "environment.current_to_deg=0.0").ready()
    fenced(rig, *polygon(box(-60.0, -60.0, 120.0, 120.0)), *polygon(box(5.0, 18.0, 15.0, 30.0), EXCLUDED))
    rig.run(5.0)  # the straight way from here leads over it
    rig.sail(waypoint(10.0, 50.0), waypoint(20.0, 50.0))
    assert sail_out(rig, 120.0) > 2.0
    assert ROUND in rig.peer.texts
    assert [message.seq for message in rig.peer.said("MISSION_ITEM_REACHED")] == [1, 2]


def test_the_boat_comes_home_from_behind_the_islands_without_a_detour() -> None:
    lake = Rig("lake").scenario
    home = lake.frame.to_local(BEHIND_THE_ISLANDS)
    start = home.towards(lake.start, 0.4)
    rig = Rig("lake", f"route.start=[{start.east_m}, {start.north_m}]").ready()
    planned = open_source("lake", PlanOptions(goal=BEHIND_THE_ISLANDS), open_areas(POND, None)).prepare()
    fence = [
        MissionItem(one.frame, one.command, 0, 1, *one.params, x=one.x, y=one.y, z=one.z)
        for name, items in planned.mission.wire_lists(home_first=True).items()
        for one in items
        if name.name == "FENCE"
    ]
    assert isinstance(rig.upload(fence, mission_type=MissionType.FENCE), Completed)
    x, y = deg_to_e7(BEHIND_THE_ISLANDS.lat_deg), deg_to_e7(BEHIND_THE_ISLANDS.lon_deg)
    rig.peer.command_int(dialect.MAV_CMD_DO_SET_HOME, x=x, y=y)
    armed(Mode.RTL, rig=rig)
    rig.until(lambda: rig.offset_m(*home) < 3.0, 115.0)  # 180 m in a straight line
    assert sum(text.startswith("Obstacle") for text in rig.peer.texts) <= 4
