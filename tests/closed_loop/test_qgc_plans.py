"""Plans and buttons of QGroundControl 4.4 for a rover, as it sends them."""

import math

from boat_rig import HOME_ITEM, OK, Rig, waypoint
from sailing_rig import do, reached

from companion.mavlink.dialect import dialect
from companion.mavlink.items import MissionItem, MissionType
from companion.mavlink.transfer import Completed
from companion.vehicle.mission.steps import Skip

NAN = math.nan


def trigger(distance_m: float) -> MissionItem:
    """DO_SET_CAM_TRIGG_DIST at either end of a track; "take one now" where it starts."""
    first = 1.0 if distance_m else 0.0
    return MissionItem(frame=2, command=206, param1=distance_m, param3=first)


# Create Plan > Survey: takeoff (an altitude alone: no position), two tracks, return
SURVEY = [
    HOME_ITEM,
    MissionItem(frame=3, command=22, param1=15.0, param4=NAN, z=50.0),
    waypoint(10.0, 0.0),
    trigger(25.0),
    waypoint(25.0, 0.0),
    trigger(0.0),
    waypoint(25.0, 8.0),
    trigger(25.0),
    waypoint(10.0, 8.0),
    trigger(0.0),
    MissionItem(frame=2, command=20),
]
RING = [
    waypoint(north, east, command=5001, param1=3.0)
    for north, east in ((-90.0, -90.0), (-90.0, 150.0), (150.0, 0.0))
]

RALLY = [waypoint(5.0, 5.0, command=5100)]


def spoken(rig: Rig, word: str) -> list[str]:
    return [text for text in rig.peer.texts if word in text]


def test_the_survey_template_is_taken_and_sailed_to_its_return() -> None:
    rig = Rig().ready()
    rig.upload(RING, mission_type=MissionType.FENCE)
    rig.upload(RALLY, mission_type=MissionType.RALLY)
    assert isinstance(rig.upload(SURVEY), Completed)
    for kind in (MissionType.FENCE, MissionType.RALLY):  # the same press of Upload
        assert isinstance(rig.upload([], mission_type=kind), Completed)
    (ignored,) = spoken(rig, "ignored")
    assert ignored == "Mission: item 1, command 22 (NAV_TAKEOFF), is ignored, and 4 more"
    assert rig.items() == tuple(SURVEY)
    assert rig.boat.vehicle.progress.mission[1] == Skip()
    assert rig.boat.vehicle.progress.last_seq == len(SURVEY) - 1
    assert rig.arm() == OK
    assert rig.ask(dialect.MAV_CMD_MISSION_START) == OK
    rig.until(lambda: rig.mode == "RTL", 200.0)
    assert reached(rig) == [2, 4, 6, 8]
    rig.until(lambda: bool(spoken(rig, "Mission complete")), 100.0)
    assert rig.offset_m(0.0, 0.0) < 4.0


def test_a_new_plan_says_once_that_fence_and_rally_points_are_gone_and_nothing_where_none_were() -> None:
    rig = Rig().ready()
    for lists in ([], RALLY):
        rig.upload(RING if lists else [], mission_type=MissionType.FENCE)
        rig.upload(lists, mission_type=MissionType.RALLY)
        for _ in range(2):
            for kind in (MissionType.FENCE, MissionType.RALLY):
                assert isinstance(rig.upload([], mission_type=kind), Completed)
        if not lists:
            rig.reboot()
            rig.run(2.0)
            assert spoken(rig, "removed") == []
    assert spoken(rig, "removed") == ["Fence removed", "Rally points removed"]


def test_a_spline_is_sailed_as_a_waypoint_with_a_warning() -> None:
    rig = Rig().ready()
    rig.upload([HOME_ITEM, waypoint(12.0, 0.0, command=82), waypoint(12.0, 12.0, command=82, param1=2.0)])
    (warned,) = spoken(rig, "curve")
    what = "is sailed without its curve, and 1 more"
    assert warned == f"Mission: item 1, command 82 (NAV_SPLINE_WAYPOINT), {what}"
    assert rig.arm() == OK
    assert rig.ask(dialect.MAV_CMD_MISSION_START) == OK
    rig.until(lambda: rig.mode != "AUTO", 100.0)
    assert reached(rig) == [1, 2]


def test_a_mission_switches_the_fence_off_and_on_again() -> None:
    rig = Rig().ready()
    rig.upload(RING, mission_type=MissionType.FENCE)
    first, second, third = waypoint(15.0, 0.0), waypoint(30.0, 0.0), waypoint(30.0, 15.0)
    rig.sail(first, do(207, 0.0), second, do(207, 2.0), do(207, 1.0), third)
    fence = rig.boat.vehicle.fence
    assert fence.is_active
    rig.until(lambda: not fence.is_active, 60.0)
    assert reached(rig) == [1]
    rig.until(lambda: fence.is_active, 60.0)
    assert reached(rig) == [1, 3]
    assert spoken(rig, "by the mission") == ["Fence disabled by the mission", "Fence enabled by the mission"]
