"""Depths and heights of a map: a boat keeps out of water and from under bridges that are too low for it."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from drawn_maps import FRAME, Json, box, chart_of, collection, feature, positions

from companion.core.geo import Point
from mission_tools.assembly.open_source import open_source
from mission_tools.assembly.plan_options import PlanOptions
from mission_tools.errors import MapError, NoRoute, NoRouteError, UsageError
from mission_tools.maps.passable import BoatSize, passable

WAY = PlanOptions(
    start_at=FRAME.to_global(Point(0, -250)), goal=FRAME.to_global(Point(0, 250)), clearance_m=2.0
)
LAKE = feature([box(-300, -100, 300, 100)], kind="water", name="Lake")
BANK_TO_BANK = (-20.0, -150.0, 20.0, 150.0)


def shoal(corners: tuple[float, float, float, float] = (-100, -50, 100, 50), **properties: object) -> Json:
    return feature([box(*corners)], "Polygon", kind="water", **properties)


def bridge(**properties: object) -> Json:
    return feature(positions([(5, -120), (5, 120)]), "LineString", kind="bridge", **properties)


def written(folder: Path, *features: Json) -> str:
    path = folder / "lake.geojson"
    path.write_text(json.dumps(collection(*features)))
    return str(path)


def test_a_shoal_is_an_obstacle_for_a_boat_that_draws_more() -> None:
    chart = chart_of(LAKE, shoal(depth_m=0.4))
    assert chart.obstruction(Point(0, 0)) is None
    assert passable(chart, BoatSize(0.3)) is chart
    assert passable(chart, BoatSize(0.4)) is chart
    assert passable(chart, BoatSize(0.5)).obstruction(Point(0, 0)) == "on water of 0.4 m"
    told = "the map has no depths (depth_m): a draught of 0.5 m makes no difference"
    assert passable(chart_of(LAKE, shoal()), BoatSize(0.5)).notes == (told,)


def test_a_depth_or_height_that_is_no_number_is_named() -> None:
    with pytest.raises(MapError, match=r'water "Bar": depth_m is .deep.: expected a number'):
        passable(chart_of(LAKE, shoal(depth_m="deep", name="Bar")), BoatSize(0.5))
    with pytest.raises(MapError, match=r'bridge "Old Bridge": height_m is .3 m.: expected a number'):
        passable(chart_of(LAKE, bridge(name="Old Bridge", height_m="3 m")), BoatSize(air_draught_m=1.0))


def test_the_route_leads_round_the_shoal(tmp_path: Path) -> None:
    path = written(tmp_path, LAKE, shoal(depth_m=0.4))
    assert len(open_source(path, WAY).prepare().points) == 2
    assert len(open_source(path, replace(WAY, draught_m=0.6)).prepare().points) > 2
    with pytest.raises(UsageError, match="--draught -1"):
        open_source(path, replace(WAY, draught_m=-1.0))


def test_a_bar_that_is_too_shallow_is_named_as_the_reason(tmp_path: Path) -> None:
    path = written(tmp_path, LAKE, shoal(BANK_TO_BANK, depth_m=0.5, name="Bar"))
    too_shallow = r'no way is deep enough for --draught 0\.8; without it .* over water "Bar" \(0\.5 m\)'
    with pytest.raises(NoRoute, match=too_shallow):
        open_source(path, replace(WAY, draught_m=0.8)).prepare()
    west, east = ([box(side - 50, -100, side + 50, 100)] for side in (-250, 250))
    path = written(tmp_path, feature(west, kind="water"), feature(east, kind="water", depth_m=0.5))
    with pytest.raises(NoRouteError) as caught:  # no water between them at all
        open_source(path, replace(WAY, draught_m=0.2)).prepare()
    assert "deep" not in str(caught.value)


def test_a_boat_passes_below_a_bridge_that_is_as_high_as_it_is(tmp_path: Path) -> None:
    path = written(tmp_path, LAKE, bridge(name="Old Bridge", height_m=3.6), bridge(height_m=5.0))
    below = open_source(path, replace(WAY, air_draught_m=3.6)).prepare()
    assert len(below.points) == 2
    assert below.notes == ()
    too_low = r'high enough for --air-draught 3\.7; without it .* below bridge "Old Bridge" \(3\.6 m\)'
    with pytest.raises(NoRoute, match=too_low):
        open_source(path, replace(WAY, air_draught_m=3.7)).prepare()
    with pytest.raises(UsageError, match="--air-draught -1: expected 0 metres or more"):
        open_source(path, replace(WAY, air_draught_m=-1.0))


def test_bridges_are_told_where_the_boats_height_or_theirs_is_unknown() -> None:
    chart = chart_of(LAKE, bridge(name="Old Bridge", height_m=3.6), bridge())
    (note,) = passable(chart, BoatSize()).notes
    assert note.startswith("2 bridges and cables are overhead, the lowest, Old Bridge, leaves 3.6 m: ")
    (note,) = passable(chart, BoatSize(air_draught_m=1.0)).notes
    assert note.startswith("2 bridges and cables are overhead, 1 without a height (height_m): ")
    (note,) = passable(chart_of(LAKE, bridge()), BoatSize()).notes
    assert "none has a height" in note


def test_of_two_limits_the_one_that_bars_the_way_is_named(tmp_path: Path) -> None:
    lake = {**LAKE, "properties": {**LAKE["properties"], "depth_m": 2.0}}
    path = written(tmp_path, lake, bridge(name="Old Bridge", height_m=1.0))
    with pytest.raises(NoRoute, match=r"high enough for --air-draught 2"):
        open_source(path, replace(WAY, draught_m=0.5, air_draught_m=2.0)).prepare()
