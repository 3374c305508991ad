"""Broken shapes as real exports have them: what becomes of them, and what is said about it."""

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
import shapely
from drawn_maps import Corners, Json, chart_of, feature, is_inside, positions, ring
from hypothesis import example, given
from hypothesis import strategies as st

from companion.core.geo import LatLon, Point
from mission_tools.errors import MapError
from mission_tools.maps import load_source
from mission_tools.maps.geojson import parse_geojson

LAKE = [(-200, -100), (200, -100), (200, 100), (-200, 100)]


@pytest.mark.parametrize(
    ("line", "square_m", "said"),
    [
        ([(-200, -100), (200, 100), (200, -100), (-200, 100)], 40_000, "repaired, nothing of water left out"),
        ([*LAKE[:3], (0, 100), (0, 160), (0, 100), LAKE[3]], 80_000, "repaired, nothing of water left out"),
        ([*LAKE[:3], (0, 100), (-50, 0), (50, 0), (0, 100), LAKE[3]], 75_000, "5000 m² of water left out"),
    ],
    ids=["a bow tie", "a spike outwards", "a ring that touches itself round an island"],
)
def test_a_line_that_crosses_or_touches_itself_is_repaired_with_a_note(
    line: Corners, square_m: float, said: str
) -> None:
    chart = chart_of(feature([ring(line)], name="Lake"))
    assert chart.water.area == pytest.approx(square_m, rel=1e-4)
    (note,) = chart.notes
    assert note.startswith('f: feature 1 "Lake": its line crosses or touches itself at lat ')
    assert said in note


def test_a_spike_into_the_water_stays_land_and_a_tiny_one_goes() -> None:
    spiked = [*LAKE[:3], (0, 100), (0, 20), (0, 100), LAKE[3]]
    chart = chart_of(feature([ring(spiked)]))
    assert chart.leg_clearance_m(Point(50.0, -50.0), Point(50.0, 50.0)) == 0.0
    assert "a spike of 80.0 m into the water at lat 50." in chart.notes[1]
    tiny = [*LAKE[:3], (0, 100), (0, 99.5), (0, 100), LAKE[3]]
    assert len(chart_of(feature([ring(tiny)])).notes) == 1


def test_an_island_drawn_as_a_bow_tie_is_land_for_any_order_of_its_corners() -> None:
    bow = [(-20, -20), (20, 20), (20, -20), (-20, 20)]
    chart = chart_of(feature([ring(LAKE)]), feature([ring(bow)], kind="island", name="Isle"))
    assert chart.obstruction(Point(15.0, 0.0)) == "on Isle"
    assert chart.water.area == pytest.approx(400 * 200 - 40 * 40, rel=1e-4)
    assert "800 m² of water taken as land" in chart.notes[0]


def test_land_whose_line_barely_crosses_itself_keeps_its_shape_and_its_parts_are_joined() -> None:
    """An L whose corner is overshot by 0.2 m; and two parts that overlap."""
    bent = [(-20, 20), (-20, -20.2), (-20.2, -20), (20, -20), (20, 0), (0, 0), (0, 20)]
    chart = chart_of(feature([ring(LAKE)]), feature([ring(bent)], kind="island"))
    assert chart.obstruction(Point(-10.0, 10.0)) == "on island"
    assert chart.obstruction(Point(10.0, 10.0)) is None
    parts = [[ring([(0, 0), (30, 0), (30, 10), (0, 10)])], [ring([(20, 5), (50, 5), (50, 40), (20, 40)])]]
    chart = chart_of(feature([ring(LAKE)]), feature(parts, "MultiPolygon", kind="island"))
    assert chart.water.area == pytest.approx(80_000 - 300 - 1050 + 50, rel=1e-4)


def test_an_unclosed_ring_is_closed_and_says_where_it_was_open() -> None:
    chart = chart_of(feature([positions(LAKE)]))
    assert chart.water.area == pytest.approx(80_000, rel=1e-4)
    assert chart.notes[0].startswith("f: feature 1, ring 1: not closed: ends at lat 50.000899")


def test_a_hole_that_reaches_beyond_the_shore_or_lies_outside_is_land() -> None:
    jetty = [(-5, 50), (5, 50), (5, 150), (-5, 150)]
    elsewhere = [(300, 0), (310, 0), (310, 10), (300, 10)]
    chart = chart_of(feature([ring(LAKE), ring(jetty), ring(elsewhere)]))
    assert chart.water.area == pytest.approx(80_000 - 10 * 50, rel=1e-4)
    assert "hole 1: reaches beyond its outline at lat 50.0" in chart.notes[0]
    assert "hole 2: reaches beyond" in chart.notes[1]


def test_a_part_within_another_part_is_an_island_whose_hole_is_missing() -> None:
    isle = [(-20, -20), (20, -20), (20, 20), (-20, 20)]
    chart = chart_of(feature([[ring(LAKE)], [ring(isle)]], "MultiPolygon", kind="water"))
    assert chart.obstruction(Point(0.0, 0.0)) == "on land"
    assert "part 2 lies within part 1" in chart.notes[0]
    assert "1600 m² taken as an island" in chart.notes[0]


@pytest.mark.parametrize(
    ("beside", "said"),
    [
        ({"type": "Feature", "properties": {}, "geometry": None}, "feature 2: no geometry: skipped"),
        (feature([], name="Void"), 'feature 2 "Void": empty geometry: skipped'),
        (feature([[]]), "feature 2, ring 1: empty ring: skipped"),
        (feature(positions([(0, 0)])[0], "Point", name="Buoy"), '"Buoy": a Point, which encloses no water'),
        (feature(positions([(0, 0), (9, 9)]), "LineString"), "a LineString, which encloses no water"),
        (feature([ring([(0, 0), (9, 9)])]), "feature 2, ring 1: 3 positions: a closed ring has at least 4"),
        (feature([ring([(0, 0), (9, 9), (18, 18)])]), "feature 2: encloses nothing: skipped"),
    ],
)  # fmt: skip
def test_what_encloses_nothing_is_skipped_with_a_note(beside: Json, said: str) -> None:
    chart = chart_of(feature([ring(LAKE)]), beside)
    assert chart.water.area == pytest.approx(80_000, rel=1e-4)
    assert said in chart.notes[0]
    assert len(chart.notes) == 1


@pytest.mark.parametrize(
    ("geometry", "corners"),
    [("Point", positions([(0, 0)])[0]), ("LineString", positions([(0, -100), (0, 60)]))],
)
@pytest.mark.parametrize("said", [{"kind": "obstacle"}, {"natural": "rock"}, {"man_made": "pier"}])
def test_a_point_or_line_that_says_it_is_solid_is_never_sailed_over(
    geometry: str, corners: Sequence[Any], said: Json
) -> None:
    chart = chart_of(feature([ring(LAKE)]), feature(corners, geometry, **said))
    assert chart.leg_clearance_m(Point(0.0, -50.0), Point(0.0, 50.0)) == 0.0
    assert 0.0 < 80_000 - chart.water.area < 60.0


def test_a_byte_order_mark_and_capitals_in_the_suffix_are_read(tmp_path: Path) -> None:
    path = tmp_path / "LAKE.GEOJSON"
    path.write_text("\ufeff" + json.dumps(feature([ring(LAKE)])), encoding="utf-8")
    assert load_source(str(path)).chart.water.area == pytest.approx(80_000, rel=1e-4)


coordinate = st.integers(-10, 10).map(lambda n: 10.0 * n)
lines = st.lists(st.tuples(coordinate, coordinate), min_size=3, max_size=9)


@example(  # edges that are sailed twice
    line=[(80, -60), (80, 140), (140, -140), (80, 140), (-100, -140), (120, -80), (-60, 100), (140, -40)],
    east=99.4,
    north=31.5,
)
@given(line=lines, east=st.floats(-99, 99), north=st.floats(-99, 99))
def test_repaired_water_is_never_outside_of_the_even_odd_rule(
    line: Corners, east: float, north: float
) -> None:
    try:
        chart = chart_of(feature([ring(line)]))
    except MapError:
        return
    outline = shapely.LineString([*line, line[0]])
    if chart.clearance_m(Point(north, east)) > 0.0 and outline.distance(shapely.Point(east, north)) > 0.01:
        assert is_inside(line, east, north)


@given(line=lines, east=st.floats(-99, 99), north=st.floats(-99, 99))
def test_repaired_land_is_never_less_than_the_even_odd_rule(line: Corners, east: float, north: float) -> None:
    around = [(-150, -150), (150, -150), (150, 150), (-150, 150)]
    chart = chart_of(feature([ring(around)], kind="water"), feature([ring(line)], kind="island"))
    outline = shapely.LineString([*line, line[0]])
    if is_inside(line, east, north) and outline.distance(shapely.Point(east, north)) > 0.01:
        assert chart.obstruction(Point(north, east)) == "on island"


# Across the antimeridian, near the pole, and with long edges

WEST, EAST = 179.995, -179.995
SPELLINGS = {
    "cut": feature(
        [
            [[[WEST, -17.0], [180.0, -17.0], [180.0, -16.995], [WEST, -16.995], [WEST, -17.0]]],
            [[[-180.0, -17.0], [EAST, -17.0], [EAST, -16.995], [-180.0, -16.995], [-180.0, -17.0]]],
        ],
        "MultiPolygon",
    ),
    "jump": feature([[[WEST, -17.0], [EAST, -17.0], [EAST, -16.995], [WEST, -16.995], [WEST, -17.0]]]),
    "beyond 180": feature(
        [[[WEST, -17.0], [180.005, -17.0], [180.005, -16.995], [WEST, -16.995], [WEST, -17.0]]]
    ),
    "beyond -180": feature(
        [[[-180.005, -17.0], [EAST, -17.0], [EAST, -16.995], [-180.005, -16.995], [-180.005, -17.0]]]
    ),
}


@pytest.mark.parametrize("spelling", SPELLINGS)
def test_every_spelling_of_a_lake_across_the_antimeridian_is_one_piece_of_water(spelling: str) -> None:
    chart = parse_geojson(SPELLINGS[spelling], "f", "f")
    width_m = math.radians(0.01) * 6378137.0 * math.cos(math.radians(16.9975))
    height_m = math.radians(0.005) * 6336870.0  # meridian radius at 17° (Snyder, equation 4-18)
    assert len(shapely.get_parts(chart.navigable)) == 1
    assert chart.navigable.area == pytest.approx(width_m * height_m, rel=2e-3)
    start = chart.frame.to_local(LatLon(-16.998, 179.996))
    goal = chart.frame.to_local(LatLon(-16.997, -179.996))
    assert chart.reaches(LatLon(-16.998, 179.996))
    assert chart.reaches(LatLon(-16.997, -179.996))
    assert chart.is_clear(start, goal, 4.0)
    assert abs(abs(chart.frame.origin.lon_deg) - 180.0) < 1e-9


@pytest.mark.parametrize("share", [0.05, 0.25, 0.5, 0.8])
@pytest.mark.parametrize(
    ("start", "end"), [((9.7, 50.0), (10.3, 50.0)), ((9.8, 49.9), (10.2, 50.1)), ((0.0, 84.0), (2.0, 84.0))]
)
def test_a_long_edge_is_straight_in_longitude_and_latitude(
    start: tuple[float, float], end: tuple[float, float], share: float
) -> None:
    """RFC 7946, 3.1.1: a line between two positions is straight in its coordinates."""
    (west, south), (east, north) = start, end
    top = max(south, north) + 0.2
    chart = parse_geojson(feature([[[west, south], [east, north], [east, top], [west, top], [west, south]]]),
                          "f", "f")  # fmt: skip
    on_edge = LatLon(south + share * (north - south), west + share * (east - west))
    at = chart.frame.to_local(on_edge)
    assert chart.shores.distance(shapely.Point(at.east_m, at.north_m)) < 0.03


def test_a_map_of_half_the_world_is_refused_with_its_extent() -> None:
    with pytest.raises(
        MapError, match=r"f: its water spans 0 to 20 east and 50 to 50\.1 north: more than 9°"
    ):
        parse_geojson(feature([[[0, 50], [20, 50], [20, 50.1], [0, 50.1], [0, 50]]]), "f", "f")


def test_a_mainland_that_reaches_far_beyond_the_water_is_cut_to_what_lies_near() -> None:
    mainland = feature([[[-60, -40], [-1.2, -40], [-1.2, 70], [-60, 70], [-60, -40]]], natural="land")
    far = feature([[[5, 5], [6, 5], [6, 6], [5, 5]]], natural="land", name="Far")
    chart = chart_of(feature([ring(LAKE)], kind="water"), mainland, far)
    assert chart.water.area == pytest.approx(40_000, rel=1e-3)
    assert [named.name for named in chart.features] == ["island"]


def test_a_place_11_m_off_a_shore_of_40_km_is_afloat() -> None:
    """A lake of 100 km with an island of 40 km by 200 m, whose corners are placed by round figures."""

    def box(half_east_m: float, half_north_m: float) -> list[list[float]]:
        east, north = half_east_m / (111_320.0 * math.cos(math.radians(50.0))), half_north_m / 111_229.0
        return [[10 + x * east, 50 + y * north] for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1))]

    chart = parse_geojson(feature([box(50_000.0, 50_000.0), box(20_000.0, 100.0)[::-1]]), "f", "f")
    off_shore = chart.frame.to_local(LatLon(49.9990, 10.0))
    assert chart.clearance_m(off_shore) == pytest.approx(0.0010 * 111_229.0 - 100.0, abs=0.1)
