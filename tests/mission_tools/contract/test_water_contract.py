"""Fence and rally points from the map of a route: never over land, with room, within the boat's boat.

The fence is read as the boat reads it (`companion.geofence.fence`), and laid on the map with shapely.
"""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest
import shapely
from data_files import SHORES
from shapely.geometry import LineString, Polygon

import mission_tools as mt
from companion.config.tuning import FenceSetting
from companion.core.geo import LatLon, LocalFrame, Point, distance_m
from companion.geofence import fence as aboard
from companion.mavlink.items import MissionItem
from mission_tools.assembly.map_source import MapSource
from mission_tools.assembly.open_source import MissionFile
from mission_tools.assembly.plan_options import PlanOptions
from mission_tools.assembly.planned_mission import PlannedMission
from mission_tools.contract.water_contract import fence_lines, fence_of_water, rally_points, with_contract
from mission_tools.costs.boat import Boat, load_boat
from mission_tools.errors import NoRoute, UsageError
from mission_tools.maps import Source, build_chart
from mission_tools.maps.chart import Chart
from mission_tools.mission.mission import Fence
from sitl.courses.missions import wire_items
from sitl.run.mission_run import MissionRun
from sitl.scenarios.scenario import load_scenario

pytestmark = pytest.mark.slow

BOAT = load_boat(None)


def boats_fence(fence: Fence, frame: LocalFrame) -> aboard.Fence:
    """The fence as the boat has it after an upload."""
    found = aboard.Fence()
    found.set_areas([aboard.FencePolygon(polygon.corners, polygon.inclusion) for polygon in fence.polygons])
    found.update(frame, None, FenceSetting())
    return found


def fence_area(chart: Chart, fence: Fence) -> Polygon:
    rings = [
        [(at.east_m, at.north_m) for at in map(chart.frame.to_local, polygon.corners)]
        for polygon in fence.polygons
    ]
    return Polygon(rings[0], rings[1:])


def assert_holds(planned: PlannedMission, boat: Boat, at_least_m: float) -> None:
    """The fence's rules, each by somebody else's arithmetic."""
    chart, fence = planned.chart, planned.mission.fence
    assert [polygon.inclusion for polygon in fence.polygons] == [True] + [False] * (len(fence.polygons) - 1)
    assert len(fence.items()) <= boat.most_fence_items
    area = fence_area(chart, fence)
    assert area.is_valid
    assert area.difference(chart.navigable).area == 0.0  # admits no land
    on_board = boats_fence(fence, chart.frame)
    points = planned.points
    assert all(on_board.allows(point) for point in points)
    assert not any(on_board.crosses(a, b) for a, b in pairwise(points))
    assert all(on_board.is_clear(a, b, at_least_m) for a, b in pairwise(points))


@pytest.mark.parametrize("corners", [1000, 200, 60])
def test_the_fence_of_a_lake_holds_the_route_and_no_land_in_as_few_corners_as_are_asked_for(
    corners: int,
) -> None:
    boat = replace(BOAT, most_fence_items=corners)
    planned = with_contract(mt.open_map("lake").route().planned, boat)
    assert_holds(planned, boat, 2.0)
    assert "fence: " in planned.notes[-2]


@pytest.mark.parametrize(
    ("name", "start", "goal"),
    [
        ("lake_squam_nh.geojson", (43.7340, -71.5450), (43.7640, -71.5250)),
        ("pond_two_islands_nh.geojson", None, None),
        ("harbour_boston_ma.geojson", None, None),
    ],
)
@pytest.mark.parametrize("corners", [1000, 120])
def test_the_fences_of_real_waters_hold_their_routes(
    name: str, start: mt.LatLon | None, goal: mt.LatLon | None, corners: int
) -> None:
    water = mt.open_map(SHORES / name)
    if start is None:
        chart = water.source.chart
        pieces = chart.navigable.buffer(-12.0)
        piece = max(shapely.get_parts(pieces), key=lambda part: part.area)
        west, south, east, north = piece.bounds
        ends = [
            shapely.shortest_line(piece, shapely.Point(*corner)).coords[0]
            for corner in ((west, south), (0.5 * (west + east), 0.5 * (south + north)))
        ]
        start, goal = (chart.frame.to_global(Point(north_m, east_m)) for east_m, north_m in ends)
    boat = replace(BOAT, most_fence_items=corners)
    planned = with_contract(water.route(start, goal, clearance_m=6.0).planned, boat)
    assert_holds(planned, boat, 2.0)


def test_rally_points_are_afloat_inside_the_fence_reachable_and_apart() -> None:
    water = mt.open_map("lake")
    planned = with_contract(water.route().planned, BOAT)
    chart, rally = planned.chart, planned.mission.rally
    assert len(rally) == 2
    lines = fence_lines(chart, planned.mission.fence)
    line = LineString([(point.east_m, point.north_m) for point in planned.points])
    on_board = boats_fence(planned.mission.fence, chart.frame)
    places = [chart.frame.to_local(point.place) for point in rally]
    for place, point in zip(places, rally, strict=True):
        assert chart.clearance_m(place) >= planned.clearance_m
        assert on_board.allows(place)
        at = shapely.Point(place.east_m, place.north_m)
        assert lines.distance(at) >= 0.99 * planned.clearance_m
        assert line.distance(at) <= 10.0 * planned.clearance_m + 0.1
        assert water.route(chart.frame.to_global(planned.points[0]), point.place).length_m > 0.0
    assert distance_m(*places) > 100.0


def test_a_rally_point_lies_abeam_of_the_middle_of_its_stretch_where_there_is_room() -> None:
    """The route runs 5 m off the southern bank: 10 m farther out there is three times the clearance."""
    chart = build_chart("canal", LocalFrame(LatLon(50.0, 10.0)), shapely.box(0.0, 0.0, 1000.0, 60.0), ())
    for route in ([Point(5.0, 50.0), Point(5.0, 950.0)], [Point(5.0, 950.0), Point(5.0, 50.0)]):
        found = [chart.frame.to_local(rally.place) for rally in rally_points(chart, route, 4.0, 3)]
        assert [at.north_m for at in found] == pytest.approx([15.0] * 3, abs=0.1)
        assert sorted(at.east_m for at in found) == pytest.approx([200.0, 500.0, 800.0], abs=4.0)
    assert len(rally_points(chart, [Point(5.0, 50.0), Point(5.0, 250.0)], 4.0, 3)) == 1
    (near,) = rally_points(chart, [Point(30.0, 50.0), Point(30.0, 58.0)], 4.0, 3)
    assert distance_m(chart.frame.to_local(near.place), Point(30.0, 50.0)) >= 2.0 * 4.0 - 0.02


def test_as_many_rally_points_as_the_boat_holds() -> None:
    planned = mt.open_map("lake").route().planned
    assert len(with_contract(planned, replace(BOAT, most_rally_items=1)).mission.rally) == 1
    without = with_contract(planned, BOAT, with_rally=False)
    assert (without.mission.rally, len(without.mission.fence.polygons) > 0) == ((), True)


def test_a_long_route_has_ten_rally_points_and_no_more() -> None:
    planned = mt.open_map("open").route((50.0, -1.2), (50.05, -1.2)).planned
    assert len(with_contract(planned, BOAT, with_fence=False).mission.rally) == 10


def test_open_water_has_a_fence_round_the_route() -> None:
    planned = mt.open_map("open").route((50.0, -1.2), (50.002, -1.2)).planned
    fence, near_m = fence_of_water(planned.chart, planned.points, 4.0, 2.0, 100)
    assert len(fence.polygons) == 1
    assert 150.0 < near_m <= 200.0


def test_a_fence_lies_half_as_far_off_a_straight_shore_as_the_route_has_room_to_spare() -> None:
    chart = build_chart("canal", LocalFrame(LatLon(50.0, 10.0)), shapely.box(0.0, 0.0, 1000.0, 60.0), ())
    fence, near_m = fence_of_water(chart, [Point(30.0, 50.0), Point(30.0, 950.0)], 10.0, 2.0, 100)
    assert near_m == pytest.approx(30.0 - 0.5 * (10.0 - 2.0), abs=0.05)
    corners = fence.polygons[0].corners
    assert all((at.lat_deg, at.lon_deg) == (round(at.lat_deg, 7), round(at.lon_deg, 7)) for at in corners)


def test_a_fence_that_cannot_be_had_is_an_error_and_so_is_a_mission_without_a_map() -> None:
    planned = mt.open_map("lake").route().planned
    with pytest.raises(NoRoute, match="no fence of at most 5 corners"):
        with_contract(planned, replace(BOAT, most_fence_items=5))
    ready = MissionFile(Path("m.plan"), planned.mission, PlanOptions()).prepare()
    with pytest.raises(UsageError, match=r"m\.plan is a mission without a map"):
        with_contract(ready, BOAT)


def test_too_little_room_for_the_boats_margin_is_noted() -> None:
    planned = mt.open_map("lake").route(clearance_m=1.5).planned
    boat = replace(BOAT, fence_margin_m=3.0)
    contracted = with_contract(planned, boat)
    assert any("plan with more --clearance" in note for note in contracted.notes)
    assert_holds(contracted, boat, 0.5)


def test_a_boat_sails_its_contract_as_it_sails_without_a_fence() -> None:
    """The fence's brake leaves the route alone, and nothing is told of a breach."""
    scenario = load_scenario("lake")
    near = PlanOptions(goal=LatLon(49.99895, -1.2020))
    planned = MapSource("lake", Source(scenario.chart, scenario.route), near).prepare()
    contracted = with_contract(planned, Boat.of(scenario.vehicle))
    fence = [
        MissionItem(item.frame, item.command, 0, 1, *item.params, item.x, item.y, item.z)
        for item in contracted.mission.fence.items()
    ]
    times_s = []
    for areas in ([], fence):
        run = MissionRun(scenario, wire_items(contracted.mission), fence=areas)
        result = run.run()
        assert result.completed
        assert not [text for text in run.lockstep.station.texts if "ence" in text]
        times_s.append(result.time_s)
    assert times_s[1] < 1.03 * times_s[0]


def test_a_route_without_a_clearance_has_a_fence_too() -> None:
    lake = shapely.box(0.0, 0.0, 200.0, 100.0)
    chart = build_chart("lake", LocalFrame(LatLon(50.0, 10.0)), lake, ())
    fence, near_m = fence_of_water(chart, [Point(50.0, 50.0), Point(50.0, 150.0)], 0.0, 2.0, 100)
    assert chart.navigable.contains(fence_area(chart, fence))
    assert near_m == pytest.approx(50.0, abs=0.1)
    with pytest.raises(NoRoute):
        fence_of_water(chart, [Point(50.0, 50.0), Point(0.001, 150.0)], 0.0, 2.0, 100)
