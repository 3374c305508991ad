"""The planner from Python: open a map, plan, look at it, save it."""

import json
import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import mission_tools as mt
from companion.core.geo import LocalFrame, distance_m
from mission_tools.mission.plan_file import load_mission

RING = [[-1.2, 50.0], [-1.198, 50.0], [-1.198, 50.002], [-1.2, 50.002], [-1.2, 50.0]]
HOLE = [[-1.1993, 50.0008], [-1.1987, 50.0008], [-1.1987, 50.0012], [-1.1993, 50.0012], [-1.1993, 50.0008]]
POND: dict[str, Any] = {"type": "Polygon", "coordinates": [RING, HOLE]}
START, GOAL = (50.0004, -1.199), (50.0016, -1.199)


def is_same(one: mt.LatLon, other: mt.LatLon) -> bool:
    """Whether two places are the same on the wire, which counts in 1e-7 degrees."""
    return math.dist((one.lat_deg, one.lon_deg), (other.lat_deg, other.lon_deg)) < 1e-7


@pytest.fixture
def water() -> mt.WaterMap:
    """A pond of 143 × 222 m with an island."""
    return mt.open_map(POND)


def test_a_map_opens_from_a_dict_from_text_from_a_file_and_by_name(tmp_path: Path) -> None:
    (tmp_path / "pond.geojson").write_text(json.dumps(POND))
    lengths = {
        mt.open_map(source).route(START, GOAL).length_m
        for source in (POND, json.dumps(POND), tmp_path / "pond.geojson", str(tmp_path / "pond.geojson"))
    }
    assert len(lengths) == 1
    assert mt.open_map("lake").name == "Mill Pond"


@pytest.mark.parametrize("source", ["{", "nowhere.geojson", {"type": "Feature"}])
def test_what_is_no_map_is_told_in_a_line(source: Any) -> None:  # noqa: ANN401
    with pytest.raises(mt.MapError) as told:
        mt.open_map(source)
    assert "\n" not in str(told.value)


def test_a_route_keeps_its_clearance_and_adds_up(water: mt.WaterMap) -> None:
    route = water.route(START, GOAL, clearance_m=4)
    assert route.points[0] == mt.LatLon(*START)
    assert route.points[-1] == mt.LatLon(*GOAL)
    assert 133.0 < route.length_m < 165.0
    assert route.min_clearance_m >= 4.0
    frame = LocalFrame(mt.LatLon(*START))
    by_points_m = sum(distance_m(frame.to_local(leg.start), frame.to_local(leg.end)) for leg in route.legs)
    assert route.length_m == pytest.approx(by_points_m, abs=0.05)
    assert [leg.end for leg in route.legs] == list(route.points[1:])
    assert water.route(mt.LatLon(*START), mt.LatLon(*GOAL), clearance_m=4) == route


@pytest.mark.parametrize("place", [(50.0,), "50,-1", (math.nan, 0.0), (91.0, 0.0), 5.0, (None, 1.0)])
def test_what_is_no_place_is_told(water: mt.WaterMap, place: Any) -> None:  # noqa: ANN401
    with pytest.raises(mt.UsageError, match="expected \\(latitude, longitude\\) in degrees"):
        water.route(START, place)


def test_a_route_is_saved_in_the_format_of_its_suffix(water: mt.WaterMap, tmp_path: Path) -> None:
    route = water.route(START, GOAL, speed_m_s=1.5)
    assert load_mission(route.save(tmp_path / "route.plan")).items == route.mission.items
    assert route.save(str(tmp_path / "route.waypoints")).read_text().startswith("QGC WPL 110")
    assert route.save(tmp_path / "route.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(mt.MissionToolsError):
        route.save(tmp_path / "route.doc")


def test_a_notebook_shows_a_picture_of_a_route_and_of_a_map(water: mt.WaterMap) -> None:
    assert water.route(START, GOAL)._repr_png_().startswith(b"\x89PNG")
    assert water._repr_png_().startswith(b"\x89PNG")


def test_a_tour_holds_at_its_stops_and_comes_back(water: mt.WaterMap) -> None:
    tour = water.tour(START, [GOAL, (50.0010, -1.1982)], hold_s=30.0, any_order=True, is_return=True)
    assert tour.hold_s == 60.0
    assert is_same(tour.points[0], tour.points[-1])


def test_a_survey_stays_in_its_area_and_needs_no_start(water: mt.WaterMap) -> None:
    ring = [[-1.2, 50.0], [-1.1994, 50.0], [-1.1994, 50.002], [-1.2, 50.002], [-1.2, 50.0]]
    west = {"type": "Polygon", "coordinates": [ring]}
    survey = water.survey(west, spacing_m=6.0, angle_deg=0.0, clearance_m=3.0)
    assert max(place.lon_deg for place in survey.points) < -1.1994
    assert survey.length_m > 5 * 200.0
    assert "on 0°" in survey.notes[-1]


def test_the_package_imports_nothing_before_it_is_used() -> None:
    code = "import sys, mission_tools; dir(mission_tools); print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"numpy", "shapely", "companion.core.geo", "asyncio"} & set(done.stdout.split())
    assert set(mt.__all__) <= set(dir(mt))
    assert all(getattr(mt, name) is not None for name in mt.__all__)
    with pytest.raises(AttributeError, match="no attribute 'plan_it'"):
        _ = mt.plan_it


def test_a_route_knows_its_budget_and_its_contract(water: mt.WaterMap) -> None:
    route = water.route(START, GOAL)
    budget = route.budget("lake")
    assert budget.length_m == pytest.approx(route.length_m)
    assert 60.0 < budget.time_s < 90.0
    assert budget.no_return_m is None
    assert route.budget("lake", "0.5,0").home_mah > budget.home_mah
    contracted = route.with_contract("lake")
    assert contracted.points == route.points
    assert [polygon.inclusion for polygon in contracted.mission.fence.polygons] == [True, False]
    assert len(contracted.mission.rally) == 1
