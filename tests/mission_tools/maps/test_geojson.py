"""GeoJSON maps: what they become, and the one line said about each thing that can be wrong."""

import math
from pathlib import Path

import pytest
import shapely
from data_files import SHORES
from drawn_maps import ORIGIN, box, chart_of, collection, feature
from hypothesis import example, given
from hypothesis import strategies as st

from companion.core.geo import LatLon, LocalFrame, Point
from mission_tools.errors import MapError
from mission_tools.maps import load_geojson
from mission_tools.maps.geojson import parse_geojson
from mission_tools.maps.projection import to_local

SHORE_FILES = sorted(SHORES.glob("*.geojson"))

LAKE = feature([box(-100, -50, 100, 50)], name="Lake", kind="water")


def test_water_loses_its_islands_and_obstacles_but_keeps_the_areas_to_keep_out_of() -> None:
    chart = chart_of(
        LAKE,
        feature([box(-10, -10, 10, 10)], name="Isle", kind="island"),
        feature([box(40, 0, 44, 10)], name="Raft", kind="raft"),
        feature([box(-60, 20, -40, 50)], name="Beach", kind="swimming"),
        feature(box(0, 60, 1, 61)[0], "Point", name="Church", kind="landmark"),
    )
    assert chart.water.area == pytest.approx(200 * 100 - 20 * 20 - 4 * 10, rel=1e-6)
    assert chart.navigable.area == pytest.approx(chart.water.area - 20 * 30, rel=1e-6)
    assert chart.name == "Lake"
    assert [f.name for f in chart.features] == ["Lake", "Isle", "Raft", "Beach", "Church"]
    assert chart.obstruction(Point(0.0, 0.0)) == "on Isle"
    assert chart.obstruction(Point(30.0, -50.0)) == "in Beach"
    assert chart.obstruction(Point(400.0, 0.0)) == "outside the map"
    assert chart.obstruction(Point(0.0, 50.0)) is None
    assert chart.clearance_m(Point(5.0, 35.0)) == pytest.approx(5.0, abs=1e-3)
    assert chart.nearest_feature(Point(5.0, 35.0)) == "Raft"
    assert chart.nearest_feature(Point(-45.0, 35.0)) == "the shore"


def test_a_feature_and_a_bare_polygon_are_water() -> None:
    for tree in (LAKE, LAKE["geometry"], collection({**LAKE, "properties": None})):
        assert parse_geojson(tree, "f", "f", ORIGIN).navigable.area == pytest.approx(20_000, rel=1e-6)


def test_without_an_origin_the_middle_of_the_water_becomes_one() -> None:
    chart = parse_geojson(LAKE, "f", "f")
    assert chart.frame.origin.lat_deg == pytest.approx(50.0, abs=1e-6)
    assert chart.navigable.centroid.distance(shapely.Point(0, 0)) < 0.01


@pytest.mark.parametrize(
    ("tree", "said"),
    [
        ([], "not GeoJSON"),
        ({"type": "GeometryCollection", "geometries": []}, "GeometryCollection"),
        (collection({"type": "Feature", "geometry": None}), "feature 1: no geometry"),
        (collection(LAKE, feature([box(0, 0, 1, 1)], name="X", kind="reef")), 'feature 2 "X": kind '),
        (feature([[0, 0], [1, 1]], "LineString"), "no water in it"),
        (feature([[0, 0], [1, 1]], "Curve"), "geometry is 'Curve': expected Polygon"),
        (feature([[[50.0, -101.2], [50.1, -101.2], [50.1, -101.3], [50.0, -101.2]]]), "look swapped"),
        (feature([[[200.0, 95.0], [1, 1], [2, 2], [200.0, 95.0]]]), "position 1: [200, 95] is out of range"),
        (feature([[[0, "x"], [1, 1], [2, 2], [0, "x"]]]), "expected [longitude, latitude], got [0, 'x']"),
        (feature([[[0, math.nan], [1, 1], [2, 2], [0, 0]]]), "expected [longitude, latitude]"),
        (collection(LAKE, feature([0, 0], kind="landmark")), "expected a list of positions, got 0"),
        (collection(LAKE, feature([box(-200, -200, 200, 200)], kind="keep_out")), "no water is left"),
    ],
)  # fmt: skip
def test_each_thing_that_is_wrong_gets_one_line_that_names_it(tree: object, said: str) -> None:
    with pytest.raises(MapError) as caught:
        parse_geojson(tree, "lake.geojson", "lake")
    message = str(caught.value)
    assert said in message
    assert message.startswith("lake")
    assert "\n" not in message
    assert caught.value.exit_code == 2


def test_a_map_far_from_the_origin_is_taken_for_swapped_coordinates() -> None:
    with pytest.raises(MapError, match=r"more than 100 km from the origin 10\.0000, 10\.0000"):
        parse_geojson(LAKE, "f", "f", LatLon(10.0, 10.0))


def test_a_missing_or_broken_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(MapError, match=r"nowhere\.geojson: cannot be read: No such file"):
        load_geojson(tmp_path / "nowhere.geojson")
    broken = tmp_path / "broken.geojson"
    broken.write_text('{"type":\n "Polygon",,}', encoding="utf-8")
    with pytest.raises(MapError, match=r"broken\.geojson: line 2: not JSON"):
        load_geojson(broken)
    broken.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(MapError, match="not a JSON text file"):
        load_geojson(broken)


json_values = st.recursive(
    st.none() | st.booleans() | st.floats(allow_nan=True) | st.integers() | st.text(max_size=5)
    | st.sampled_from(["Polygon", "MultiPolygon", "Feature", "FeatureCollection", "water", "Point"]),
    lambda inner: st.lists(inner, max_size=5)
    | st.dictionaries(
        st.sampled_from(["type", "coordinates", "geometry", "properties", "features", "kind", "name"]), inner
    ),
    max_leaves=25,
)  # fmt: skip


@given(tree=json_values)
def test_no_json_at_all_raises_anything_but_a_map_error(tree: object) -> None:
    try:
        chart = parse_geojson(tree, "f", "f")
    except MapError:
        return
    assert not chart.navigable.is_empty


@example(north_m=90_000.0, east_m=90_000.0, lat_deg=10.0, lon_deg=0.0)
@given(
    north_m=st.floats(-90_000, 90_000),
    east_m=st.floats(-90_000, 90_000),
    lat_deg=st.floats(-70, 70),
    lon_deg=st.floats(-179, 179),
)
def test_the_projection_is_that_of_the_boats_own_frame(
    north_m: float, east_m: float, lat_deg: float, lon_deg: float
) -> None:
    frame = LocalFrame(LatLon(lat_deg, lon_deg))
    place = frame.to_global(Point(north_m, east_m))
    projected = to_local(shapely.Point(place.lon_deg, place.lat_deg), frame.origin)
    own = frame.to_local(place)
    assert math.hypot(projected.x - own.east_m, projected.y - own.north_m) < 2e-6


@pytest.mark.parametrize("path", SHORE_FILES, ids=lambda path: path.stem)
def test_real_shorelines_load_as_they_are(path: Path) -> None:
    chart = load_geojson(path)
    assert chart.navigable.is_valid
    assert chart.navigable.area > 10_000
