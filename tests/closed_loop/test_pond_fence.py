"""The fence of the first steps, sailed in: home by water, round the islands."""

from pathlib import Path

from boat_rig import OK, Rig

from companion.core.geo import LatLon
from companion.mavlink.dialect import dialect
from companion.mavlink.items import MissionItem, MissionType
from companion.mavlink.transfer import Completed
from mission_tools.assembly.areas import open_areas
from mission_tools.assembly.plan_options import PlanOptions
from mission_tools.assembly.planned_mission import open_source
from mission_tools.mission.mission import MissionType as ListName

FENCE = str(Path(__file__).parents[2] / "examples" / "maps" / "mill_pond_fence.geojson")
BEHIND_THE_ISLANDS = LatLon(50.00095, -1.19757)
RTL = 11


def test_the_boat_comes_home_from_behind_the_islands_without_a_detour() -> None:
    rig = Rig("lake").ready()
    areas = open_areas(FENCE, None)
    planned = open_source("lake", PlanOptions(goal=BEHIND_THE_ISLANDS), areas).prepare()
    for name, items in planned.mission.wire_lists(home_first=True).items():
        wire = [
            MissionItem(one.frame, one.command, 0, 1, *one.params, x=one.x, y=one.y, z=one.z) for one in items
        ]
        kind = {ListName.MISSION: MissionType.MISSION, ListName.FENCE: MissionType.FENCE}[name]
        assert isinstance(rig.upload(wire, mission_type=kind), Completed)
    assert rig.arm() == OK
    assert rig.ask(dialect.MAV_CMD_MISSION_START) == OK
    place = rig.scenario.frame.to_local(BEHIND_THE_ISLANDS)
    rig.until(lambda: rig.offset_m(place.north_m, place.east_m) < 3.0, 400.0)
    home = rig.scenario.start
    rig.peer.forget()
    assert rig.set_mode(RTL) == OK
    took_s = rig.until(lambda: rig.offset_m(home.north_m, home.east_m) < 3.0, 400.0)
    assert took_s < 260.0
    assert sum(text.startswith("Obstacle") for text in rig.peer.texts) <= 4
