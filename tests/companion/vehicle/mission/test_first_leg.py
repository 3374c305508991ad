"""Whether the straight line from the boat to its first waypoint is open: by distances from the shore."""

import pytest
from boat_rig import FRAME, nav_at, place

from companion.config.boat_config import BoatConfig
from companion.config.fence import FenceSetting
from companion.core.geo import Point
from companion.core.intent import FollowLeg, HoldCourse, KeepStation
from companion.geofence.fence import Fence, FenceArea, FenceCircle, FencePolygon
from companion.vehicle.mission.progress import MissionProgress
from companion.vehicle.mission.route_to_mission import RouteToMission
from companion.vehicle.mission.steps import Home, SetSpeed, Waypoint
from companion.vehicle.return_route import ReturnRoute

CONFIG = BoatConfig()
SQUARE = FencePolygon(tuple(place(n, e) for n, e in ((-50, -50), (-50, 50), (50, 50), (50, -50))), True)
ISLAND = FenceCircle(place(0.0, 20.0), 5.0, is_inclusion=False)


def is_open(here: tuple[float, float], end: tuple[float, float], *areas: FenceArea) -> bool:
    """Whether the mission's own leg is sailed, with the water not indexed as yet."""
    fence, nav = Fence(), nav_at(*here)
    fence.set_areas([SQUARE, *areas])
    fence.update(FRAME, None, FenceSetting())
    route = ReturnRoute(fence, [])
    progress = MissionProgress()
    progress.replace((Home(), SetSpeed(1.0), Waypoint(place(*end))))
    wanted = progress.update(nav, FRAME, CONFIG, 0.0)
    assert isinstance(wanted, FollowLeg)
    sailed = RouteToMission(fence, route, []).update(wanted, progress, nav, CONFIG)
    assert sailed is wanted or sailed == KeepStation(Point(*here))
    return sailed is wanted


@pytest.mark.parametrize("turn", range(4))
@pytest.mark.parametrize(
    ("here", "end", "expected"),
    [
        ((0.0, -40.0), (0.0, 10.0), True),
        ((0.0, -40.0), (0.0, 40.0), False),  # over the island
        ((8.1, -40.0), (8.1, 40.0), True),  # 3.1 m from it
        ((7.7, -40.0), (7.7, 40.0), False),  # 2.7 m from it: less than 0.95 of the clearance
        ((6.5, -49.5), (6.5, 40.0), False),  # a berth may be left, but the island is as far off as ever
        ((8.1, -49.5), (8.1, 40.0), True),
        ((-49.5, -20.0), (40.0, -20.0), True),  # straight out of a berth
        ((-49.5, -20.0), (-20.0, 10.0), True),
        ((-49.0, -46.0), (-49.0, -49.0), True),  # from berth to berth, in a corner
        ((-49.0, 10.0), (-49.0, 14.0), True),
    ],
)
def test_the_straight_line_is_open_where_it_keeps_the_clearance_once_the_berth_is_left(
    turn: int, here: tuple[float, float], end: tuple[float, float], expected: bool
) -> None:
    centre = (0.0, 20.0)
    for _ in range(turn):
        here, end, centre = (-here[1], here[0]), (-end[1], end[0]), (-centre[1], centre[0])
    island = FenceCircle(place(*centre), 5.0, is_inclusion=False)
    assert is_open(here, end, island) is expected


def test_what_is_no_leg_or_does_not_begin_at_the_boat_is_left_as_it_is() -> None:
    fence = Fence()
    fence.set_areas([SQUARE, ISLAND])
    fence.update(FRAME, None, FenceSetting())
    route, progress = RouteToMission(fence, ReturnRoute(fence, []), []), MissionProgress()
    station, nav = KeepStation(Point(1.0, 2.0)), nav_at(0.0, -40.0)
    assert route.update(station, progress, nav, CONFIG) is station
    progress.replace((Home(), Waypoint(place(0.0, 40.0))))
    leg = progress.update(nav, FRAME, CONFIG, 0.0)
    assert route.update(leg, progress, nav, CONFIG) == KeepStation(nav.point)
    course = HoldCourse(0.0, 1.0)
    assert route.update(course, progress, nav, CONFIG) is course
    progress.begin_leg_at(Point(0.0, -40.0))
    leg = progress.update(nav, FRAME, CONFIG, 0.0)
    assert route.update(leg, progress, nav, CONFIG) is leg
