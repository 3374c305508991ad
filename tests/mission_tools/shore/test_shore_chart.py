"""The map on board: what the page gets of it, ways by the water, and files that nobody should trust."""

import itertools
import json
import math
import os
import random
from pathlib import Path
from typing import Any

import pytest

from companion.core.geo import LatLon, LocalFrame, Point, distance_m
from companion.planning.segments import point_distance2
from mission_tools import geojson
from mission_tools.errors import MapError
from mission_tools.shore import chart as chart_module
from mission_tools.shore import chart_file, thinning
from mission_tools.shore.chart import CLEARANCES_M, Blocked, WaterChart, Way
from mission_tools.shore.chart_file import Shape
from mission_tools.station.messages import Place

POND = Path(__file__).parents[3] / "examples" / "maps" / "mill_pond.geojson"
FRAME = LocalFrame(LatLon(50.0, -1.2))
Ring = list[tuple[float, float]]  # east, north


def place(east_m: float, north_m: float, frame: LocalFrame = FRAME) -> Place:
    at = frame.to_global(Point(north_m, east_m))
    return Place(lat=at.lat_deg, lon=at.lon_deg)


def lon_lat(east_m: float, north_m: float, frame: LocalFrame = FRAME) -> list[float]:
    at = place(east_m, north_m, frame)
    return [at.lon, at.lat]


def polygon(*rings: Ring, frame: LocalFrame = FRAME, **properties: object) -> dict[str, Any]:
    closed = [[lon_lat(*corner, frame) for corner in [*ring, ring[0]]] for ring in rings]
    return geojson.feature("Polygon", closed, **properties)


def box(west: float, south: float, east: float, north: float) -> Ring:
    return [(west, south), (east, south), (east, north), (west, north)]


def write(path: Path, *features: object) -> Path:
    file = path / "map.geojson"
    file.write_text(json.dumps({"type": "FeatureCollection", "features": list(features)}))
    return file


def chart_of(path: Path, *features: object) -> WaterChart:
    return WaterChart(write(path, *features))


def way(chart: WaterChart, start: tuple[float, float], goal: tuple[float, float]) -> Way:
    found = chart.way(place(*start), place(*goal))
    assert isinstance(found, Way), found
    return found


def fence(*features: dict[str, Any]) -> dict[str, Any]:
    return geojson.collection(list(features))


def circle(east_m: float, north_m: float, radius_m: float, command: int) -> dict[str, Any]:
    place = lon_lat(east_m, north_m)
    return geojson.feature("Point", place, seq=0, command=command, name="", radius_m=radius_m)


def blocked(chart: WaterChart, start: tuple[float, float], goal: tuple[float, float]) -> Blocked:
    found = chart.way(place(*start), place(*goal))
    assert isinstance(found, Blocked), found
    return found


def local(points: list[tuple[float, float]]) -> list[Point]:
    return [FRAME.to_local(LatLon(lat, lon)) for lon, lat in points]


LAKE = box(0, 0, 200, 100)


def test_the_page_gets_every_feature_of_the_pond_with_its_kind_and_name() -> None:
    tree = json.loads(WaterChart(POND).geojson())
    given = json.loads(POND.read_text())
    assert tree["name"] == "Mill Pond"
    assert [f["properties"]["kind"] for f in tree["features"]] == [
        f["properties"]["kind"] for f in given["features"]
    ]
    for ours, theirs in zip(tree["features"], given["features"], strict=True):
        assert ours["geometry"]["type"] == theirs["geometry"]["type"]
        if ours["geometry"]["type"] == "Polygon":
            rings = (ours["geometry"]["coordinates"][0], theirs["geometry"]["coordinates"][0])
            assert all(a == pytest.approx(b, abs=2e-7) for a, b in zip(*rings, strict=True))


@pytest.mark.parametrize("kind", ["island", "keep_out"])
def test_a_way_goes_round_what_is_solid_and_what_to_keep_out_of(tmp_path: Path, kind: str) -> None:
    isle = box(90, 40, 110, 100)  # joined to the north shore: round its south end
    found = way(chart_of(tmp_path, polygon(LAKE), polygon(isle, kind=kind)), (20, 50), (180, 50))
    south_m = min(point.north_m for point in local(found.points))
    assert south_m == pytest.approx(40.0 - CLEARANCES_M[0], abs=1.0)
    assert south_m < 40.0 - 0.9 * CLEARANCES_M[0]


def test_a_passage_is_taken_with_the_clearance_that_it_allows(tmp_path: Path) -> None:
    def narrowed(room_m: float) -> WaterChart:
        north = polygon(box(90, 50 + 0.5 * room_m, 110, 101), man_made="pier")
        south = polygon(box(90, -1, 110, 50 - 0.5 * room_m), kind="island", name="\x00" + "x" * 500)
        return chart_of(tmp_path, polygon(LAKE, natural="water"), north, south)

    assert way(narrowed(6.0), (20, 50), (180, 50)).clearance_m == 2.0
    chart = narrowed(1.8)
    assert blocked(chart, (20, 50), (180, 50)).reason == "No way by the water leads there."
    features = [feature["properties"] for feature in json.loads(chart.geojson())["features"]]
    assert [one["kind"] for one in features] == ["water", "pier", "island"]
    assert len(features[2]["name"]) == chart_file.MOST_NAME
    assert features[2]["name"].isprintable()


def test_a_goal_ashore_is_answered_with_the_nearest_water(tmp_path: Path) -> None:
    found = blocked(chart_of(tmp_path, polygon(LAKE)), (20, 50), (100, 130))
    assert found.reason == "That place is not on the map's water."
    assert found.nearest is not None
    (near,) = local([(found.nearest.lon, found.nearest.lat)])
    assert near == pytest.approx((95.9, 100.0), abs=0.1)
    chart = chart_of(tmp_path, polygon(LAKE))
    assert isinstance(chart.way(place(20, 50), found.nearest), Way)  # and it can be gone to


def test_a_boat_at_a_pier_or_a_little_ashore_sails_off_and_one_far_ashore_does_not(tmp_path: Path) -> None:
    chart = chart_of(tmp_path, polygon(LAKE))
    for north_m in (99.8, 105.0):
        found = way(chart, (100, north_m), (100, 50))
        assert local(found.points)[0] == pytest.approx((north_m, 100.0), abs=0.05)
        assert local(found.points)[1] == pytest.approx((96.0, 100.0), abs=0.1)
    assert (
        blocked(chart, (100, 115), (100, 50)).reason
        == "The boat is not on the map's water, or outside the fence."
    )


def test_without_a_map_the_way_is_straight_and_says_that_nothing_is_known() -> None:
    chart = WaterChart(None)
    assert json.loads(chart.geojson())["features"] == []
    found = way(chart, (0, 0), (30, 40))
    assert found.length_m == pytest.approx(50.0, abs=0.01)
    assert found.clearance_m is None


def test_a_map_of_obstacles_alone_is_open_water(tmp_path: Path) -> None:
    chart = chart_of(tmp_path, polygon(box(90, 40, 110, 60), kind="obstacle"))
    found = way(chart, (20, 50), (180, 50))
    assert len(found.points) > 2
    assert found.clearance_m == CLEARANCES_M[0]
    assert len(way(chart, (-3_000, 50), (20, 50)).points) == 2


def test_in_a_models_basin_the_clearances_are_smaller_in_proportion(tmp_path: Path) -> None:
    chart = chart_of(tmp_path, polygon(box(0, 0, 10, 5)), polygon(box(4, 1, 5, 5), kind="obstacle"))
    found = way(chart, (1, 4), (9, 4))
    assert found.clearance_m == pytest.approx(0.1 * CLEARANCES_M[0], rel=1e-3)


def test_a_way_keeps_out_of_the_fences_exclusion_areas(tmp_path: Path) -> None:
    chart = chart_of(tmp_path, polygon(LAKE))
    for area in (polygon(box(90, 30, 110, 99), command=5002), circle(100, 65, 35, 5004)):
        found = chart.way(place(20, 50), place(180, 50), fence(area))
        assert isinstance(found, Way)
        assert min(point.north_m for point in local(found.points)) == pytest.approx(26.0, abs=1.0)
    assert len(way(chart, (20, 50), (180, 50)).points) == 2  # without the fence: as if it had never been


def test_a_way_stays_inside_every_inclusion_area_of_the_fence(tmp_path: Path) -> None:
    angle: Ring = [(0, 0), (200, 0), (200, 100), (160, 100), (160, 40), (40, 40), (40, 100), (0, 100)]
    inside = polygon(angle, command=5001)
    for chart in (WaterChart(None), chart_of(tmp_path, polygon(box(-50, -50, 250, 150)))):
        found = chart.way(place(20, 80), place(180, 80), fence(inside))
        assert isinstance(found, Way)
        assert found.clearance_m == CLEARANCES_M[0]
        assert min(point.north_m for point in local(found.points)) == pytest.approx(36.0, abs=1.0)
        both = fence(inside, circle(20, 80, 50, 5003))
        outside = chart.way(place(20, 80), place(180, 80), both)
        assert outside == Blocked("That place is outside the fence.")
        assert isinstance(chart.way(place(20, 80), place(20, 50), both), Way)


def test_a_goal_outside_the_fence_is_refused_as_the_boat_would(tmp_path: Path) -> None:
    chart = chart_of(tmp_path, polygon(LAKE))
    for area in (polygon(box(0, 0, 100, 100), command=5001), circle(180, 50, 10, 5004)):
        refusal = chart.way(place(20, 50), place(180, 50), fence(area))
        assert refusal == Blocked("That place is outside the fence.")


def test_a_lake_on_the_antimeridian_is_one_lake(tmp_path: Path) -> None:
    frame = LocalFrame(LatLon(-17.0, 180.0))
    chart = chart_of(tmp_path, polygon(box(-100, 0, 100, 100), frame=frame))
    found = chart.way(place(-80, 50, frame), place(80, 50, frame))
    assert isinstance(found, Way)
    assert found.length_m == pytest.approx(160.0, abs=0.05)
    assert {math.copysign(1.0, lon) for lon, _ in found.points} == {-1.0, 1.0}


def test_a_map_of_much_detail_is_thinned_and_its_ways_still_keep_clear(tmp_path: Path) -> None:
    draw = random.Random(7)  # seed 7
    count = 30_000
    shore = [
        ((900 + draw.uniform(-1, 1)) * math.cos(a), (600 + draw.uniform(-1, 1)) * math.sin(a))
        for a in (math.tau * n / count for n in range(count))
    ]
    chart = chart_of(tmp_path, polygon(shore))
    assert len(chart.geojson()) <= chart_module.MOST_CHART_BYTES
    found = way(chart, (-850, 0), (0, 550))
    ring = [Point(north, east) for east, north in shore]
    for point in local(found.points)[1:-1]:
        assert found.clearance_m is not None
        assert min(distance_m(point, corner) for corner in ring) >= found.clearance_m - 0.05


def test_thinning_keeps_within_the_error_that_it_states() -> None:
    draw = random.Random(3)  # seed 3
    line = tuple(Point(draw.gauss(0.0, 0.5), 0.3 * n) for n in range(2_000))
    (shape,), error_m = thinning.thinned([Shape("pier", "", (), (line,))], 300, 25.0)
    kept = shape.lines[0]
    assert len(kept) <= 300
    assert 0.0 < error_m < 10.0
    assert {kept[0], kept[-1]} == {line[0], line[-1]}
    for point in line:
        away_m2 = min(point_distance2(*point, *a, *b) for a, b in itertools.pairwise(kept))
        assert away_m2 <= error_m**2


HOSTILE: dict[str, tuple[bytes, str]] = {
    "empty": (b"", "not JSON"),
    "number": (b"7", "not GeoJSON"),
    "deep": (b"[" * 200_000 + b"]" * 200_000, "not JSON"),
    "long integer": (b'{"type":"Polygon","coordinates":[[[' + b"9" * 4_000 + b",1],[2,2],[3,3]]]}", ""),
    "swapped": (b'{"type":"Polygon","coordinates":[[[50,170],[50,171],[51,171]]]}', "[longitude, latitude]"),
    "a position of text": (b'{"type":"Polygon","coordinates":[["ab",[2,2],[3,3]]]}', "[longitude, latitude]"),
    "no features": (b'{"type":"FeatureCollection","features":{}}', "not GeoJSON"),
    "no water": (b'{"type":"FeatureCollection","features":[]}', "no water"),
    "unknown geometry": (b'{"type":"Feature","geometry":{"type":"Blob"}}', "expected Polygon"),
    "unknown kind": (b'{"type":"Feature","properties":{"kind":["a"]},"geometry":{"type":"Polygon"}}', "kind"),
    "half the globe": (b'{"type":"Polygon","coordinates":[[[0,0],[90,0],[90,45],[0,45]]]}', "within"),
    "pole": (b'{"type":"Polygon","coordinates":[[[0,89],[90,89],[180,89]]]}', "latitude"),
}


@pytest.mark.parametrize("case", HOSTILE)
def test_a_hostile_file_is_refused_by_name_in_one_line(tmp_path: Path, case: str) -> None:
    data, said = HOSTILE[case]
    file = tmp_path / "bad.geojson"
    file.write_bytes(data)
    with pytest.raises(MapError) as refusal:
        WaterChart(file)
    text = str(refusal.value)
    assert text.startswith(str(file))
    assert said in text
    assert "\n" not in text
    assert len(text) < len(str(file)) + 250


def test_too_many_bytes_features_or_positions_are_refused(tmp_path: Path) -> None:
    big = tmp_path / "big.geojson"
    big.write_bytes(b" " * (chart_file.MOST_BYTES + 1))
    with pytest.raises(MapError, match="more than 4 MB"):
        WaterChart(big)
    many = [{"type": "Feature", "geometry": None}] * (chart_file.MOST_FEATURES + 1)
    with pytest.raises(MapError, match="at most 2000"):
        chart_of(tmp_path, *many)
    ring = [[0.001 * math.cos(n), 0.001 * math.sin(n)] for n in range(chart_file.MOST_POSITIONS + 1)]
    tree = {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [ring]}}
    with pytest.raises(MapError, match="more than 50000 positions"):
        chart_of(tmp_path, tree)


def test_features_that_cannot_be_thinned_below_the_page_limit_are_refused(tmp_path: Path) -> None:
    isles = [
        polygon([(x, y) for x, y in box(5 * n, 5, 5 * n + 1, 6)], kind="island", name="y" * 60)
        for n in range(1_500)
    ]
    with pytest.raises(MapError, match="at most 150 kB"):
        chart_of(tmp_path, polygon(box(0, 0, 8_000, 100)), *isles)


def test_what_is_no_file_is_refused(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)  # reading it would wait for ever
    for path in (tmp_path, tmp_path / "missing.geojson", pipe):
        with pytest.raises(MapError, match="no such file"):
            WaterChart(path)


def test_random_json_never_raises_anything_else(tmp_path: Path) -> None:
    draw = random.Random(11)  # seed 11
    pool: list[Any] = [None, True, -1, 1e300, "", "Polygon", "Point", "water", [], {}, [0, 0], [[[0, 0]]]]
    keys = ["type", "features", "geometry", "geometries", "coordinates", "properties", "kind", "crs", "name"]

    def tree(depth: int) -> Any:  # noqa: ANN401 (any JSON)
        roll = draw.random()
        if depth == 0 or roll < 0.2:
            return draw.choice(pool)
        if roll < 0.4:
            return [tree(depth - 1) for _ in range(draw.randrange(4))]
        return {
            "type": draw.choice(["FeatureCollection", "Feature", "Polygon", "GeometryCollection", "Point"]),
            **{draw.choice(keys): tree(depth - 1) for _ in range(4)},
            "features": [tree(depth - 1)],
        }

    for _ in range(2_000):
        file = tmp_path / "any.geojson"
        file.write_text(json.dumps(tree(4)))
        try:
            WaterChart(file)
        except MapError as refusal:
            assert str(refusal).startswith(str(file))  # noqa: PT017
