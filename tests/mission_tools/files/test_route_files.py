"""Missions as GeoJSON, KML and GPX, read by GDAL and by the formats' own rules, not by our readers."""

import json
import math
import re
from itertools import pairwise
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from companion.core.geo import LatLon
from mission_tools.assembly.areas import load_fence, load_rally
from mission_tools.errors import PlanFileError
from mission_tools.files.written import (
    ROUTE_SUFFIXES,
    geojson_of,
    gpx_of,
    kml_of,
    pieces_at_antimeridian,
    save_route,
)
from mission_tools.mission.mission import (
    Command,
    Fence,
    FenceCircle,
    FencePolygon,
    Mission,
    MissionItem,
    Rally,
)

HOME = LatLon(50.0, -1.2)
PLACES = (LatLon(50.001, -1.199), LatLon(50.0015, -1.1985), LatLon(50.002, -1.1975))
FENCE = Fence(
    (FencePolygon((LatLon(49.999, -1.201), LatLon(49.999, -1.196), LatLon(50.003, -1.197))),),
    (FenceCircle(LatLon(50.0012, -1.1988), 12.5, inclusion=False),),
    return_point=LatLon(50.0003, -1.1995),
)
MISSION = Mission(
    (
        MissionItem(Command.DO_CHANGE_SPEED, 2, (1.0, 1.5, -1.0, 0.0)),
        MissionItem.at(PLACES[0]),
        MissionItem.at(PLACES[1], params=(60.0, 0.0, 0.0, 0.0)),
        MissionItem.at(PLACES[2]),
    ),
    home=HOME,
    fence=FENCE,
    rally=(Rally(LatLon(50.0002, -1.1998)),),
)
LINE = [(-1.2, 50.0), (-1.199, 50.001), (-1.1985, 50.0015), (-1.1975, 50.002)]
TITLE = "Round <Goose> & “Alder” Island"
GPX = "{http://www.topografix.com/GPX/1/1}"


def read_by_gdal(path: Path, layer: str | None = None) -> tuple[Any, list[Any], dict[str, list[Any]]]:
    pyogrio = pytest.importorskip("pyogrio", reason="the extra maps is not installed")
    meta, _, shapes, columns = pyogrio.raw.read(path, layer=layer)
    fields = {str(field).lower(): list(column) for field, column in zip(meta["fields"], columns, strict=True)}
    return meta, list(shapely.from_wkb(shapes)), fields


def lines_of(shapes: list[Any]) -> list[Any]:
    return [shape for shape in shapes if shape is not None and shape.geom_type == "LineString"]


@pytest.mark.filterwarnings("ignore")  # of GDAL, on files with several layers
@pytest.mark.parametrize(("suffix", "layer"), [(".geojson", None), (".kml", None), (".gpx", "routes")])
def test_gdal_reads_the_line_of_a_mission_to_a_centimetre(
    suffix: str, layer: str | None, tmp_path: Path
) -> None:
    path = tmp_path / f"route{suffix}"
    save_route(MISSION, path, TITLE)
    meta, shapes, fields = read_by_gdal(path, layer)
    assert meta["crs"] == "EPSG:4326"
    line = lines_of(shapes)[0]
    parts = line.geoms if line.geom_type == "MultiLineString" else [line]
    assert np.allclose(shapely.get_coordinates(shapely.force_2d(parts[0])), LINE, atol=1e-7)
    assert TITLE in fields["name"]


@pytest.mark.filterwarnings("ignore")
def test_gdal_reads_the_waypoints_of_gpx_with_their_names(tmp_path: Path) -> None:
    path = tmp_path / "route.gpx"
    save_route(MISSION, path, TITLE)
    _, shapes, fields = read_by_gdal(path, "route_points")
    assert np.allclose(shapely.get_coordinates(shapes), LINE, atol=1e-7)
    assert fields["name"] == ["Home", "Waypoint 1", "Waypoint 2", "Waypoint 3"]
    assert fields["desc"][2] == "hold 1 min 00 s"
    _, rally, names = read_by_gdal(path, "waypoints")
    assert shapely.get_coordinates(rally).tolist() == [[-1.1998, 50.0002]]
    assert names["name"] == ["Rally point 1"]
    _, fence, kinds = read_by_gdal(path, "tracks")
    assert kinds["type"] == ["inclusion", "exclusion"]
    assert all(np.allclose(*shapely.get_coordinates(outline)[[0, -1]]) for outline in fence)


def test_gpx_has_the_order_of_elements_that_its_schema_asks_for() -> None:
    """gpxType: metadata, wpt, rte, trk; rteType: name before rtept; wptType: name before desc."""
    root = ElementTree.fromstring(gpx_of(MISSION, TITLE))  # noqa: S314 (our own text)
    assert root.get("version") == "1.1"
    assert root.get("creator")
    tags = [child.tag.removeprefix(GPX) for child in root]
    assert tags == sorted(tags, key=["metadata", "wpt", "rte", "trk"].index)
    route = root.find(f"{GPX}rte")
    assert route is not None
    assert [child.tag.removeprefix(GPX) for child in route] == ["name", *["rtept"] * 4]
    assert [child.tag.removeprefix(GPX) for child in route[3]] == ["name", "desc"]


def test_kml_polygons_are_closed_rings_of_four_or_more_tuples() -> None:
    """OGC 12-007r2, 10.7: a LinearRing is closed and has at least four coordinate tuples."""
    text = kml_of(MISSION, TITLE)
    root = ElementTree.fromstring(text)  # noqa: S314 (our own text)
    kml = "{http://www.opengis.net/kml/2.2}"
    assert root.tag == f"{kml}kml"
    rings = [ring.findtext(f"{kml}coordinates", "").split() for ring in root.iter(f"{kml}LinearRing")]
    assert [len(ring) for ring in rings] == [4, 65]
    assert all(ring[0] == ring[-1] for ring in rings)
    named = {one.findtext(f"{kml}name"): one for one in root.iter(f"{kml}Placemark")}
    assert named["Waypoint 2"].findtext(f"{kml}description") == "hold 1 min 00 s"
    assert named["Waypoint 1"].find(f"{kml}description") is None
    assert named["Rally point 1"].findtext(f"{kml}Point/{kml}coordinates") == "-1.1998000,50.0002000,0"
    shown = [
        one.findtext(f"{kml}styleUrl") for one in named.values() if one.find(f"{kml}Polygon") is not None
    ]
    assert shown == ["#inside", "#outside"]
    styles = {f"#{style.get('id')}" for style in root.iter(f"{kml}Style")}
    assert {url.text for url in root.iter(f"{kml}styleUrl")} <= styles


def test_geojson_is_as_rfc_7946_has_it_and_its_fence_and_rally_points_are_read_back(tmp_path: Path) -> None:
    path = tmp_path / "route.geojson"
    save_route(MISSION, path, TITLE)
    tree = json.loads(path.read_text(encoding="utf-8"))
    assert tree["type"] == "FeatureCollection"
    assert "crs" not in tree
    assert "“Alder”" in path.read_text(encoding="utf-8")
    for feature in tree["features"]:
        assert feature["type"] == "Feature"
        assert set(feature) == {"type", "properties", "geometry"}
    route = tree["features"][0]
    assert route["properties"]["length_m"] == pytest.approx(289.1, abs=0.5)
    assert load_fence(path).fence == FENCE
    assert load_rally(path).rally == MISSION.rally


def test_circles_in_kml_and_gpx_are_never_on_the_wrong_side() -> None:
    text = gpx_of(MISSION, "t")
    outline = text.partition("exclusion")[2]
    corners = [(float(a), float(b)) for a, b in re.findall(r'lat="([-\d.]+)" lon="([-\d.]+)"', outline)]
    per_lat, per_lon = 111_229.0, 111_229.0 * math.cos(math.radians(50.0012)) * 1.0030
    ring = shapely.Polygon([((lon + 1.1988) * per_lon, (lat - 50.0012) * per_lat) for lat, lon in corners])
    assert ring.exterior.distance(shapely.Point(0.0, 0.0)) >= 12.5 - 0.02


def test_a_line_across_the_antimeridian_is_cut_there() -> None:
    """RFC 7946, 3.1.9."""
    pieces = pieces_at_antimeridian([LatLon(-17.0, 179.9), LatLon(-17.2, -179.9), LatLon(-17.1, 179.95)])
    (lon_1, lat_1), (lon_2, lat_2) = (piece[0] for piece in pieces[1:])
    assert [piece[-1] for piece in pieces[:2]] == [(180.0, lat_1), (-180.0, lat_2)]
    assert (lon_1, lon_2) == (-180.0, 180.0)
    assert lat_1 == pytest.approx(-17.1)
    assert lat_2 == pytest.approx(-17.2 + 0.1 * 2 / 3)
    for piece in pieces:
        assert all(abs(a[0] - b[0]) < 1.0 for a, b in pairwise(piece))
    one = Mission((MissionItem.at(LatLon(-17.0, -179.9)),), home=LatLon(-17.0, 179.9))
    assert json.loads(geojson_of(one, "t"))["features"][0]["geometry"]["type"] == "MultiLineString"


def test_an_unknown_suffix_is_refused_with_the_known_ones(tmp_path: Path) -> None:
    with pytest.raises(PlanFileError) as caught:
        save_route(MISSION, tmp_path / "route.csv")
    assert all(suffix in str(caught.value) for suffix in ROUTE_SUFFIXES)
    assert not (tmp_path / "route.csv").exists()


places = st.builds(LatLon, st.floats(-85, 85), st.floats(-180, 180))


@given(home=st.none() | places, stops=st.lists(places, max_size=5), title=st.text(max_size=20))
def test_every_mission_gives_files_that_parse(home: LatLon | None, stops: list[LatLon], title: str) -> None:
    mission = Mission(tuple(MissionItem.at(place) for place in stops), home=home)
    json.loads(geojson_of(mission, title))
    for compose in (kml_of, gpx_of):
        text = compose(mission, title)
        root = ElementTree.fromstring(text)  # noqa: S314 (our own text)
        assert root.tag.endswith(("kml", "gpx"))
