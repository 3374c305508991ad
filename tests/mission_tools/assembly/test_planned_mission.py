"""From SOURCE to a mission: where the route starts, fences on ready missions, and the antimeridian."""

import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest
import shapely

from companion.core.geo import LatLon, LocalFrame, Point, distance_m
from mission_tools.assembly.areas import Areas
from mission_tools.assembly.check import check_mission
from mission_tools.assembly.map_source import MapSource
from mission_tools.assembly.open_source import MissionFile
from mission_tools.assembly.plan_options import PlanOptions
from mission_tools.assembly.planned_costs import _between_stops
from mission_tools.assembly.planned_mission import PlannedMission
from mission_tools.errors import MapError, UsageError
from mission_tools.maps import Feature, RouteDefaults, Source, build_chart
from mission_tools.maps.fenced import fenced
from mission_tools.mission.mission import Command, Fence, FenceCircle, FencePolygon, Mission, MissionItem
from mission_tools.mission.plan_file import save_mission

POND = LatLon(50.0, -1.2)
START, GOAL = Point(0.0, 0.0), Point(200.0, 0.0)


def open_source(origin: LatLon = POND, start: Point | None = START, goal: Point | None = GOAL) -> Source:
    chart = build_chart("sea", LocalFrame(origin), None, ())
    return Source(chart, RouteDefaults(start=start, goal=goal, clearance_m=4.0))


def first_point(planned: PlannedMission) -> Point:
    return planned.points[0]


# Where the route starts


def test_under_way_a_scenarios_route_starts_at_the_boat() -> None:
    source = open_source()
    water = MapSource("sea", source, PlanOptions(goal=source.chart.frame.to_global(GOAL)))
    assert water.wants_position
    assert not water.needs_position
    at = Point(190.0, 3.0)
    planned = water.prepare(source.chart.frame.to_global(at))
    assert distance_m(first_point(planned), at) < 0.02
    assert planned.plan is not None
    assert planned.plan.length_m == pytest.approx(distance_m(at, GOAL), abs=0.1)


@pytest.mark.parametrize(("off_m", "from_scenario"), [(3.9, True), (4.1, False)])
def test_a_boat_within_the_clearance_of_the_scenarios_start_has_not_left_it(
    off_m: float, from_scenario: bool
) -> None:
    source = open_source()
    here = source.chart.frame.to_global(Point(0.0, off_m))
    start = first_point(MapSource("sea", source, PlanOptions()).prepare(here))
    expected = START if from_scenario else Point(0.0, off_m)
    assert distance_m(start, expected) < 0.02


def test_a_start_that_was_named_goes_before_the_boat() -> None:
    source = open_source()
    to_global = source.chart.frame.to_global
    water = MapSource("sea", source, PlanOptions(start_at=to_global(Point(50.0, 50.0))))
    assert not water.wants_position
    assert distance_m(first_point(water.prepare(to_global(Point(9.0, 9.0)))), Point(50.0, 50.0)) < 0.02


def test_without_a_boat_the_scenarios_start_is_the_start_and_without_either_there_is_none() -> None:
    assert distance_m(first_point(MapSource("sea", open_source(), PlanOptions()).prepare()), START) < 0.02
    bare = MapSource("sea", open_source(start=None), PlanOptions())
    assert bare.needs_position
    with pytest.raises(UsageError, match="no start: add --start-at"):
        bare.prepare()


def test_the_scenarios_points_in_between_belong_to_its_own_goal() -> None:
    between = Point(100.0, 50.0)
    source = open_source()
    source = replace(source, route=replace(source.route, via=(between,)))
    found = MapSource("sea", source, PlanOptions()).prepare()
    assert distance_m(found.points[1], between) < 0.02
    elsewhere = PlanOptions(goal=source.chart.frame.to_global(Point(0.0, 90.0)))
    assert len(MapSource("sea", source, elsewhere).prepare().points) == 2


def test_a_place_whose_numbers_are_swapped_is_told_so() -> None:
    swapped = PlanOptions(goal=LatLon(POND.lon_deg, POND.lat_deg))
    with pytest.raises(UsageError, match="latitude and longitude look swapped"):
        MapSource("sea", open_source(), swapped)
    with pytest.raises(UsageError, match=r"nowhere near sea at 50\.000000,-1\.200000$"):
        MapSource("sea", open_source(), PlanOptions(goal=LatLon(10.0, 120.0)))


def test_a_route_of_least_time_keeps_its_stops_and_says_its_own_clearance() -> None:
    stops = tuple(Point(0.0, east_m) for east_m in (0.0, 60.0, 60.0, 120.0))
    bend = Point(30.0, 30.0)
    assert _between_stops((stops[0], bend, *stops[1:]), stops) == [
        (stops[0], bend, stops[1]),
        (stops[1], stops[2]),
        (stops[2], stops[3]),
    ]
    rock = Feature("Rock", "obstacle", shapely.box(55.0, 3.0, 65.0, 13.0))
    chart = build_chart("sea", LocalFrame(POND), shapely.box(-30.0, -40.0, 150.0, 60.0), [rock])
    source = Source(
        chart, RouteDefaults(start=stops[0], goal=stops[-1], via=(Point(-10.0, 60.0),), clearance_m=4.0)
    )
    found = MapSource("sea", source, PlanOptions(current="0.1,90")).prepare().plan
    assert found is not None
    assert found.min_clearance_m == min(chart.leg_clearance_m(a, b) for a, b in pairwise(found.points))
    assert found.length_m == pytest.approx(2.0 * math.hypot(10.0, 60.0), abs=0.5)
    assert found.notes[-1].startswith("takes 1 min 01 s in this current; ")


def test_a_boat_that_is_faster_than_usual_may_be_asked_for_its_speed_in_a_current(tmp_path: Path) -> None:
    (tmp_path / "fast.toml").write_text("[handling]\ntop_speed_m_s = 5.0\n")
    options = PlanOptions(speed_m_s=4.0, boat=str(tmp_path / "fast.toml"), current="0.1,90")
    found = MapSource("sea", open_source(), options).prepare().plan
    assert found is not None
    assert found.notes[-1].startswith("takes 50 s in this current; ")


def test_a_stretch_of_a_shore_is_followed_from_its_first_end_to_its_last() -> None:
    chart = build_chart("pond", LocalFrame(POND), shapely.box(-100.0, -100.0, 100.0, 100.0), ())
    ends = [chart.frame.to_global(Point(north_m, -100.0)) for north_m in (-50.0, 0.0, 50.0)]
    options = PlanOptions(
        follow_shore_at=ends[1], distance_m=10.0, first=ends[0], last=ends[2], shore_to="port"
    )
    found = MapSource("pond", Source(chart), options).prepare()
    assert [(round(at.north_m), round(at.east_m)) for at in found.points] == [(-50, -90), (50, -90)]


# A fence of exclusions alone on a mission that is ready


def proposed(tmp_path: Path, fence: Fence, *points: Point) -> PlannedMission:
    to_global = LocalFrame(POND).to_global
    mission = Mission(tuple(MissionItem.at(to_global(point)) for point in points), to_global(points[0]))
    save_mission(mission, tmp_path / "m.plan")
    return MissionFile(tmp_path / "m.plan", mission, PlanOptions(), Areas(fence, fence_name="f")).prepare()


@pytest.mark.parametrize("length_m", [6_700.0, 45_000.0, 150_000.0])
def test_a_keep_out_aside_is_not_in_the_way_of_a_long_leg(tmp_path: Path, length_m: float) -> None:
    aside = LocalFrame(POND).to_global(Point(3_350.0, 3_600.0))
    fence = Fence(circles=(FenceCircle(aside, 50.0, inclusion=False),))
    assert proposed(tmp_path, fence, Point(0.0, 0.0), Point(length_m, 0.0)).notes == ()


def test_a_keep_out_on_a_long_leg_is_in_the_way(tmp_path: Path) -> None:
    on_it = LocalFrame(POND).to_global(Point(6_000.0, 40.0))
    fence = Fence(circles=(FenceCircle(on_it, 50.0, inclusion=False),))
    (note,) = proposed(tmp_path, fence, Point(0.0, 0.0), Point(6_700.0, 0.0)).notes
    assert "the fence circle 1 is in the way" in note


# The antimeridian


def test_two_waypoints_on_either_side_of_the_antimeridian_are_neighbours() -> None:
    places = [LatLon(0.001, 179.9995), LatLon(0.001, -179.9995)]
    mission = Mission(tuple(MissionItem.at(at, Command.NAV_WAYPOINT) for at in places), places[0])
    assert check_mission(mission) == []


def test_two_waypoints_half_a_world_apart_are_not() -> None:
    places = [LatLon(0.001, 90.0), LatLon(0.001, -89.0)]
    mission = Mission(tuple(MissionItem.at(at, Command.NAV_WAYPOINT) for at in places), places[0])
    assert [finding.text for finding in check_mission(mission)] == [
        "more than 50 km from the point before it"
    ]


def test_a_fence_across_the_antimeridian_is_near_its_chart() -> None:
    chart = build_chart("sea", LocalFrame(LatLon(-17.0, 179.9995)), None, ())
    corners = [(-17.01, 179.99), (-17.01, -179.99), (-16.99, -179.99), (-16.99, 179.99)]
    fence = Fence(polygons=(FencePolygon(tuple(LatLon(*corner) for corner in corners)),))
    within = fenced(chart, fence, "f")
    assert within.obstruction(Point(0.0, 0.0)) is None
    assert within.obstruction(Point(0.0, 1_130.0)) is not None
    far = Fence(circles=(FenceCircle(LatLon(-17.0, 177.0), 50.0),))
    with pytest.raises(MapError, match="nowhere near"):
        fenced(chart, far, "f")
