"""Tours and stations: order, return, holds, and stops that cannot be reached."""

import pytest
import shapely
from task_waters import FRAME, basin, route_line

from companion.core.geo import Point
from mission_tools.errors import GoalBlocked, NoRoute, UsageError
from mission_tools.mission.mission import Command
from mission_tools.planning.planner import PlanSettings
from mission_tools.tasks.task_route import Stop, TaskLeg, joined, mission_of
from mission_tools.tasks.tour import tour

SETTINGS = PlanSettings(clearance_m=4.0)
START = Point(50.0, 10.0)
FAR, NEAR, MIDDLE = (
    Stop(Point(50.0, 190.0), 30.0, "far"),
    Stop(Point(50.0, 40.0)),
    Stop(Point(50.0, 90.0), 10.5),
)


def test_any_order_is_the_shortest() -> None:
    found = tour(basin(), START, [FAR, NEAR, MIDDLE], SETTINGS, any_order=True)
    assert found.points == (START, NEAR.place, MIDDLE.place, FAR.place)
    assert found.hold_s == pytest.approx(40.5)


def test_a_return_ends_at_the_start_also_from_a_jetty() -> None:
    jetty = Point(50.0, 1.0)
    found = tour(basin(), jetty, [NEAR, FAR], SETTINGS, is_return=True)
    assert found.points[0] == found.points[-1] == jetty


def test_the_order_follows_the_routes_and_not_the_straight_lines() -> None:
    """A wall from the south shore makes the place behind it the farther one."""
    wall = shapely.box(98.0, 0.0, 102.0, 80.0)
    start, behind, north = Point(10.0, 90.0), Stop(Point(10.0, 110.0)), Stop(Point(90.0, 90.0))
    found = tour(basin(wall), start, [behind, north], SETTINGS, any_order=True)
    visited = [point for point in found.points if point in (behind.place, north.place)]
    assert visited == [north.place, behind.place]
    assert route_line(found.points).distance(wall) >= 4.0 - 0.01


def test_every_stop_that_cannot_be_reached_is_named() -> None:
    island = shapely.box(60.0, 40.0, 80.0, 60.0)
    stops = [NEAR, Stop(Point(50.0, 70.0), name="buoy"), Stop(Point(150.0, 50.0))]
    with pytest.raises(NoRoute, match=r"2 of 3 stops.*buoy:.*island 1.*stop 3:.*outside"):
        tour(basin(island), START, stops, SETTINGS)
    with pytest.raises(GoalBlocked, match="island 1"):
        tour(basin(island), START, stops[:2], SETTINGS)


def test_a_tour_needs_a_stop_and_a_possible_hold_time() -> None:
    with pytest.raises(UsageError, match="at least one place"):
        tour(basin(), START, [], SETTINGS)
    with pytest.raises(UsageError, match="hold time is -1 s"):
        Stop(START, hold_s=-1.0)


def test_a_hold_is_the_first_parameter_of_its_waypoint_in_whole_seconds() -> None:
    found = tour(basin(), START, [NEAR, MIDDLE, FAR], SETTINGS)
    mission = mission_of(found, FRAME, speed_m_s=1.5)
    waypoints = [item for item in mission.items if item.command == Command.NAV_WAYPOINT]
    assert [item.params[0] for item in waypoints] == [0.0, 11.0, 30.0]
    assert mission.home is not None
    assert FRAME.to_local(mission.home).east_m == pytest.approx(10.0, abs=0.02)
    assert mission.speed_m_s == 1.5


def test_a_route_keeps_every_corner_of_a_closed_leg() -> None:
    """The last point of a round is where it began: it is left out only where the boat has not moved."""
    corners = (Point(0.0, 0.0), Point(0.0, 9.0), Point(9.0, 9.0), Point(0.0, 0.0))
    found = joined([TaskLeg("transit", (START, corners[0])), TaskLeg("shore", corners)])
    assert found.points == (START, *corners)
    assert found.length_m == pytest.approx(route_line(found.points).length)
