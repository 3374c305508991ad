"""Passages, coves and detours that a raster hides or lengthens, some of them on real lakes."""

import math
from itertools import pairwise

import pytest
import shapely
from data_files import SHORES

from companion.core.geo import LatLon, LocalFrame, Point, path_length_m
from mission_tools.errors import NoRoute
from mission_tools.maps import Chart, build_chart, load_geojson
from mission_tools.maps.chart import Feature
from mission_tools.planning.planner import Plan, PlanSettings, plan

FRAME = LocalFrame(LatLon(50.0, 10.0))


def straits(width_m: float, length_m: float, half_m: float, turn_deg: float = 0.0) -> Chart:
    """Two basins joined by a strait from west to east, all turned counter-clockwise."""
    h, s, w = 0.5 * width_m, 0.5 * length_m, half_m
    outline = [(-w, -w / 2), (-s, -w / 2), (-s, -h), (s, -h), (s, -w / 2), (w, -w / 2)]
    outline += [(-x, -y) for x, y in outline]
    cos, sin = math.cos(math.radians(turn_deg)), math.sin(math.radians(turn_deg))
    return build_chart(
        "Straits", FRAME, shapely.Polygon([(x * cos - y * sin, x * sin + y * cos) for x, y in outline]), ()
    )


def planned(chart: Chart, start: str, goal: str, margin_m: float = 0.6) -> Plan:
    here, there = (
        chart.frame.to_local(LatLon(*(float(part) for part in place.split(",")))) for place in (start, goal)
    )
    return plan(chart, here, there, PlanSettings(4.0, margin_m=margin_m))


@pytest.mark.parametrize("width_m", [10.0, 20.0])
def test_a_narrow_strait_in_a_large_lake_is_found(width_m: float) -> None:
    chart = straits(width_m, 200.0, 15_000.0, 27.0)
    found = planned(chart, "49.9795921,9.9377398", "50.0204079,10.0622602")
    assert found.length_m <= 1.001 * found.straight_m
    assert found.min_clearance_m >= 4.0


def test_a_short_trip_on_a_large_lake_is_not_lengthened_by_coarse_cells() -> None:
    chart = load_geojson(SHORES / "lake_winnipesaukee_nh.geojson")
    found = planned(chart, "43.6314892,-71.4001387", "43.6322076,-71.4012558")
    assert found.length_m < 1.02 * 173.4


@pytest.mark.parametrize("name", ["pond_two_islands_nh", "lake_squam_nh", "harbour_san_juan_pr"])
def test_there_and_back_are_one_route(name: str) -> None:
    chart = load_geojson(SHORES / f"{name}.geojson")
    deep = max(shapely.get_parts(chart.navigable.buffer(-12.0)), key=lambda part: float(part.area))
    corners = [Point(y, x) for x, y in shapely.get_coordinates(deep.exterior).tolist()]
    ends = corners[:: max(1, len(corners) // 3)]
    for start, goal in pairwise(ends):
        there = plan(chart, start, goal, PlanSettings(10.0))
        back = plan(chart, goal, start, PlanSettings(10.0))
        assert path_length_m(back.found) == pytest.approx(path_length_m(there.found), abs=1e-9)
        assert back.length_m == pytest.approx(there.length_m, rel=2e-3)


def test_positions_rounded_as_in_a_file_keep_the_clearance() -> None:
    rock = shapely.Point(0.0, 0.0).buffer(20.0)
    chart = build_chart("Rock", FRAME, shapely.box(-100, -100, 100, 100).difference(rock), ())
    for turn in range(24):
        north_m, east_m = 60 * math.sin(turn), 60 * math.cos(turn)
        found = plan(chart, Point(north_m, east_m), Point(-north_m, -east_m + 1.0), PlanSettings(4.0))
        places = [FRAME.to_global(point) for point in found.points]
        saved = [FRAME.to_local(LatLon(round(at.lat_deg, 7), round(at.lon_deg, 7))) for at in places]
        assert min(chart.leg_clearance_m(a, b) for a, b in pairwise(saved)) >= 4.0
        assert found.settings == PlanSettings(4.0)


def test_a_start_with_just_the_clearance_is_not_at_its_jetty() -> None:
    chart = build_chart("Basin", FRAME, shapely.box(-100, -100, 100, 100), ())
    found = plan(chart, Point(96.0, 0.0), Point(0.0, 0.0), PlanSettings(4.0))
    assert (found.notes, len(found.points)) == ((), 2)


def test_a_lagoon_within_an_atoll_of_open_water_is_water() -> None:
    reef = shapely.Point(0.0, 0.0).buffer(200.0).difference(shapely.Point(0.0, 0.0).buffer(100.0))
    chart = build_chart("Atoll", FRAME, None, [Feature("reef", "obstacle", reef)])
    found = plan(chart, Point(-50.0, 0.0), Point(50.0, 0.0), PlanSettings(4.0))
    assert found.length_m == pytest.approx(100.0)
    with pytest.raises(NoRoute):
        plan(chart, Point(0.0, 0.0), Point(300.0, 0.0), PlanSettings(4.0))
    around = plan(chart, Point(-300.0, 0.0), Point(300.0, 0.0), PlanSettings(4.0))
    assert around.length_m > 2.0 * math.hypot(300.0, 100.0)


def test_a_rock_that_asks_for_less_clearance_is_passed_nearer() -> None:
    rock = Feature("rock", "obstacle", shapely.box(-5, -99, 5, 0), {"clearance_m": 0.5})
    chart = build_chart("Basin", FRAME, shapely.box(-100, -100, 100, 100), [rock])
    found = plan(chart, Point(-30.0, -30.0), Point(-30.0, 30.0), PlanSettings(4.0))
    assert 0.5 - 1e-6 <= found.min_clearance_m < 2.5


def test_corners_are_widened_by_what_the_boat_cuts_off() -> None:
    water = shapely.box(-100, -100, 100, 100).difference(shapely.box(-5, -99, 5, 0))
    found = plan(build_chart("Basin", FRAME, water, ()), Point(-30.0, -30.0), Point(-30.0, 30.0))
    assert found.min_clearance_m == pytest.approx(4.17, abs=0.01)
    assert 1.01 < found.length_m / path_length_m(found.found) < 1.02
