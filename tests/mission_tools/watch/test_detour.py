"""What is left of a mission is led round what was seen, and keeps everything else."""

from itertools import pairwise

import pytest
import shapely

from companion.core.geo import LatLon, LocalFrame, Point
from companion.planning.water import Shore, Water
from mission_tools.errors import NoRoute
from mission_tools.maps.chart import build_chart
from mission_tools.mission.mission import Command, Frame, MissionItem
from mission_tools.watch.detour import SIGHTED_CLEARANCE_M, around, is_blocked, remainder_of

FRAME = LocalFrame(LatLon(50.0, 10.0))
BOUNDS = (-30.0, -30.0, 130.0, 30.0)
CHART = build_chart("pond", FRAME, shapely.box(*BOUNDS), [])
WATER = Water([Shore([Point(-30, -30), Point(-30, 130), Point(30, 130), Point(30, -30)])])
HERE = Point(0.0, 0.0)
SPEED = MissionItem(Command.DO_CHANGE_SPEED, Frame.MISSION, (1.0, 0.7, -1.0, 0.0))
YAW = MissionItem(Command.CONDITION_YAW, Frame.MISSION, (90.0, 0.0, 0.0, 0.0))


def waypoint(north_m: float, east_m: float, hold_s: float = 0.0) -> MissionItem:
    return MissionItem.at(FRAME.to_global(Point(north_m, east_m)), params=(hold_s, 0.0, 0.0, 0.0))


def led_round(items: list[MissionItem], seen: shapely.Polygon, current: int = 0) -> list[MissionItem]:
    left = remainder_of(items, CHART, current)
    assert is_blocked(HERE, left, seen)
    mission, inserted = around(CHART, WATER, HERE, left, seen, 3.0)
    path = [HERE, *(FRAME.to_local(place) for place in mission.places)]
    for a, b in pairwise(path):
        leg = shapely.LineString([(a.east_m, a.north_m), (b.east_m, b.north_m)])
        assert seen.distance(leg) >= SIGHTED_CLEARANCE_M - 0.02  # 1e-7 degrees
        assert WATER.leg_distance_m(a, b) > 2.98
    assert [item for n, item in enumerate(mission.items) if n not in inserted] == [
        item for item in left.items if item in mission.items
    ]
    return list(mission.items)


def test_only_the_blocked_leg_changes() -> None:
    items = [waypoint(0, 40), YAW, waypoint(0, 80, hold_s=30.0), waypoint(10, 110)]
    found = led_round(items, shapely.box(58, -2, 62, 2))
    assert found[:2] == items[:2]
    assert found[-2:] == items[-2:]
    assert len(found) > len(items)


def test_a_waypoint_under_the_obstacle_is_left_out_and_its_commands_stay() -> None:
    items = [SPEED, waypoint(0, 40), YAW, waypoint(0, 80)]
    found = led_round(items, shapely.box(38, -3, 42, 3))
    assert items[1] not in found
    assert [found[0], found[-2], found[-1]] == [SPEED, YAW, items[-1]]


def test_the_speed_that_was_set_before_still_holds() -> None:
    items = [YAW, SPEED, waypoint(0, -20), waypoint(0, 60)]
    assert led_round(items, shapely.box(28, -2, 32, 2), current=3)[0] == SPEED
    slower = MissionItem(Command.DO_CHANGE_SPEED, Frame.MISSION, (1.0, 0.3, -1.0, 0.0))
    assert remainder_of([slower, *items], CHART, 4).items == (SPEED, items[-1])


def test_what_lies_beside_the_way_blocks_nothing() -> None:
    left = remainder_of([waypoint(0, 60)], CHART, 0)
    assert not is_blocked(HERE, left, shapely.box(28, 2.1, 32, 5))
    assert is_blocked(HERE, left, shapely.box(28, 1.9, 32, 5))
    assert not is_blocked(HERE, left, shapely.Polygon())
    assert not is_blocked(HERE, left, shapely.box(-5, -1, -1, 1))  # the leg leads away from it


def test_a_boat_that_is_too_near_leaves_by_the_shortest_way() -> None:
    seen = shapely.box(1.2, -2, 4, 2)
    left = remainder_of([waypoint(0, 60)], CHART, 0)
    mission, inserted = around(CHART, WATER, HERE, left, seen, 3.0)
    first = FRAME.to_local(mission.places[0])
    assert seen.distance(shapely.Point(first.east_m, first.north_m)) >= SIGHTED_CLEARANCE_M - 0.02
    assert first.east_m < 0.0
    assert 0 in inserted


@pytest.mark.parametrize(
    ("seen", "message"),
    [
        (shapely.box(58, -3, 62, 3), "lies on the last waypoint"),
        (shapely.box(28, -40, 32, 40), "no water is left"),
    ],
)
def test_where_nothing_leads_on_it_says_so(seen: shapely.Polygon, message: str) -> None:
    with pytest.raises(NoRoute, match=message):
        around(CHART, WATER, HERE, remainder_of([waypoint(0, 60)], CHART, 0), seen, 3.0)


def test_a_mission_that_jumps_is_not_planned_anew() -> None:
    jump = MissionItem(Command.DO_JUMP, Frame.MISSION, (1.0, 2.0, 0.0, 0.0))
    with pytest.raises(NoRoute, match="DO_JUMP"):
        remainder_of([waypoint(0, 60), jump], CHART, 0)
