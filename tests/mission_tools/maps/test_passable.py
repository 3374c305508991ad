"""Depths and heights of a map: a boat keeps out of water and from under bridges that are too low for it."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from companion.core.geo import LatLon
from mission_tools.assembly.plan_options import PlanOptions
from mission_tools.assembly.planned_mission import open_source
from mission_tools.errors import MapError, NoRoute, NoRouteError, UsageError
from mission_tools.geojson import collection, feature
from mission_tools.maps.chart import Chart
from mission_tools.maps.geojson import load_geojson
from mission_tools.maps.passable import BoatSize, passable

START, GOAL = LatLon(50.0, 10.0005), LatLon(50.0, 10.0055)
WAY = PlanOptions(start_at=START, goal=GOAL, clearance_m=2.0)
BRIDGED = [[10.003, 49.9985], [10.003, 50.0015]]  # from bank to bank


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


def write_bridges(folder: Path, *bridges: dict[str, object]) -> Path:
    lake = feature("Polygon", square(0, -1, 6, 1), kind="water", name="Lake")
    spans = [feature("LineString", BRIDGED, kind="bridge", **bridge) for bridge in bridges]
    path = folder / "bridged.geojson"
    path.write_text(json.dumps(collection([lake, *spans])))
    return path


def chart_with(folder: Path, **properties: object) -> Chart:
    return load_geojson(write_map(folder, **properties))


def test_a_shoal_is_an_obstacle_for_a_boat_that_draws_more(tmp_path: Path) -> None:
    chart = chart_with(tmp_path, depth_m=0.4)
    at = chart.frame.to_local(LatLon(50.0, 10.003))
    assert chart.obstruction(at) is None
    assert passable(chart, BoatSize(0.3)) is chart
    assert passable(chart, BoatSize(0.5)).obstruction(at) == "on water of 0.4 m"
    told = "the map has no depths (depth_m): a draught of 0.5 m makes no difference"
    assert told not in passable(chart, BoatSize(0.5)).notes
    assert told in passable(chart_with(tmp_path), BoatSize(0.5)).notes


def test_a_depth_or_height_that_is_no_number_is_named(tmp_path: Path) -> None:
    with pytest.raises(MapError, match=r'water "Bar": depth_m is .deep.: expected a number'):
        passable(chart_with(tmp_path, depth_m="deep", name="Bar"), BoatSize(0.5))
    bridged = load_geojson(write_bridges(tmp_path, {"name": "Old Bridge", "height_m": "3 m"}))
    with pytest.raises(MapError, match=r'bridge "Old Bridge": height_m is .3 m.: expected a number'):
        passable(bridged, BoatSize(air_draught_m=1.0))


def test_the_route_leads_round_the_shoal(tmp_path: Path) -> None:
    path = str(write_map(tmp_path, depth_m=0.4))
    deep = open_source(path, PlanOptions(start_at=START, goal=GOAL, clearance_m=2.0)).prepare()
    shallow = open_source(
        path, PlanOptions(start_at=START, goal=GOAL, clearance_m=2.0, draught_m=0.6)
    ).prepare()
    assert len(deep.points) == 2
    assert len(shallow.points) > 2
    with pytest.raises(UsageError, match="--draught -1"):
        open_source(path, PlanOptions(start_at=START, goal=GOAL, draught_m=-1.0))


def test_a_bar_that_is_too_shallow_is_named_as_the_reason(tmp_path: Path) -> None:
    path = write_map(tmp_path, depth_m=0.5, name="Bar")
    tree = json.loads(path.read_text())
    tree["features"][1]["geometry"]["coordinates"] = square(2, -1.5, 4, 1.5)  # from bank to bank
    path.write_text(json.dumps(tree))
    options = PlanOptions(start_at=START, goal=GOAL, draught_m=0.8)
    with pytest.raises(
        NoRoute, match=r'no way is deep enough for --draught 0\.8; without it .* over water "Bar" \(0\.5 m\)'
    ):
        open_source(str(path), options).prepare()
    tree["features"][0]["geometry"]["coordinates"] = square(0, -1, 1, 1)  # and then there is no water at all
    tree["features"][1]["geometry"]["coordinates"] = square(5, -1, 6, 1)
    path.write_text(json.dumps(tree))
    with pytest.raises(NoRouteError) as caught:
        open_source(str(path), replace(options, draught_m=0.2)).prepare()
    assert "deep" not in str(caught.value)


def test_a_boat_passes_below_a_bridge_that_is_as_high_as_it_is(tmp_path: Path) -> None:
    path = write_bridges(tmp_path, {"name": "Old Bridge", "height_m": 3.6}, {"height_m": 5.0})
    below = open_source(str(path), replace(WAY, air_draught_m=3.6)).prepare()
    assert len(below.points) == 2
    assert not any("bridge" in note for note in below.notes)
    with pytest.raises(
        NoRoute,
        match=r'high enough for --air-draught 3\.7; without it .* below bridge "Old Bridge" \(3\.6 m\)',
    ):
        open_source(str(path), replace(WAY, air_draught_m=3.7)).prepare()
    with pytest.raises(UsageError, match="--air-draught -1: expected 0 metres or more"):
        open_source(str(path), replace(WAY, air_draught_m=-1.0))


def test_bridges_are_told_where_the_boats_height_or_theirs_is_unknown(tmp_path: Path) -> None:
    chart = load_geojson(write_bridges(tmp_path, {"name": "Old Bridge", "height_m": 3.6}, {}))
    (note,) = passable(chart, BoatSize()).notes
    assert note.startswith("2 bridges and cables are overhead, the lowest, Old Bridge, leaves 3.6 m: ")
    (note,) = passable(chart, BoatSize(air_draught_m=1.0)).notes
    assert note.startswith("2 bridges and cables are overhead, 1 without a height (height_m): ")
    (note,) = passable(load_geojson(write_bridges(tmp_path, {})), BoatSize(draught_m=None)).notes
    assert "none has a height" in note


def test_the_limit_that_bars_the_way_is_the_one_that_is_named(tmp_path: Path) -> None:
    path = write_bridges(tmp_path, {"name": "Old Bridge", "height_m": 1.0})
    tree = json.loads(path.read_text())
    tree["features"][0]["properties"]["depth_m"] = 2.0
    path.write_text(json.dumps(tree))
    with pytest.raises(NoRoute, match=r"high enough for --air-draught 2"):
        open_source(str(path), replace(WAY, draught_m=0.5, air_draught_m=2.0)).prepare()
