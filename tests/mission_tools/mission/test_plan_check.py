"""The plan linter: one finding for one fault, none for a good plan."""

from dataclasses import replace

import pytest
import shapely

from companion.core.geo import LatLon, LocalFrame, Point
from mission_tools.assembly.check import check_mission
from mission_tools.maps import Feature, build_chart
from mission_tools.mission.mission import Command, Frame, Mission, MissionItem
from mission_tools.mission.route import mission_along

FRAME = LocalFrame(LatLon(50.0, -1.2))
LAKE = build_chart(
    "Test Lake",
    FRAME,
    shapely.box(0.0, 0.0, 100.0, 100.0),
    [Feature("Goose Island", "island", shapely.box(40.0, 40.0, 60.0, 60.0))],
)


def at(east_m: float, north_m: float) -> LatLon:
    return FRAME.to_global(Point(north_m, east_m))


GOOD = mission_along([at(20, 20), at(20, 80), at(80, 80)], speed_m_s=1.0)


def texts(mission: Mission, clearance_m: float = 5.0) -> list[str]:
    return [str(finding) for finding in check_mission(mission, LAKE, clearance_m)]


def test_a_good_mission_has_no_findings() -> None:
    assert texts(GOOD) == []
    assert check_mission(GOOD) == []


@pytest.mark.parametrize(
    ("item", "said"),
    [
        (MissionItem(22), "MAV_CMD 22 is not something a boat can do"),
        (MissionItem.at(at(80, 80), frame=1), "frame 1 is not one"),
        (MissionItem.at(at(80, 20), frame=Frame.GLOBAL_TERRAIN_ALT), "frame 10 is not one"),
        (MissionItem(Command.NAV_WAYPOINT, Frame.MISSION, x=5, y=5), "its place would be ignored"),
        (MissionItem(Command.NAV_WAYPOINT), "the place was never set"),
        (
            MissionItem(Command.DO_JUMP, Frame.MISSION, (9.0, 1.0, 0.0, 0.0)),
            "DO_JUMP to item 9, which does not",
        ),
        (
            MissionItem(Command.DO_CHANGE_SPEED, Frame.MISSION, (1.0, 0.0, -1.0, 0.0)),
            "DO_CHANGE_SPEED to 0 m/s",
        ),
        (MissionItem.at(at(80, 20), params=(-3.0, 0.0, 0.0, 0.0)), "a wait of -3 s is negative"),
        (MissionItem.at(at(80, 80)), "the same place as the waypoint before it"),
        (MissionItem.at(LatLon(51.0, -1.2)), "more than 50 km from the point before it"),
        (MissionItem.at(LatLon(-40.0, 170.0)), "more than 50 km from the point before it"),
    ],
)
def test_one_bad_item_gives_one_finding_that_names_it(item: MissionItem, said: str) -> None:
    findings = check_mission(replace(GOOD, items=(*GOOD.items, item)))
    assert len(findings) == 1
    assert findings[0].item == 4
    assert said in findings[0].text


@pytest.mark.parametrize("home", [None, LatLon(0.0, 0.0)])
def test_a_missing_home_is_found(home: LatLon | None) -> None:
    assert texts(replace(GOOD, home=home)) == ["no home: set the planned home position"]


def test_a_mission_without_waypoints_is_found() -> None:
    assert texts(replace(GOOD, items=())) == ["no waypoint: the boat would go nowhere"]


@pytest.mark.parametrize(
    ("places", "said"),
    [
        ([at(20, 20), at(80, 80)], "item 1: the leg to it crosses land or a keep-out area: Goose Island"),
        ([at(20, 20), at(20, 80), at(50, 50)], "item 2: lies on Goose Island"),
        ([at(20, 20), at(20, 80), at(20, 130)], "item 2: lies outside the map"),
        (
            [at(20, 20), at(20, 80), at(2, 80)],
            "item 2: the leg to it passes the shore at 2.00 m, nearer than 5 m",
        ),
        ([at(20, 20), at(20, 63), at(80, 63)], "item 2: the leg to it passes Goose Island at 3.00 m"),
    ],
)
def test_a_leg_over_land_or_too_near_names_what_is_in_the_way(places: list[LatLon], said: str) -> None:
    found = texts(mission_along(places))
    assert len(found) == 1
    assert found[0].startswith(said)


def test_the_first_leg_may_leave_a_jetty_that_is_nearer_than_the_clearance() -> None:
    assert texts(mission_along([at(2, 20), at(20, 20)])) == []
    assert len(texts(mission_along([at(20, 20), at(2, 20)]))) == 1


def test_a_small_clearance_is_asked_for_too() -> None:
    way = mission_along([at(20, 20), at(0.3, 50), at(0.3, 80)])
    assert texts(way, clearance_m=0.2) == []
    assert len(texts(way, clearance_m=0.5)) == 2
