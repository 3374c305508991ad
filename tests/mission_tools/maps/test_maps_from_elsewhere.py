"""Maps as GIS programs and OpenStreetMap write them: islands without a kind, other reference systems."""

import math

import pytest
from drawn_maps import ORIGIN, Json, box, collection, feature, is_inside, positions

from companion.core.geo import Point
from mission_tools import geojson
from mission_tools.assembly.areas import parse_areas
from mission_tools.errors import MapError
from mission_tools.maps.geojson import parse_geojson
from mission_tools.mission.mission import FencePolygon

START, GOAL = Point(50.0, -150.0), Point(-50.0, 150.0)


def named(name: str) -> Json:
    return {"crs": {"type": "name", "properties": {"name": name}}}


LAKE = box(-200, -100, 200, 100)
ISLE = box(-20, -80, 20, 80)


@pytest.mark.parametrize(
    ("tags", "name"),
    [
        ({"natural": "land", "place": "island", "name": "Isle"}, "Isle"),
        ({"place": "islet"}, "island"),
        ({"natural": "coastline"}, "island"),
        ({"natural": "wood"}, "island"),
        ({"man_made": "pier"}, "pier"),
        ({"building": "yes"}, "obstacle"),
    ],
)
@pytest.mark.parametrize("lake_tags", [{"natural": "water"}, {}])
def test_what_openstreetmap_calls_land_or_a_structure_is_never_sailed_over(
    tags: Json, name: str, lake_tags: Json
) -> None:
    chart = parse_geojson(collection(feature([LAKE], **lake_tags), feature([ISLE], **tags)), "f", "f")
    assert chart.obstruction(Point(0.0, 0.0)) == f"on {name}"
    assert chart.leg_clearance_m(START, GOAL) == 0.0
    assert chart.obstruction(START) is None


@pytest.mark.parametrize("order", [1, -1])
@pytest.mark.parametrize("lake_kind", [{}, {"kind": "water"}, {"natural": "water"}])
def test_a_shape_in_the_lake_that_does_not_say_what_it_is_is_asked_about(order: int, lake_kind: Json) -> None:
    features = [feature([LAKE], name="Lake", **lake_kind), feature([ISLE], name="Isle")][::order]
    with pytest.raises(MapError) as told:
        parse_geojson(collection(*features), "m.geojson", "m")
    assert '"Isle": lies within feature' in str(told.value)
    assert '"Lake"' in str(told.value)
    assert "add the property kind" in str(told.value)


@pytest.mark.parametrize("said", [{"kind": "water"}, {"natural": "water"}, {"waterway": "dock"}])
def test_water_in_water_that_says_so_is_sailed_over(said: Json) -> None:
    chart = parse_geojson(collection(feature([LAKE]), feature([ISLE], **said)), "f", "f")
    assert chart.leg_clearance_m(START, GOAL) > 10.0


@pytest.mark.parametrize(("east_m", "is_asked"), [(101.0, False), (99.0, True)])
def test_two_pieces_of_a_lake_that_overlap_by_less_than_half_are_joined(
    east_m: float, is_asked: bool
) -> None:
    arm = box(east_m, -50, east_m + 200.0, 50)
    tree = collection(feature([LAKE]), feature([arm]))
    if is_asked:
        with pytest.raises(MapError, match="lies within feature 1"):
            parse_geojson(tree, "f", "f")
    else:
        chart = parse_geojson(tree, "f", "f")
        assert chart.water.area == pytest.approx(400 * 200 + 100 * (east_m + 200 - 200), rel=0.01)


def test_tags_that_say_neither_water_nor_land_are_asked_about() -> None:
    with pytest.raises(MapError, match=r"feature 2.*natural=glacier says neither water nor land"):
        parse_geojson(collection(feature([LAKE]), feature([ISLE], natural="glacier")), "f", "f")


# Reference systems. The expected places come from national control data, not from PROJ:
# the false origin of UTM and the worked example of web Mercator in EPSG Guidance Note 7-2.


def mercator(lon_deg: float, lat_deg: float) -> list[float]:
    """EPSG:3857 by its definition (EPSG Guidance Note 7-2, method 1024)."""
    radius_m = 6378137.0
    north = radius_m * math.log(math.tan(math.pi / 4.0 + math.radians(lat_deg) / 2.0))
    return [radius_m * math.radians(lon_deg), north]


@pytest.mark.parametrize("name", ["urn:ogc:def:crs:EPSG::3857", "EPSG:3857"])
def test_web_mercator_is_transformed(name: str) -> None:
    tree = collection(feature([[mercator(*corner) for corner in LAKE]]), **named(name))
    chart = parse_geojson(tree, "f", "f")
    assert chart.frame.origin.lat_deg == pytest.approx(ORIGIN.lat_deg, abs=1e-6)
    assert chart.frame.origin.lon_deg == pytest.approx(ORIGIN.lon_deg, abs=1e-6)
    assert chart.water.area == pytest.approx(400.0 * 200.0, rel=0.01)


def test_utm_is_transformed() -> None:
    """On zone 32's central meridian the easting is 500 km and the northing 0.9996 of the meridian arc."""
    meridian_arc_m = 5540847.0416  # equator to 50° N on WGS 84 (Helmert's series)
    north_m = 0.9996 * meridian_arc_m
    ring = [[500_000.0 + e, north_m + n] for e, n in ((-50, -40), (50, -40), (50, 40), (-50, 40), (-50, -40))]
    chart = parse_geojson(collection(feature([ring]), **named("urn:ogc:def:crs:EPSG::32632")), "f", "f")
    assert chart.frame.origin.lon_deg == pytest.approx(9.0, abs=1e-7)
    assert chart.frame.origin.lat_deg == pytest.approx(50.0, abs=1e-6)


@pytest.mark.parametrize("name", ["urn:ogc:def:crs:OGC:1.3:CRS84", "urn:ogc:def:crs:EPSG::4326", "EPSG:4326"])
def test_wgs_84_by_any_name_stays_as_it_is(name: str) -> None:
    plain = parse_geojson(collection(feature([LAKE])), "f", "f")
    chart = parse_geojson(collection(feature([LAKE]), **named(name)), "f", "f")
    assert chart.frame.origin == plain.frame.origin
    assert chart.water.equals(plain.water)


@pytest.mark.parametrize(
    ("crs", "said"),
    [
        (
            named("urn:ogc:def:crs:EPSG::4267"),
            r'm.geojson: crs "urn:ogc:def:crs:EPSG::4267" \(NAD27\): no trans',
        ),
        (named("EPSG:999999"), 'crs "EPSG:999999" is not known; convert the file to WGS 84'),
        (
            {"crs": {"type": "link", "properties": {"href": "x.prj"}}},
            "is not the name of one; convert the file",
        ),
        ({"crs": 7}, "crs 7 is not the name of one"),
    ],
)
def test_a_reference_system_that_is_unknown_here_is_refused_by_name(crs: Json, said: str) -> None:
    with pytest.raises(MapError, match=said):
        parse_geojson(collection(feature([LAKE]), **crs), "m.geojson", "m")


def test_a_transformation_of_nine_metres_is_refused_with_its_accuracy() -> None:
    """NAD27 in Maine, without the grid files that PROJ's wheels leave out."""
    ring = [[-69.0, 45.0], [-68.99, 45.0], [-68.99, 45.01], [-69.0, 45.01], [-69.0, 45.0]]
    with pytest.raises(
        MapError, match=r"\(NAD27\): can be transformed to WGS 84 only to 9 m here, expected 5 m"
    ):
        parse_geojson(collection(feature([ring]), **named("EPSG:4267")), "f", "f")


def test_a_grid_whose_numbers_look_like_degrees_is_not_taken_for_degrees() -> None:
    """A few metres from the British grid's corner: at sea, outside of what the grid is defined for."""
    ring = [[1.0, 1.0], [3.0, 1.0], [3.0, 2.0], [1.0, 2.0], [1.0, 1.0]]
    with pytest.raises(MapError, match=r"EPSG::27700.*British National Grid\): no transformation to WGS 84"):
        parse_geojson(collection(feature([ring]), **named("urn:ogc:def:crs:EPSG::27700")), "f", "f")


def test_a_fence_in_another_reference_system_is_transformed_too() -> None:
    fence, *_ = parse_areas(collection(feature([[mercator(*c) for c in LAKE]]), **named("EPSG:3857")), "f")
    (polygon,) = fence.polygons
    assert polygon.corners[0].lat_deg == pytest.approx(LAKE[0][1], abs=1e-9)


# A fence from a map


def holds(polygon: FencePolygon, east_m: float, north_m: float) -> bool:
    """Whether a place lies inside."""
    ((lon_deg, lat_deg),) = positions([(east_m, north_m)])
    return is_inside([(corner.lon_deg, corner.lat_deg) for corner in polygon.corners], lon_deg, lat_deg)


@pytest.mark.parametrize("lake", [{"kind": "water"}, {"natural": "water"}])
def test_a_map_is_a_fence_outline_inside_islands_and_keep_outs_outside(lake: Json) -> None:
    rocks, swimmers = box(100, -80, 110, -70), box(-180, -90, -150, -60)
    tree = collection(
        feature([LAKE, ISLE[::-1]], **lake),
        feature([rocks], kind="obstacle"),
        feature([swimmers], kind="swimming", name="Beach"),
        geojson.feature("Point", positions([(0, 120)])[0], kind="landmark", name="Mill"),
    )
    fence, rally, _ = parse_areas(tree, "f")
    assert rally == ()
    assert [polygon.inclusion for polygon in fence.polygons] == [True, False, False, False]
    assert fence.circles == ()
    outline, *closed = fence.polygons
    assert holds(outline, -150, 50)
    assert not holds(outline, 210, 0)
    for inside in ((0, 0), (105, -75), (-160, -75)):
        assert [polygon for polygon in closed if holds(polygon, *inside)]
    assert not [polygon for polygon in closed if holds(polygon, -150, 50)]


def test_pieces_of_one_water_are_joined_and_two_waters_are_no_fence() -> None:
    joined = collection(feature([LAKE], kind="water"), feature([box(150, -50, 350, 50)], kind="water"))
    fence, *_ = parse_areas(joined, "f")
    (outline,) = fence.polygons
    assert holds(outline, -150, 0)
    assert holds(outline, 300, 0)
    apart = collection(feature([LAKE], kind="water"), feature([box(250, -50, 350, 50)], kind="water"))
    with pytest.raises(MapError, match="f: 2 separate pieces of water"):
        parse_areas(apart, "f")
