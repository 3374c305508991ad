"""Speed limits of a map, which a mission obeys, and clearances of a feature's own."""

import json
from itertools import pairwise
from pathlib import Path

import pytest
import shapely

from companion.core.geo import LatLon, LocalFrame, Point
from mission_tools.assembly.open_source import open_source
from mission_tools.assembly.plan_options import PlanOptions
from mission_tools.assembly.zone_speeds import mission_in_zones
from mission_tools.costs.travel import SpeedZone, speed_zones
from mission_tools.errors import MapError, UsageError
from mission_tools.geojson import collection, feature
from mission_tools.maps.chart import Chart, Feature, build_chart
from mission_tools.maps.geojson import load_geojson
from mission_tools.mission.mission import Command
from mission_tools.planning.planner import PlanSettings, plan

FRAME = LocalFrame(LatLon(50.0, 10.0))
START, GOAL = LatLon(50.0, 10.0005), LatLon(50.0, 10.0055)


def square(west: float, south: float, east: float, north: float) -> list[list[list[float]]]:
    corners = [(west, south), (east, south), (east, north), (west, north), (west, south)]
    return [[[10.0 + 1e-3 * x, 50.0 + 1e-3 * y] for x, y in corners]]


def write_map(folder: Path, **properties: object) -> Path:
    inner = {"kind": "water"} | properties
    lake = feature("Polygon", square(0, -1, 6, 1), kind="water", name="Lake")
    tree = collection([lake, feature("Polygon", square(2, -0.5, 4, 0.5), **inner)])
    path = folder / "lake.geojson"
    path.write_text(json.dumps(tree))
    return path


def chart_with(folder: Path, **properties: object) -> Chart:
    return load_geojson(write_map(folder, **properties))


def test_a_limit_that_is_no_speed_is_named(tmp_path: Path) -> None:
    with pytest.raises(MapError, match="max_speed_m_s is 0: expected more than 0"):
        speed_zones(chart_with(tmp_path, max_speed_m_s=0))


def test_a_mission_slows_down_in_a_zone_and_goes_on_after_it(tmp_path: Path) -> None:
    path = str(write_map(tmp_path, max_speed_m_s=0.8))
    planned = open_source(path, PlanOptions(start_at=START, goal=GOAL, speed_m_s=2.0)).prepare()
    items = planned.mission.items
    assert [item.params[1] for item in items if item.command == Command.DO_CHANGE_SPEED] == [2.0, 0.8, 2.0]
    assert [place.lon_deg for place in planned.mission.places] == pytest.approx(
        [10.002, 10.004, 10.0055], abs=1e-6
    )
    with pytest.raises(UsageError, match=r"a zone of at most 0\.8 m/s: add --speed"):
        open_source(path, PlanOptions(start_at=START, goal=GOAL)).prepare()


def test_a_boat_that_is_slower_than_the_limit_needs_no_other_mission(tmp_path: Path) -> None:
    path = str(write_map(tmp_path, max_speed_m_s=0.8))
    planned = open_source(path, PlanOptions(start_at=START, goal=GOAL, speed_m_s=0.7)).prepare()
    assert len(planned.mission.places) == 1


def test_the_lowest_limit_counts_where_zones_overlap() -> None:
    zones = [SpeedZone(shapely.box(10, -5, 40, 5), 1.0), SpeedZone(shapely.box(20, -5, 30, 5), 0.5)]
    mission = mission_in_zones(FRAME, [Point(0, 0), Point(0, 25), Point(0, 60)], zones, 2.0)
    assert mission is not None
    speeds: list[tuple[float, float]] = []
    for speed, place in pairwise(mission.items):
        if speed.command == Command.DO_CHANGE_SPEED and place.place is not None:
            speeds.append((speed.params[1], round(FRAME.to_local(place.place).east_m, 1)))
    assert speeds == [(2.0, 10.0), (1.0, 20.0), (0.5, 25.0), (1.0, 40.0), (2.0, 60.0)]


def test_a_zone_that_is_only_touched_or_beside_the_way_changes_nothing() -> None:
    route = [Point(0, 0), Point(0, 60)]
    for zone in (shapely.box(10, 0, 40, 5), shapely.box(10, 1, 40, 5), shapely.box(20, -5, 20.3, 5)):
        assert mission_in_zones(FRAME, route, [SpeedZone(zone, 0.5)], 2.0) is None


def test_a_zone_that_ends_at_the_goal_and_a_narrow_one_have_their_speeds() -> None:
    for west, east, ends in ((20.0, 59.7, [20.0, 60.0]), (20.0, 20.7, [20.0, 20.7, 60.0])):
        zone = SpeedZone(shapely.box(west, -5.0, east, 5.0), 0.5)
        mission = mission_in_zones(FRAME, [Point(0, 0), Point(0, 60)], [zone], 2.0)
        assert mission is not None
        assert [FRAME.to_local(place).east_m for place in mission.places] == pytest.approx(ends, abs=0.01)


def with_obstacle(clearance_m: float, *, at_shore: bool = False) -> Chart:
    shape = shapely.box(48, -60 if at_shore else -3, 52, 3)
    rock = Feature("rock", "obstacle", shape, {"clearance_m": clearance_m})
    return build_chart("pond", FRAME, shapely.box(-50, -50, 150, 50), [rock])


@pytest.mark.parametrize(
    ("chart", "kept_m"),
    [
        (with_obstacle(9.0), 9.0),
        (with_obstacle(1.0), 1.0),
        (with_obstacle(9.0, at_shore=True), 9.0),
        (with_obstacle(1.0, at_shore=True), 4.0),
    ],
)
def test_a_feature_may_ask_for_a_clearance_of_its_own(chart: Chart, kept_m: float) -> None:
    found = plan(chart, Point(0, 0), Point(0, 100), PlanSettings(clearance_m=4.0))
    assert found.min_clearance_m >= kept_m
    assert shapely.LineString([(p.east_m, p.north_m) for p in found.found]).distance(
        chart.features[0].shape
    ) == pytest.approx(kept_m, abs=0.05)


def test_a_clearance_below_zero_is_refused_with_its_feature(tmp_path: Path) -> None:
    path = write_map(tmp_path, kind="island", name="Isle", clearance_m=-5)
    with pytest.raises(MapError, match=r'island "Isle": clearance_m is -5: expected 0 or more'):
        open_source(str(path), PlanOptions(start_at=START, goal=GOAL)).prepare()
