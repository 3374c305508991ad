"""Maps of every format, written by other programs or by hand after the format's own rules."""

import sys
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from data_files import SHORES
from hypothesis import example, given
from hypothesis import strategies as st
from PIL import Image
from pyproj import Geod
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from companion.core.geo import LatLon, Point
from mission_tools.errors import MapError
from mission_tools.maps import load_map, load_source
from mission_tools.maps.assemble import chart_of
from mission_tools.maps.chart import Chart
from mission_tools.maps.formats.georeference import georeference_of
from mission_tools.maps.formats.gpx import parse_gpx
from mission_tools.maps.formats.kml import parse_kml
from mission_tools.maps.formats.mask import outlines
from mission_tools.maps.geojson import load_geojson
from mission_tools.maps.map_files import MAP_SUFFIXES
from mission_tools.mission.mission import Fence, FencePolygon, Mission, MissionItem
from mission_tools.mission.plan_file import save_mission

pytestmark = pytest.mark.slow

GEOTIFFS = Path(__file__).parents[2] / "vectors" / "maps"  # written by GDAL 3.9 through rasterio 1.4.4

WEST, SOUTH, EAST, NORTH = 10.0, 50.0, 10.004, 50.002
LAKE = Polygon([(WEST, SOUTH), (EAST, SOUTH), (EAST, NORTH), (WEST, NORTH)])
ISLE = Polygon([(10.001, 50.0005), (10.002, 50.0005), (10.002, 50.001), (10.001, 50.001)])
LAKE_M2 = 286.68 * 222.46  # 0.004° × 0.002° at 50.001° (Snyder, equations 4-18 and 4-20)
ISLE_M2 = LAKE_M2 / 16.0
OUTLINE = "10,50 10.004,50 10.004,50.002 10,50.002 10,50"
ISLE_OUTLINE = "10.001,50.0005,0 10.002,50.0005,0 10.002,50.001,0 10.001,50.001,0 10.001,50.0005,0"


def is_afloat(chart: Chart, lat_deg: float, lon_deg: float) -> bool:
    return chart.clearance_m(chart.frame.to_local(LatLon(lat_deg, lon_deg))) > 0.0


def has_the_isle(chart: Chart) -> bool:
    """The lake is the chart's water, and the island is not."""
    return (
        chart.water.area == pytest.approx(LAKE_M2 - ISLE_M2, rel=1e-3)
        and is_afloat(chart, 50.0002, 10.0015)
        and not is_afloat(chart, 50.00075, 10.0015)
    )


def polygon(outline: str, *holes: str) -> str:
    inner = "".join(
        f"<innerBoundaryIs><LinearRing><coordinates>{hole}</coordinates></LinearRing></innerBoundaryIs>"
        for hole in holes
    )
    return (
        f"<Polygon><outerBoundaryIs><LinearRing><coordinates>{outline}</coordinates></LinearRing>"
        f"</outerBoundaryIs>{inner}</Polygon>"
    )


def kml(*placemarks: str, prefix: str = "") -> bytes:
    head = f'<?xml version="1.0" encoding="UTF-8"?>{prefix}<kml xmlns="http://www.opengis.net/kml/2.2"><Document>'
    return f"{head}{''.join(placemarks)}</Document></kml>".encode()


LAKE_MARK = f"<Placemark><name>Lake</name>{polygon(OUTLINE)}</Placemark>"
KIND_DATA = '<ExtendedData><Data name="kind"><value>island</value></Data></ExtendedData>'
ISLES = {
    "a hole": kml(f"<Placemark>{polygon(OUTLINE, ISLE_OUTLINE)}</Placemark>"),
    "extended data": kml(LAKE_MARK, f"<Placemark>{KIND_DATA}{polygon(ISLE_OUTLINE)}</Placemark>"),
    "a folder": kml(
        LAKE_MARK, f"<Folder><name>Islands</name><Placemark>{polygon(ISLE_OUTLINE)}</Placemark></Folder>"
    ),
    "a description": kml(
        LAKE_MARK, f"<Placemark><description>kind: island</description>{polygon(ISLE_OUTLINE)}</Placemark>"
    ),
    "a multigeometry": kml(
        f"<Placemark><MultiGeometry>{polygon(OUTLINE)}{polygon(ISLE_OUTLINE)}</MultiGeometry></Placemark>"
    ),
    "nothing but its place": kml(LAKE_MARK, f"<Placemark>{polygon(ISLE_OUTLINE)}</Placemark>"),
}


@pytest.mark.parametrize("spelling", ISLES)
def test_an_island_in_kml_is_land_however_it_says_so(spelling: str, tmp_path: Path) -> None:
    path = tmp_path / "Lake.KML"
    path.write_bytes(ISLES[spelling])
    chart = load_map(path)
    assert has_the_isle(chart)
    assert bool(chart.notes) == (spelling in ("a multigeometry", "nothing but its place"))


def test_a_pier_drawn_as_a_line_in_kml_is_solid() -> None:
    line = "<LineString><coordinates>10.001,50 10.001,50.001</coordinates></LineString>"
    pier = f"<Placemark>{KIND_DATA.replace('island', 'pier')}{line}</Placemark>"
    chart = chart_of(parse_kml(kml(LAKE_MARK, pier, "<Placemark><Model/></Placemark>"), "f"))
    assert not is_afloat(chart, 50.0005, 10.001)
    assert ["a Model, which encloses no water: skipped" in note for note in chart.notes] == [True]


def test_a_kmz_is_read_and_one_that_unpacks_to_too_much_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "lake.kmz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("images/icon.png", b"")
        archive.writestr("doc.kml", ISLES["a hole"])
    assert has_the_isle(load_map(path))
    monkeypatch.setattr("mission_tools.maps.formats.kml.MAX_FILE_BYTES", 1000)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("doc.kml", b" " * 1_000_000)
    with pytest.raises(MapError, match=r"lake.kmz: doc.kml unpacks to more than"):
        load_map(path)
    path.write_bytes(b"PK\3\4 nothing else")
    with pytest.raises(MapError, match="not a KMZ archive"):
        load_map(path)


@pytest.mark.parametrize("read", [parse_kml, parse_gpx])
@pytest.mark.parametrize(
    "text",
    [
        b'<!DOCTYPE kml [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;">]><kml>&b;</kml>',
        b'<!DOCTYPE gpx SYSTEM "file:///etc/passwd"><gpx/>',
    ],
)
def test_a_document_type_is_refused(read: Callable[[bytes, str], object], text: bytes) -> None:
    with pytest.raises(MapError, match=r"f: has a document type"):
        read(text, "f")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (b"", "not XML"),
        (b"<kml><Placemark>", "f: line 1: not XML: no element found"),
        (b"<svg/>", "f: not KML: its root is <svg>"),
        (kml("<Placemark><name>A</name>" + polygon("10,50 x,50 3,4") + "</Placemark>"),
         "f: placemark 1 \"A\", ring 1, position 2: 'x,50': expected lon,lat"),
        (kml("<Placemark>" + polygon("10,150 11,50 11,52 10,150") + "</Placemark>"), "[10, 150] is out of"),
        (b"<kml>" + b"<Folder>" * 200, "nested too deep"),
    ],
)  # fmt: skip
def test_kml_that_cannot_be_read_is_named_with_the_place(text: bytes, said: str) -> None:
    with pytest.raises(MapError) as caught:
        parse_kml(text, "f")
    assert said in str(caught.value)


def gpx_points(outline: str, tag: str) -> str:
    pairs = (corner.split(",")[:2] for corner in outline.split())
    return "".join(f'<{tag} lat="{lat}" lon="{lon}"/>' for lon, lat in pairs)


def test_gpx_outlines_are_water_and_islands(tmp_path: Path) -> None:
    path = tmp_path / "lake.gpx"
    shore, isle = gpx_points(OUTLINE, "trkpt"), gpx_points(ISLE_OUTLINE, "rtept")
    open_line = gpx_points("10.003,50.0005 10.0035,50.0005 10.0035,50.001", "trkpt")
    path.write_text(
        '<gpx version="1.1" creator="x" xmlns="http://www.topografix.com/GPX/1/1"><wpt lat="50" lon="10"/>'
        f"<rte><name>Isle</name><type>island</type>{isle}</rte>"
        f"<trk><name>Lake</name><trkseg>{shore}</trkseg><trkseg>{open_line}</trkseg></trk></gpx>"
    )
    chart = load_map(path, lines_are_outlines=True)
    assert has_the_isle(chart)
    assert chart.name == "Lake"
    assert any("segment 2" in note and "no outline: skipped" in note for note in chart.notes)
    assert any("1 waypoint, " in note for note in chart.notes)


def test_a_walked_shore_that_does_not_quite_close_is_closed_and_says_so(tmp_path: Path) -> None:
    path = tmp_path / "lake.gpx"
    walked = gpx_points(OUTLINE.replace(" 10,50.002 10,50", " 10,50.002 10,50.0001"), "trkpt")
    path.write_text(f"<gpx><trk><trkseg>{walked}</trkseg></trk></gpx>")
    chart = load_map(path, lines_are_outlines=True)
    assert chart.water.area == pytest.approx(LAKE_M2, rel=1e-3)
    assert "ends 11.1 m from its beginning: closed" in chart.notes[0]


@pytest.mark.parametrize("tags", ["rte rtept", "trk><trkseg trkpt"])
def test_a_way_round_an_island_is_no_lake_unless_it_says_so(tmp_path: Path, tags: str) -> None:
    """As OpenCPN writes a route that ends near its beginning."""
    line, point = tags.split(" ")
    end = "".join(f"</{tag}>" for tag in reversed(line.split("><")))
    path = tmp_path / "around.gpx"
    for kind, opens in (("", False), ("<type>water</type>", True)):
        first, *segment = line.split("><")
        begin = f"<{first}><name>Around Orcas</name>{kind}" + "".join(f"<{tag}>" for tag in segment)
        path.write_text(f"<gpx creator='OpenCPN'>{begin}{gpx_points(OUTLINE, point)}{end}</gpx>")
        if opens:
            assert load_map(path).water.area == pytest.approx(LAKE_M2, rel=1e-3)
        else:
            with pytest.raises(
                MapError, match=r'"Around Orcas": a way, not an outline \(--as-route sails it'
            ):
                load_map(path)
            assert load_map(path, lines_are_outlines=True).water.area == pytest.approx(LAKE_M2, rel=1e-3)


@pytest.mark.parametrize("lon_deg", [10.0, 179.9])
def test_a_long_edge_of_kml_is_a_geodesic(lon_deg: float) -> None:
    ends = (lon_deg - 0.3, 50.0), (lon_deg + 0.3, 50.05)
    outline = [*ends, (ends[1][0], 50.3), (ends[0][0], 50.3), ends[0]]
    text = kml(f"<Placemark>{polygon(' '.join(f'{lon},{lat}' for lon, lat in outline))}</Placemark>")
    chart = chart_of(parse_kml(text, "f"))
    for lon, lat in Geod(ellps="WGS84").npts(*ends[0], *ends[1], 7):
        at = chart.frame.to_local(LatLon(lat, lon))
        assert chart.shores.distance(shapely.Point(at.east_m, at.north_m)) < 0.02


# Missions' fences


def corners(shape: Polygon) -> tuple[LatLon, ...]:
    return tuple(LatLon(lat, lon) for lon, lat in list(shape.exterior.coords)[:-1])


def test_the_fence_of_a_plan_is_the_water(tmp_path: Path) -> None:
    path = tmp_path / "lake.plan"
    fence = Fence((FencePolygon(corners(LAKE)), FencePolygon(corners(ISLE), inclusion=False)))
    save_mission(Mission((), fence=fence), path)
    chart = load_map(path)
    assert chart.navigable.area == pytest.approx(LAKE_M2 - ISLE_M2, rel=1e-3)
    assert not is_afloat(chart, 50.00075, 10.0015)
    assert not is_afloat(chart, 50.0021, 10.0015)


def test_a_mission_without_a_fence_is_no_map(tmp_path: Path) -> None:
    path = tmp_path / "m.plan"
    save_mission(Mission((MissionItem.at(LatLon(50.0, 10.0)),)), path)
    with pytest.raises(MapError, match="a mission without a fence says nothing about where the water is"):
        load_map(path)


# GDAL's formats, written by GDAL


def write(path: Path, shapes: list[BaseGeometry], driver: str, crs: str | None, **columns: list[str]) -> None:
    pyogrio = pytest.importorskip("pyogrio", reason="the extra maps is not installed")
    pyogrio.raw.write(
        path,
        geometry=np.array([shapely.to_wkb(shape) for shape in shapes], dtype=object),
        field_data=[np.array(values, dtype=object) for values in columns.values()],
        fields=list(columns),
        driver=driver,
        crs=crs,
        geometry_type="Polygon",
    )


@pytest.mark.filterwarnings("ignore")  # GDAL's, about a file without a CRS
@pytest.mark.parametrize(
    ("name", "driver"),
    [("l.shp", "ESRI Shapefile"), ("l.gpkg", "GPKG"), ("l.fgb", "FlatGeobuf"), ("l.kml", "KML")],
)
def test_what_gdal_writes_is_read(name: str, driver: str, tmp_path: Path) -> None:
    write(tmp_path / name, [LAKE, ISLE], driver, "EPSG:4326", Name=["Lake", "Isle"], KIND=["water", "island"])
    chart = load_map(tmp_path / name)
    assert has_the_isle(chart)
    assert chart.obstruction(chart.frame.to_local(LatLon(50.00075, 10.0015))) == "on Isle"


@pytest.mark.filterwarnings("ignore")
def test_a_shapefile_in_utm_is_transformed_with_corners_on_its_long_edges(tmp_path: Path) -> None:
    square = shapely.box(480_000.0, 5_540_000.0, 520_000.0, 5_541_000.0)  # zone 32, 40 km wide
    write(tmp_path / "l.shp", [square], "ESRI Shapefile", "EPSG:32632", kind=["water"])
    chart = load_map(tmp_path / "l.shp")
    assert chart.water.area == pytest.approx(40e6 / 0.9996**2, rel=1e-4)
    # On the central meridian the northing is 0.9996 of the arc: 5540847.042 m at 50° (Helmert's series)
    lat_deg = 50.0 + (5_540_000.0 / 0.9996 - 5_540_847.042) / 111_229.1
    at = chart.frame.to_local(LatLon(lat_deg, 9.0))
    assert chart.shores.distance(shapely.Point(at.east_m, at.north_m)) < 0.1


@pytest.mark.filterwarnings("ignore")
def test_a_shapefile_without_a_reference_system_is_taken_as_degrees_or_refused(tmp_path: Path) -> None:
    write(tmp_path / "d.shp", [LAKE], "ESRI Shapefile", None, kind=["water"])
    assert "taken as WGS 84 degrees" in load_map(tmp_path / "d.shp").notes[0]
    write(tmp_path / "m.shp", [shapely.box(0, 0, 500, 500)], "ESRI Shapefile", None, kind=["water"])
    with pytest.raises(MapError, match=r"names no reference system, and .* are no degrees"):
        load_map(tmp_path / "m.shp")


def nodes_and_way(number: int, shape: Polygon, **tags: str) -> tuple[str, str]:
    corners_of = list(shape.exterior.coords)[:-1]
    ids = [100 * number + n for n in range(len(corners_of))]
    nodes = "".join(
        f'<node id="{i}" lat="{lat}" lon="{lon}" version="1"/>'
        for i, (lon, lat) in zip(ids, corners_of, strict=True)
    )
    refs = "".join(f'<nd ref="{i}"/>' for i in [*ids, ids[0]])
    said = "".join(f'<tag k="{key}" v="{value}"/>' for key, value in tags.items())
    return nodes, f'<way id="{number}" version="1">{refs}{said}</way>'


def test_an_openstreetmap_extract_is_read_by_its_tags(tmp_path: Path) -> None:
    pytest.importorskip("pyogrio", reason="the extra maps is not installed")
    field = Polygon([(10.0, 49.99), (10.001, 49.99), (10.001, 49.991)])
    elements = [
        nodes_and_way(1, LAKE, natural="water", name="Lake"),
        nodes_and_way(2, ISLE, place="islet", name="Isle"),
        nodes_and_way(3, field, landuse="farmland"),
    ]
    text = "".join(nodes for nodes, _ in elements) + "".join(way for _, way in elements)
    path = tmp_path / "lake.osm"
    path.write_text(f'<?xml version="1.0"?><osm version="0.6">{text}</osm>')
    assert has_the_isle(load_map(path))


def test_gdal_formats_name_the_extra_where_it_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pyogrio", None)
    with pytest.raises(MapError, match=r"l.gpkg: needs pyogrio.*pip install '\.\[maps\]'"):
        load_map(tmp_path / "l.gpkg")


@pytest.mark.parametrize("suffix", [".shp", ".osm", ".000"])
def test_a_broken_file_of_gdals_formats_is_named(suffix: str, tmp_path: Path) -> None:
    pytest.importorskip("pyogrio", reason="the extra maps is not installed")
    path = tmp_path / f"l{suffix}"
    path.write_bytes(b"nothing of the kind")
    with pytest.raises(MapError, match=f"l{suffix}: "):
        load_map(path)


# Masks


@pytest.mark.parametrize("name", [
    "degrees_lzw.tif", "float.tif", "int16.tif", "big.tif", "area_point.tif", "utm_deflate_tiled.tif",
    "rotated_utm.tif",
])  # fmt: skip
def test_a_geotiff_mask_lies_where_gdal_put_it(name: str) -> None:
    """60 × 40 pixels of water in 80 × 60, with 10 × 10 pixels of land in it."""
    chart = load_map(GEOTIFFS / name)
    is_metres = "utm" in name
    pixel_m2 = 1.0 if is_metres else 1e-10 * 286.68 * 222.46 / 0.004 / 0.002
    inset = 1.03 * 1.054
    expected = ((60 - 2 * inset) * (40 - 2 * inset) - (10 + 2 * inset) ** 2) * pixel_m2
    assert chart.water.area == pytest.approx(expected, rel=0.04)
    if not is_metres:
        assert is_afloat(chart, 50.001 - 20e-5, 10.0 + 20e-5)
        assert not is_afloat(chart, 50.001 - 30e-5, 10.0 + 35e-5)
        assert not is_afloat(chart, 50.001 - 5e-5, 10.0 + 20e-5)


def test_a_tiepoint_may_lie_inside_the_picture_and_a_reference_system_of_its_own_is_refused() -> None:
    tags = {33550: (2.0, 3.0, 0.0), 33922: (10.0, 20.0, 0.0, 5e5, 5.54e6, 0.0)}
    keys = (1, 1, 0, 1, 3072, 0, 1)
    found = georeference_of(Path("m.tif"), tags | {34735: (*keys, 32632)})
    assert found == (2.0, 0.0, 499_980.0, 0.0, -3.0, 5_540_060.0, "EPSG:32632")
    with pytest.raises(MapError, match="names no reference system by its EPSG code"):
        georeference_of(Path("m.tif"), tags | {34735: (*keys, 32767)})


def test_a_geotiff_without_a_reference_system_says_what_to_do() -> None:
    with pytest.raises(MapError, match="names no reference system by its EPSG code: add a world file"):
        load_map(GEOTIFFS / "no_crs.tif")


def test_the_mask_of_a_real_pond_never_takes_its_shore_for_water() -> None:
    chart = load_map(SHORES / "mask_citra_pond_fl.png")
    traced = load_geojson(SHORES / "pond_citra_fl.geojson", chart.frame.origin)
    assert chart.navigable.area == pytest.approx(traced.navigable.area, rel=0.015)
    assert chart.navigable.difference(traced.navigable).area < 0.1
    assert "outline drawn 1.05 pixels (0.32 m) into the water" in chart.notes[0]


@given(
    rows=st.lists(st.lists(st.booleans(), min_size=14, max_size=14), min_size=10, max_size=10),
    size=st.integers(1, 4),
)
@example(rows=[[True] * 14] * 10, size=1)
def test_no_pixel_of_land_is_read_as_water(rows: list[list[bool]], size: int) -> None:
    mask = np.kron(np.array(rows), np.ones((size, size))).astype(bool)
    water = outlines(mask)
    land = [shapely.box(c, r, c + 1, r + 1) for r, c in zip(*np.nonzero(~mask), strict=True)]
    assert shapely.intersection(water, shapely.union_all(land)).area < 1e-9
    assert water.is_empty or water.bounds[2] <= mask.shape[1]


def picture(path: Path, pixels: Any, world: str | None = "1e-5\n0\n0\n-1e-5\n10\n50\n") -> Path:  # noqa: ANN401
    Image.fromarray(pixels).save(path)
    if world is not None:
        path.with_suffix(".PGW").write_text(world)
    return path


@pytest.mark.parametrize(
    ("pixels", "world", "said"),
    [
        (np.full((9, 9), 255, np.uint8), None, "nothing says where it lies: add a world file"),
        (np.full((9, 9), 255, np.uint8), "1 2 3", "not a world file: expected six numbers"),
        (np.full((9, 9), 255, np.uint8), "1\n0\n0\n-1\n500000\n5500000", "no degrees: name its reference"),
        (np.full((9, 9), 255, np.uint8), "0\n0\n0\n0\n10\n50", "georeference is not usable"),
        (np.zeros((9, 9), np.uint8), "1e-5\n0\n0\n-1e-5\n10\n50", "no water in it: no bright pixel"),
        (np.dstack([np.full((9, 9), n, np.uint8) for n in (200, 80, 30)]), "1e-5\n0\n0\n-1e-5\n10\n50",
         "a picture in colours is no mask: trace its water first"),
    ],
)  # fmt: skip
def test_a_mask_that_cannot_be_used_says_why(
    pixels: object, world: str | None, said: str, tmp_path: Path
) -> None:
    with pytest.raises(MapError) as caught:
        load_map(picture(tmp_path / "m.png", pixels, world))
    assert said in str(caught.value)


def test_a_mask_of_too_many_pixels_is_refused_before_it_is_unpacked(tmp_path: Path) -> None:
    path = tmp_path / "m.png"
    Image.new("1", (16_000, 1_001)).save(path)
    path.with_suffix(".pgw").write_text("1e-5\n0\n0\n-1e-5\n10\n50\n")
    with pytest.raises(MapError, match=r"m.png: more than 16 million pixels: scale it down"):
        load_map(path)


def test_transparent_pixels_are_land(tmp_path: Path) -> None:
    pixels = np.full((20, 20, 4), 255, np.uint8)
    pixels[:, 10:, 3] = 0
    chart = load_map(picture(tmp_path / "m.png", pixels))
    assert not is_afloat(chart, 50.0 - 10e-5, 10.0 + 15e-5)
    assert is_afloat(chart, 50.0 - 10e-5, 10.0 + 5e-5)


# Grids


def test_a_grid_map_is_a_chart_of_metres_from_its_lower_left_corner(tmp_path: Path) -> None:
    path = tmp_path / "grid.map"
    rows = ["." * 20] * 8 + ["." * 8 + "@" * 4 + "." * 8] * 4 + ["." * 20] * 8
    path.write_text("\n".join(["type octile", "height 20", "width 20", "map", *rows]) + "\n")
    chart = load_map(path, LatLon(50.0, 10.0))
    assert chart.frame.origin == LatLon(50.0, 10.0)
    assert chart.obstruction(Point(2.0, 3.0)) is None
    assert chart.obstruction(Point(10.0, 10.0)) == "on land"
    assert 250.0 < chart.water.area < 400.0 - 16.0


# All formats


def test_an_unknown_suffix_is_refused_with_the_known_ones(tmp_path: Path) -> None:
    with pytest.raises(MapError) as caught:
        load_source(str(tmp_path / "lake.dxf"))
    assert all(suffix in str(caught.value) for suffix in (".toml", *MAP_SUFFIXES))
    with pytest.raises(MapError, match="a photograph: trace its water first"):
        load_source("lake.JPG")


WORDS = st.lists(
    st.sampled_from(
        ["<kml>", "</kml>", "<Document>", "</Document>", "<Placemark>", "</Placemark>", "<Polygon>",
         "</Polygon>", "<outerBoundaryIs><LinearRing><coordinates>", OUTLINE, ISLE_OUTLINE,
         "</coordinates></LinearRing></outerBoundaryIs>",
         "<gpx>", "</gpx>", "<trk><trkseg>", "</trkseg></trk>", '<trkpt lat="50" lon="10"/>',
         '<trkpt lat="50" lon="10.001"/>', '<trkpt lat="50.001" lon="10"/>', "<type>island</type>",
         "1e999,nan",
         "<!--", "-->", "&lt;", "<name>Lake</name>", "<MultiGeometry>", "</MultiGeometry>", "\x00"]
    ), max_size=12,
).map("".join)  # fmt: skip


@given(text=WORDS | st.binary(max_size=60).map(lambda data: data.decode("latin-1")))
def test_no_text_raises_anything_but_a_map_error(text: str) -> None:
    for read in (parse_kml, parse_gpx):
        try:
            found = read(text.encode("utf-8"), "f")
        except MapError as error:
            said = str(error)
        else:
            said = f"{found.source}: read"
        assert said.startswith("f: ")
        assert "\n" not in said
